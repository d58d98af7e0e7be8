// Healing on request: what is smaller than a length is no part of the shape.
#include "geo-adapt/cpp/names.hpp"
#include "geo-adapt/cpp/occt.hpp"
#include "geo-adapt/src/geometry/occt/bridge.rs.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeFix_FixSmallFace.hxx>
#include <ShapeFix_Shape.hxx>
#include <ShapeFix_Wireframe.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

#include <stdexcept>
#include <utility>

namespace geo_adapt {
namespace {

enum class Done : std::uint32_t { edge = 0, face = 1, sewn = 2 };

HealRecord record(Done what, const TopoDS_Shape& shape)
{
  GProp_GProps found;
  if (what == Done::face) {
    BRepGProp::SurfaceProperties(shape, found);
  } else {
    BRepGProp::LinearProperties(shape, found);
  }
  const gp_Pnt at = found.CentreOfMass();
  HealRecord made;
  made.what = static_cast<std::uint32_t>(what);
  made.at = {at.X(), at.Y(), at.Z()};
  made.size = found.Mass();
  return made;
}

/// The faces and edges of a shape with what they have become, step by step.
class Parts
{
public:
  explicit Parts(const TopoDS_Shape& shape)
  {
    for (const TopAbs_ShapeEnum type : {TopAbs_FACE, TopAbs_EDGE}) {
      TopTools_IndexedMapOfShape map;
      TopExp::MapShapes(shape, type, map);
      for (int i = 1; i <= map.Extent(); ++i) {
        if (type == TopAbs_FACE || !BRep_Tool::Degenerated(TopoDS::Edge(map(i)))) {
          all.emplace_back(map(i), map(i));
        }
      }
    }
  }

  /// Follows what a step has put in their place; tells what it has removed.
  void follow(const Handle(ShapeBuild_ReShape)& step, rust::Vec<HealRecord>& done)
  {
    for (auto& [first, now] : all) {
      if (now.IsNull()) {
        continue;
      }
      TopoDS_Shape next = step->Apply(now);
      if (next.IsNull()) {
        done.push_back(record(first.ShapeType() == TopAbs_FACE ? Done::face : Done::edge, first));
      }
      now = std::move(next);
    }
  }

  void hand_on_all(Labels& labels) const
  {
    for (const auto& [first, now] : all) {
      if (!now.IsNull() && !now.IsSame(first)) {
        hand_on(labels, first, now);
      }
    }
  }

private:
  std::vector<std::pair<TopoDS_Shape, TopoDS_Shape>> all;
};

/// Edges of a shape with one face alone.
std::vector<TopoDS_Shape> open_edges(const TopoDS_Shape& shape)
{
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
  std::vector<TopoDS_Shape> found;
  for (int i = 1; i <= faces_of.Extent(); ++i) {
    if (faces_of(i).Extent() == 1 && !BRep_Tool::Degenerated(TopoDS::Edge(faces_of.FindKey(i)))) {
      found.push_back(faces_of.FindKey(i));
    }
  }
  return found;
}

} // namespace

std::shared_ptr<Model> Model::healed(double length, rust::Vec<HealRecord>& done) const
{
  Labels named = labels;
  Parts parts(shape);
  const Handle(ShapeFix_Wireframe) wires = new ShapeFix_Wireframe(shape);
  wires->SetPrecision(length);
  wires->SetMaxTolerance(length);
  wires->ModeDropSmallEdges() = Standard_True;
  wires->FixSmallEdges();
  wires->FixWireGaps();
  TopoDS_Shape now = wires->Shape();
  parts.follow(wires->Context(), done);

  ShapeFix_FixSmallFace faces;
  faces.SetContext(new ShapeBuild_ReShape);
  faces.Init(now);
  faces.SetPrecision(length);
  faces.SetMaxTolerance(length);
  faces.Perform();
  if (const TopoDS_Shape fixed = faces.FixShape(); !fixed.IsNull()) {
    parts.follow(faces.Context(), done);
    now = fixed;
  }
  parts.hand_on_all(named);

  if (!TopExp_Explorer(now, TopAbs_SOLID).More()) {
    const std::vector<TopoDS_Shape> open = open_edges(now);
    const TopoDS_Shape joined = sewn(now, named, length, false);
    if (TopExp_Explorer(joined, TopAbs_SOLID).More()) {
      for (const TopoDS_Shape& edge : open) {
        done.push_back(record(Done::sewn, edge));
      }
    }
    now = joined;
  }
  if (!BRepCheck_Analyzer(now).IsValid()) {
    const Handle(ShapeFix_Shape) fix = new ShapeFix_Shape(now);
    fix->SetMaxTolerance(length);
    fix->Perform();
    now = fix->Shape();
    if (now.IsNull() || !BRepCheck_Analyzer(now).IsValid()) {
      throw std::runtime_error("OpenCASCADE makes a faulty shape of it; give a smaller length");
    }
  }
  if (!TopExp_Explorer(now, TopAbs_FACE).More()) {
    throw std::runtime_error("nothing is left of it; give a smaller length");
  }
  std::vector<DoubleWall> walls;
  const TopoDS_Shape solids = divided(connected(now, named), named, walls);
  return std::make_shared<Model>(separated(solids, named), named, solids);
}

} // namespace geo_adapt
