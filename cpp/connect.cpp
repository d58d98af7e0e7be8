// Several solids in one file: CAD programs write each with faces of its own, also where two touch.
#include "geo-adapt/cpp/names.hpp"

#include <BRepAlgoAPI_BuilderAlgo.hxx>
#include <BRepBndLib.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <NCollection_DataMap.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace geo_adapt {
namespace {

using Solids = TopTools_IndexedMapOfShape;

/// Whether the boxes of two solids meet.
bool may_touch(const Solids& solids)
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

/// The solids with these numbers, cut by each other: what is nearer than `fuzzy` is one. Null where OpenCASCADE fails.
std::unique_ptr<BRepAlgoAPI_BuilderAlgo> fused(const Solids& solids, const std::vector<int>& which, double fuzzy)
{
  TopTools_ListOfShape arguments;
  for (const int i : which) {
    arguments.Append(solids(i));
  }
  auto fuse = std::make_unique<BRepAlgoAPI_BuilderAlgo>();
  fuse->SetArguments(arguments);
  fuse->SetNonDestructive(Standard_True);
  fuse->SetFuzzyValue(fuzzy);
  fuse->SetRunParallel(Standard_False); // the same shape on every run
  fuse->Build();
  return fuse->IsDone() && !fuse->HasErrors() ? std::move(fuse) : nullptr;
}

/// What a solid has become.
std::vector<TopoDS_Shape> images(const Solids& solids, int i, BRepAlgoAPI_BuilderAlgo* fuse)
{
  if (fuse == nullptr) {
    return {solids(i)};
  }
  const TopTools_ListOfShape& modified = fuse->Modified(solids(i));
  std::vector<TopoDS_Shape> all(modified.begin(), modified.end());
  if (all.empty() && !fuse->IsDeleted(solids(i))) {
    all.push_back(solids(i));
  }
  return all;
}

/// The solids in groups: those of a group have faces in common with each other, and none with another's. `lonely` tells whether groups
/// touch each other all the same, in edges or vertices.
std::vector<std::vector<int>> groups(const Solids& solids, BRepAlgoAPI_BuilderAlgo& fuse, bool& lonely)
{
  std::vector<int> group(static_cast<std::size_t>(solids.Extent()) + 1);
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](int i) {
    while (group[static_cast<std::size_t>(i)] != i) {
      i = group[static_cast<std::size_t>(i)];
    }
    return i;
  };
  const auto each = [&](TopAbs_ShapeEnum type, auto&& visit) {
    NCollection_DataMap<TopoDS_Shape, int, TopTools_ShapeMapHasher> first;
    for (int i = 1; i <= solids.Extent(); ++i) {
      for (const TopoDS_Shape& image : images(solids, i, &fuse)) {
        for (TopExp_Explorer it(image, type); it.More(); it.Next()) {
          if (const int* other = first.Seek(it.Current()); other != nullptr) {
            visit(root(*other), root(i));
          } else {
            first.Bind(it.Current(), i);
          }
        }
      }
    }
  };
  each(TopAbs_FACE, [&](int a, int b) { group[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b); });
  each(TopAbs_VERTEX, [&](int a, int b) { lonely = lonely || a != b; });
  std::vector<std::vector<int>> found(group.size());
  for (int i = 1; i <= solids.Extent(); ++i) {
    found[static_cast<std::size_t>(root(i))].push_back(i);
  }
  return found;
}

/// Labels of what was cut go to its parts.
void hand_on_all(Labels& labels, const TopoDS_Shape& shape, BRepAlgoAPI_BuilderAlgo& fuse)
{
  for (const TopAbs_ShapeEnum type : {TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID}) {
    TopTools_IndexedMapOfShape old;
    TopExp::MapShapes(shape, type, old);
    for (int i = 1; i <= old.Extent(); ++i) {
      for (const TopoDS_Shape& image : fuse.Modified(old(i))) {
        hand_on(labels, old(i), image);
      }
    }
  }
}

} // namespace

TopoDS_Shape with_faces(const TopoDS_Shape& shape)
{
  if (shape.ShapeType() != TopAbs_COMPOUND) {
    return TopExp_Explorer(shape, TopAbs_FACE).More() ? shape : TopoDS_Shape();
  }
  TopoDS_Compound rest;
  const BRep_Builder builder;
  builder.MakeCompound(rest);
  bool is_same = true, is_empty = true;
  for (TopoDS_Iterator part(shape); part.More(); part.Next()) {
    const TopoDS_Shape kept = with_faces(part.Value());
    is_same = is_same && kept.IsEqual(part.Value());
    if (!kept.IsNull()) {
      builder.Add(rest, kept);
      is_empty = false;
    }
  }
  return is_empty ? TopoDS_Shape() : is_same ? shape : rest;
}

TopoDS_Shape connected(const TopoDS_Shape& shape, Labels& labels)
{
  Solids solids;
  TopExp::MapShapes(shape, TopAbs_SOLID, solids);
  if (solids.Extent() < 2 || !may_touch(solids)) {
    return shape;
  }
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  // What is nearer than this touches, as for the sizes of gaps (src/sizing/feature.rs): a mesher would join it by chance.
  const double fuzzy = TOUCHING * std::sqrt(box.SquareExtent());
  std::vector<int> all(static_cast<std::size_t>(solids.Extent()));
  std::iota(all.begin(), all.end(), 1);
  std::vector<std::unique_ptr<BRepAlgoAPI_BuilderAlgo>> fuses;
  fuses.push_back(fused(solids, all, fuzzy));
  if (fuses.front() == nullptr) {
    return shape; // as the file has it: a mesh of it will not be conforming, and is refused
  }
  // A ball in its race touches it along a curve: surfaces that are tangent there meet in a chain of slivers, which no mesher can use,
  // and a mesh that is joined in a curve alone joins nothing. So only what shares faces is cut by each other.
  bool lonely = false;
  const std::vector<std::vector<int>> parts = groups(solids, *fuses.front(), lonely);
  std::vector<BRepAlgoAPI_BuilderAlgo*> by(static_cast<std::size_t>(solids.Extent()) + 1, fuses.front().get());
  if (lonely) {
    fuses.clear();
    for (const std::vector<int>& part : parts) {
      if (part.size() > 1) {
        fuses.push_back(fused(solids, part, fuzzy));
      }
      for (const int i : part) {
        by[static_cast<std::size_t>(i)] = part.size() > 1 ? fuses.back().get() : nullptr;
      }
    }
  }
  TopoDS_Compound joined;
  BRep_Builder builder;
  builder.MakeCompound(joined);
  TopTools_MapOfShape added;
  for (int i = 1; i <= solids.Extent(); ++i) {
    for (const TopoDS_Shape& image : images(solids, i, by[static_cast<std::size_t>(i)])) {
      if (added.Add(image)) {
        builder.Add(joined, image);
      }
    }
  }
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SOLID); it.More(); it.Next()) {
    builder.Add(joined, it.Current());
  }
  for (const auto& fuse : fuses) {
    if (fuse != nullptr) {
      hand_on_all(labels, shape, *fuse);
    }
  }
  return joined;
}

} // namespace geo_adapt
