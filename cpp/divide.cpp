// Bodies that touch and were sewn to one shell keep both of the walls between them: faces that lie on each other within a solid.
#include "geo-adapt/cpp/names.hpp"

#include <BOPAlgo_MakerVolume.hxx>
#include <BOPTools_AlgoTools3D.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IntTools_Context.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace geo_adapt {
namespace {

/// A face by its corners: how many, and their mean.
struct Corners
{
  TopoDS_Face face;
  int count;
  gp_XYZ mean;
};

Corners corners(const TopoDS_Face& face)
{
  TopTools_IndexedMapOfShape vertices;
  TopExp::MapShapes(face, TopAbs_VERTEX, vertices);
  gp_XYZ sum(0, 0, 0);
  for (int i = 1; i <= vertices.Extent(); ++i) {
    sum += BRep_Tool::Pnt(TopoDS::Vertex(vertices(i))).XYZ();
  }
  return {face, vertices.Extent(), sum / std::max(1, vertices.Extent())};
}

bool is_near(const gp_Pnt& point, const TopoDS_Face& face, double distance)
{
  const BRepExtrema_DistShapeShape between(BRepBuilderAPI_MakeVertex(point).Vertex(), face);
  return between.IsDone() && between.Value() <= distance;
}

/// Whether two faces have an edge in common, as the halves of a cylinder have.
bool are_neighbours(const TopoDS_Face& a, const TopoDS_Face& b)
{
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(a, TopAbs_EDGE, edges);
  for (TopExp_Explorer it(b, TopAbs_EDGE); it.More(); it.Next()) {
    if (edges.Contains(it.Current())) {
      return true;
    }
  }
  return false;
}

/// Whether a point inside a face, and the middles of its edges, are on another.
bool lies_on(const TopoDS_Face& face, const TopoDS_Face& other, double distance)
{
  gp_Pnt inside;
  gp_Pnt2d parameters;
  if (BOPTools_AlgoTools3D::PointInFace(face, inside, parameters, new IntTools_Context) != 0 || !is_near(inside, other, distance)) {
    return false;
  }
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    double first = 0, last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(TopoDS::Edge(it.Current()), first, last);
    if (!curve.IsNull() && !is_near(curve->Value((first + last) / 2), other, distance)) {
      return false;
    }
  }
  return true;
}

/// Where two faces of a solid lie on each other.
std::optional<gp_Pnt> double_wall(const TopoDS_Shape& solid, double distance)
{
  std::vector<Corners> faces;
  for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) {
    faces.push_back(corners(TopoDS::Face(it.Current())));
  }
  std::sort(faces.begin(), faces.end(), [](const Corners& a, const Corners& b) { return a.mean.X() < b.mean.X(); });
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t j = i + 1; j < faces.size() && faces[j].mean.X() - faces[i].mean.X() <= distance; ++j) {
      const Corners &a = faces[i], &b = faces[j];
      const bool may_be = a.count == b.count && (a.mean - b.mean).Modulus() <= distance && !are_neighbours(a.face, b.face);
      if (may_be && lies_on(a.face, b.face, distance) && lies_on(b.face, a.face, distance)) {
        gp_Pnt inside;
        gp_Pnt2d parameters;
        BOPTools_AlgoTools3D::PointInFace(a.face, inside, parameters, new IntTools_Context);
        return inside;
      }
    }
  }
  return {};
}

/// Adds the solids that the faces of a solid enclose, if all of these bound one, and returns their number. The labels of what was divided go
/// to the parts.
std::uint64_t add_enclosed(const TopoDS_Shape& solid, double fuzzy, TopoDS_Compound& all, Labels& labels)
{
  BOPAlgo_MakerVolume maker;
  TopTools_IndexedMapOfShape faces, edges, solids;
  TopExp::MapShapes(solid, TopAbs_FACE, faces);
  TopExp::MapShapes(solid, TopAbs_EDGE, edges);
  for (int i = 1; i <= faces.Extent(); ++i) {
    maker.AddArgument(faces(i));
  }
  maker.SetIntersect(Standard_True);
  maker.SetGlue(BOPAlgo_GlueFull); // to cut faces by each other took 40 s where this takes 0.5
  maker.SetNonDestructive(Standard_True);
  maker.SetFuzzyValue(fuzzy);
  maker.SetRunParallel(Standard_False); // the same shape on every run
  maker.Perform();
  if (maker.HasErrors()) {
    return 0;
  }
  TopTools_IndexedMapOfShape bounding;
  TopExp::MapShapes(maker.Shape(), TopAbs_SOLID, solids);
  for (int i = 1; i <= solids.Extent(); ++i) {
    TopExp::MapShapes(solids(i), TopAbs_FACE, bounding);
  }
  for (int i = 1; i <= faces.Extent(); ++i) {
    const TopTools_ListOfShape& images = maker.Modified(faces(i));
    const auto bounds = [&](const TopoDS_Shape& face) { return bounding.Contains(face); };
    if (images.IsEmpty() ? !bounds(faces(i)) : !std::all_of(images.begin(), images.end(), bounds)) {
      return 0;
    }
  }
  const BRep_Builder builder;
  for (int i = 1; i <= solids.Extent(); ++i) {
    hand_on(labels, solid, solids(i));
    builder.Add(all, solids(i));
  }
  for (const TopTools_IndexedMapOfShape* old : {&faces, &edges}) {
    for (int i = 1; i <= old->Extent(); ++i) {
      for (const TopoDS_Shape& image : maker.Modified((*old)(i))) {
        hand_on(labels, (*old)(i), image);
      }
    }
  }
  return static_cast<std::uint64_t>(solids.Extent());
}

} // namespace

TopoDS_Shape divided(const TopoDS_Shape& shape, Labels& labels, std::vector<DoubleWall>& walls)
{
  Bnd_Box box;
  for (TopExp_Explorer it(shape, TopAbs_VERTEX); it.More(); it.Next()) {
    box.Add(BRep_Tool::Pnt(TopoDS::Vertex(it.Current())));
  }
  if (box.IsVoid()) {
    return shape;
  }
  const double fuzzy = TOUCHING * std::sqrt(box.SquareExtent());
  TopoDS_Compound all;
  const BRep_Builder builder;
  builder.MakeCompound(all);
  TopTools_IndexedMapOfShape solids;
  TopExp::MapShapes(shape, TopAbs_SOLID, solids);
  const std::size_t before = walls.size();
  for (int i = 1; i <= solids.Extent(); ++i) {
    const std::optional<gp_Pnt> wall = double_wall(solids(i), fuzzy);
    const std::uint64_t parts = wall ? add_enclosed(solids(i), fuzzy, all, labels) : 0;
    if (parts > 0) {
      walls.push_back({{wall->X(), wall->Y(), wall->Z()}, parts});
    } else {
      builder.Add(all, solids(i));
    }
  }
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SOLID); it.More(); it.Next()) {
    builder.Add(all, it.Current());
  }
  return walls.size() == before ? shape : all;
}

} // namespace geo_adapt
