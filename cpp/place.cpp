// A model in other units or at another place.
#include "geo-adapt/cpp/occt.hpp"

#include <BRepBuilderAPI_Transform.hxx>
#include <gp_Trsf.hxx>
#include <gp_Vec.hxx>

#include <stdexcept>

namespace geo_adapt {
namespace {

TopoDS_Shape transformed(const TopoDS_Shape& shape, const gp_Trsf& how)
{
  // The geometry itself, not a location: a location cannot scale.
  BRepBuilderAPI_Transform made(shape, how, Standard_True);
  if (!made.IsDone() || made.Shape().IsNull()) {
    throw std::runtime_error("OpenCASCADE cannot transform it");
  }
  return made.Shape();
}

} // namespace

std::shared_ptr<Model> Model::placed(double factor, const std::array<double, 3>& by) const
{
  gp_Trsf scaled, how;
  scaled.SetScale(gp_Pnt(0.0, 0.0, 0.0), factor);
  how.SetTranslation(gp_Vec(by[0], by[1], by[2]));
  how.Multiply(scaled);
  const TopoDS_Shape apart = transformed(shape, how);
  const TopoDS_Shape whole = joined.IsSame(shape) ? apart : transformed(joined, how);
  return std::make_shared<Model>(apart, Labels(), whole);
}

} // namespace geo_adapt
