// What OpenCASCADE's own check finds wrong with a model. It is asked when no mesher has meshed one: it takes long on large models, and many
// models with small flaws are meshed all the same.
#include "geo-adapt/cpp/occt.hpp"
#include "geo-adapt/src/geometry/occt/bridge.rs.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepCheck_ListOfStatus.hxx>
#include <BRepCheck_Result.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

namespace geo_adapt {
namespace {

const char* words(BRepCheck_Status status)
{
  switch (status) {
  case BRepCheck_SelfIntersectingWire:
    return "its boundary crosses itself";
  case BRepCheck_IntersectingWires:
  case BRepCheck_InvalidImbricationOfWires:
    return "its outer boundary and those of its holes cross";
  case BRepCheck_NotClosed:
    return "its boundary is not closed";
  case BRepCheck_RedundantEdge:
  case BRepCheck_RedundantWire:
  case BRepCheck_RedundantFace:
    return "a part of its boundary is there twice";
  case BRepCheck_InvalidCurveOnSurface:
  case BRepCheck_InvalidSameParameterFlag:
  case BRepCheck_InvalidSameRangeFlag:
  case BRepCheck_NoCurveOnSurface:
  case BRepCheck_InvalidCurveOnClosedSurface:
    return "an edge does not lie on it";
  case BRepCheck_InvalidPointOnCurve:
  case BRepCheck_InvalidPointOnSurface:
  case BRepCheck_InvalidPointOnCurveOnSurface:
    return "a corner does not lie on it";
  case BRepCheck_UnorientableShape:
  case BRepCheck_BadOrientation:
  case BRepCheck_BadOrientationOfSubshape:
    return "it has no side that is inside";
  default:
    return "its surface or its boundary is faulty";
  }
}

/// The first that is wrong in a list.
BRepCheck_Status first(const BRepCheck_ListOfStatus& all)
{
  for (const BRepCheck_Status status : all) {
    if (status != BRepCheck_NoError) {
      return status;
    }
  }
  return BRepCheck_NoError;
}

/// What is wrong with a part of a face, in itself or there.
BRepCheck_Status flaw(const BRepCheck_Analyzer& check, const TopoDS_Shape& part, const TopoDS_Face& face)
{
  const Handle(BRepCheck_Result)& result = check.Result(part);
  if (result.IsNull()) {
    return BRepCheck_NoError;
  }
  BRepCheck_Status found = first(result->Status());
  for (result->InitContextIterator(); result->MoreShapeInContext() && found == BRepCheck_NoError;
       result->NextShapeInContext()) {
    if (result->ContextualShape().IsSame(face)) {
      found = first(result->StatusOnShape());
    }
  }
  return found;
}

/// What is wrong with a face: first what its wires have, which says the most.
BRepCheck_Status flaw(const BRepCheck_Analyzer& check, const TopoDS_Face& face)
{
  for (const TopAbs_ShapeEnum type : {TopAbs_WIRE, TopAbs_FACE, TopAbs_EDGE}) {
    for (TopExp_Explorer it(face, type); it.More(); it.Next()) {
      if (const BRepCheck_Status found = flaw(check, it.Current(), face); found != BRepCheck_NoError) {
        return found;
      }
    }
  }
  return BRepCheck_NoError;
}

} // namespace

rust::Vec<FlawRecord> Model::flaws() const
{
  const BRepCheck_Analyzer check(shape);
  rust::Vec<FlawRecord> found;
  if (check.IsValid()) {
    return found;
  }
  // The check knows its shapes by their orientation in the whole.
  TopTools_IndexedMapOfShape seen;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    const int before = seen.Extent();
    if (seen.Add(it.Current()) <= before) {
      continue;
    }
    if (const BRepCheck_Status status = flaw(check, TopoDS::Face(it.Current())); status != BRepCheck_NoError) {
      found.push_back({static_cast<std::uint32_t>(faces.FindIndex(it.Current()) - 1), words(status)});
    }
  }
  return found;
}

} // namespace geo_adapt
