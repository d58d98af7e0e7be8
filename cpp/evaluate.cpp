// Evaluation of surfaces, curves and trimming, for one thread.
#include "geo-adapt/cpp/occt.hpp"
#include "geo-adapt/src/geometry/occt/bridge.rs.h"

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRep_Tool.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <gp_Circ.hxx>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Elips.hxx>
#include <gp_Lin.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>

#include <stdexcept>
#include <utility>

namespace geo_adapt {
namespace {

void put(const gp_XYZ& value, double* out)
{
  out[0] = value.X();
  out[1] = value.Y();
  out[2] = value.Z();
}

/// The frame of an analytic surface or curve. Its third axis is not always the product of the others.
Form form(const gp_Pnt& origin, const gp_Dir& x, const gp_Dir& y, const gp_Dir& z, double a, double b)
{
  Form result{};
  put(origin.XYZ(), result.origin.data());
  put(x.XYZ(), result.x.data());
  put(y.XYZ(), result.y.data());
  put(z.XYZ(), result.z.data());
  result.sizes = {a, b};
  return result;
}

Form form(const gp_Ax3& axes, double a = 0.0, double b = 0.0)
{
  return form(axes.Location(), axes.XDirection(), axes.YDirection(), axes.Direction(), a, b);
}

Form form(const gp_Ax2& axes, double a, double b = 0.0)
{
  return form(axes.Location(), axes.XDirection(), axes.YDirection(), axes.Direction(), a, b);
}

} // namespace

Evaluator::Evaluator(std::shared_ptr<Model> shared)
  : model(std::move(shared)),
    surfaces(model->face_count()),
    curves(model->edge_count()),
    classifiers(model->face_count())
{}

BRepAdaptor_Surface& Evaluator::surface(std::uint32_t face)
{
  auto& slot = surfaces.at(face);
  if (slot == nullptr) {
    slot = std::make_unique<BRepAdaptor_Surface>(model->face(face), Standard_False);
  }
  return *slot;
}

BRepAdaptor_Curve& Evaluator::curve(std::uint32_t edge)
{
  auto& slot = curves.at(edge);
  if (slot == nullptr) {
    slot = std::make_unique<BRepAdaptor_Curve>(model->edge(edge));
  }
  return *slot;
}

Form Evaluator::surface_form(std::uint32_t face)
{
  const BRepAdaptor_Surface& here = surface(face);
  switch (here.GetType()) {
    case GeomAbs_Plane:
      return form(here.Plane().Position());
    case GeomAbs_Cylinder:
      return form(here.Cylinder().Position(), here.Cylinder().Radius());
    case GeomAbs_Cone:
      return form(here.Cone().Position(), here.Cone().RefRadius(), here.Cone().SemiAngle());
    case GeomAbs_Sphere:
      return form(here.Sphere().Position(), here.Sphere().Radius());
    case GeomAbs_Torus:
      return form(here.Torus().Position(), here.Torus().MajorRadius(), here.Torus().MinorRadius());
    default:
      throw std::logic_error("the surface has no closed form");
  }
}

Form Evaluator::curve_form(std::uint32_t edge)
{
  const BRepAdaptor_Curve& here = curve(edge);
  switch (here.GetType()) {
    case GeomAbs_Line: {
      const gp_Lin line = here.Line();
      return form(line.Location(), line.Direction(), line.Direction(), line.Direction(), 0.0, 0.0);
    }
    case GeomAbs_Circle:
      return form(here.Circle().Position(), here.Circle().Radius());
    case GeomAbs_Ellipse:
      return form(here.Ellipse().Position(), here.Ellipse().MajorRadius(), here.Ellipse().MinorRadius());
    default:
      throw std::logic_error("the curve has no closed form");
  }
}

void Evaluator::surface_d0(std::uint32_t face, double u, double v, std::array<double, 3>& out)
{
  put(surface(face).Value(u, v).XYZ(), out.data());
}

void Evaluator::surface_d2(std::uint32_t face, double u, double v, std::array<double, 18>& out)
{
  gp_Pnt point;
  gp_Vec du, dv, duu, dvv, duv;
  surface(face).D2(u, v, point, du, dv, duu, dvv, duv);
  put(point.XYZ(), &out[0]);
  put(du.XYZ(), &out[3]);
  put(dv.XYZ(), &out[6]);
  put(duu.XYZ(), &out[9]);
  put(duv.XYZ(), &out[12]);
  put(dvv.XYZ(), &out[15]);
}

void Evaluator::curve_d2(std::uint32_t edge, double t, std::array<double, 9>& out)
{
  gp_Pnt point;
  gp_Vec d1, d2;
  curve(edge).D2(t, point, d1, d2);
  put(point.XYZ(), &out[0]);
  put(d1.XYZ(), &out[3]);
  put(d2.XYZ(), &out[6]);
}

bool Evaluator::pcurve_d0(std::uint32_t edge, std::uint32_t face, double t, std::array<double, 2>& out)
{
  const std::uint64_t key = (std::uint64_t{face} << 32) | edge;
  auto found = pcurves.find(key);
  if (found == pcurves.end()) {
    double first = 0.0, last = 0.0;
    found = pcurves.emplace(key, BRep_Tool::CurveOnSurface(model->edge(edge), model->face(face), first, last)).first;
  }
  if (found->second.IsNull()) {
    return false;
  }
  const gp_Pnt2d point = found->second->Value(t);
  out = {point.X(), point.Y()};
  return true;
}

bool Evaluator::inside(std::uint32_t face, double u, double v)
{
  auto& slot = classifiers.at(face);
  if (slot == nullptr) {
    const TopoDS_Face here = model->face(face);
    slot = std::make_unique<BRepTopAdaptor_FClass2d>(here, BRep_Tool::Tolerance(here));
  }
  return slot->Perform(gp_Pnt2d(u, v), Standard_True) != TopAbs_OUT;
}

double Evaluator::reference_distance(bool is_face, std::uint32_t index, const std::array<double, 3>& point) const
{
  const TopoDS_Vertex vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(point[0], point[1], point[2]));
  const TopoDS_Shape entity = is_face ? TopoDS_Shape(model->face(index)) : TopoDS_Shape(model->edge(index));
  BRepExtrema_DistShapeShape measure(vertex, entity);
  if (!measure.IsDone() || measure.NbSolution() == 0) {
    throw std::runtime_error("no closest point found");
  }
  return measure.Value();
}

std::unique_ptr<Evaluator> new_evaluator(const std::shared_ptr<Model>& model)
{
  return std::make_unique<Evaluator>(model);
}

} // namespace geo_adapt
