// Several solids in one file: CAD programs write each with faces of its own, also where two touch.
#include "geo-adapt/cpp/names.hpp"

#include <BRepAlgoAPI_BuilderAlgo.hxx>
#include <BRepBndLib.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS_Compound.hxx>

#include <cmath>
#include <vector>

namespace geo_adapt {
namespace {

/// Of the diagonal.
constexpr double TOUCHING = 1e-7;

/// Whether the boxes of two solids meet.
bool may_touch(const TopTools_IndexedMapOfShape& solids)
{
  std::vector<Bnd_Box> boxes(static_cast<std::size_t>(solids.Extent()));
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    BRepBndLib::Add(solids(static_cast<int>(i) + 1), boxes[i], Standard_False);
    for (std::size_t j = 0; j < i; ++j) {
      if (!boxes[i].IsOut(boxes[j])) {
        return true;
      }
    }
  }
  return false;
}

} // namespace

TopoDS_Shape connected(const TopoDS_Shape& shape, Labels& labels)
{
  TopTools_IndexedMapOfShape solids;
  TopExp::MapShapes(shape, TopAbs_SOLID, solids);
  if (solids.Extent() < 2 || !may_touch(solids)) {
    return shape;
  }
  TopTools_ListOfShape arguments;
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  for (int i = 1; i <= solids.Extent(); ++i) {
    arguments.Append(solids(i));
  }
  BRepAlgoAPI_BuilderAlgo fuse;
  fuse.SetArguments(arguments);
  fuse.SetNonDestructive(Standard_True);
  // What is nearer than this touches, as for the sizes of gaps (src/sizing/feature.rs): a mesher would join it by chance.
  fuse.SetFuzzyValue(TOUCHING * std::sqrt(box.SquareExtent()));
  fuse.SetRunParallel(Standard_False); // the same shape on every run
  fuse.Build();
  if (!fuse.IsDone() || fuse.HasErrors()) {
    return shape; // as the file has it: a mesh of it will not be conforming, and is refused
  }
  for (const TopAbs_ShapeEnum type : {TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID}) {
    TopTools_IndexedMapOfShape old;
    TopExp::MapShapes(shape, type, old);
    for (int i = 1; i <= old.Extent(); ++i) {
      for (const TopoDS_Shape& image : fuse.Modified(old(i))) {
        hand_on(labels, old(i), image);
      }
    }
  }
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  TopTools_MapOfShape added;
  for (int i = 1; i <= solids.Extent(); ++i) {
    const TopTools_ListOfShape& images = fuse.Modified(solids(i));
    if (images.IsEmpty() && !fuse.IsDeleted(solids(i)) && added.Add(solids(i))) {
      builder.Add(all, solids(i));
    }
    for (const TopoDS_Shape& image : images) {
      if (added.Add(image)) {
        builder.Add(all, image);
      }
    }
  }
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SOLID); it.More(); it.Next()) {
    builder.Add(all, it.Current());
  }
  return all;
}

} // namespace geo_adapt
