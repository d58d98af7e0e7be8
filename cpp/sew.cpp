// Faces that are no solid yet: closed shells become solids, and faces beside each other are sewn to shells.
#include "geo-adapt/cpp/names.hpp"

#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>

namespace geo_adapt {

/// The closed shells of a shape as solids, beside all else of it; null where there is none.
TopoDS_Shape filled(const TopoDS_Shape& shape)
{
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  bool is_closed = false;
  for (TopExp_Explorer it(shape, TopAbs_SHELL); it.More(); it.Next()) {
    const TopoDS_Shell shell = TopoDS::Shell(it.Current());
    TopoDS_Solid solid;
    if (BRep_Tool::IsClosed(shell)) {
      solid = BRepBuilderAPI_MakeSolid(shell).Solid();
      BRepLib::OrientClosedSolid(solid);
      is_closed = true;
    }
    builder.Add(all, solid.IsNull() ? TopoDS_Shape(shell) : TopoDS_Shape(solid));
  }
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) {
    builder.Add(all, it.Current());
  }
  return is_closed ? TopoDS_Shape(all) : TopoDS_Shape();
}

TopoDS_Shape sewn(const TopoDS_Shape& shape, Labels& labels, double tolerance, bool stays)
{
  BRepBuilderAPI_Sewing sewing(tolerance);
  sewing.Add(shape);
  sewing.Perform();
  const TopoDS_Shape joined = sewing.SewedShape();
  if (joined.IsNull()) {
    return shape;
  }
  const TopoDS_Shape solids = filled(joined);
  if (solids.IsNull() && !stays) {
    return shape;
  }
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    hand_on(labels, it.Current(), sewing.ModifiedSubShape(it.Current()));
  }
  return solids.IsNull() ? joined : solids;
}

} // namespace geo_adapt
