// Copying of splines and conics, the location of their face or edge applied.
#include "geo-adapt/cpp/splines.hpp"
#include "geo-adapt/src/geometry/occt/bridge.rs.h"

#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_BezierCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Ellipse.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>

namespace geo_adapt {
namespace {

// The kinds of a Spline; bridge.rs tells their fields.
enum Kind : std::uint32_t { NONE, SPLINE, LINE, ELLIPSE, HYPERBOLA, PARABOLA, REVOLUTION, EXTRUSION };

std::array<double, 3> numbers(const gp_XYZ& value)
{
  return {value.X(), value.Y(), value.Z()};
}

void add_pole(Spline& out, const gp_XYZ& point, double weight)
{
  for (const double x : {weight * point.X(), weight * point.Y(), weight * point.Z(), weight}) {
    out.poles.push_back(x);
  }
}

void add_knots(Spline& out, const TColStd_Array1OfReal& flat)
{
  for (int i = flat.Lower(); i <= flat.Upper(); ++i) {
    out.knots.push_back(flat(i));
  }
}

/// Knots of a Bezier curve: 0 and 1, degree + 1 times.
void add_bezier_knots(Spline& out, int degree)
{
  for (int i = 0; i < 2 * (degree + 1); ++i) {
    out.knots.push_back(i > degree ? 1.0 : 0.0);
  }
}

gp_XYZ flat(const gp_Pnt2d& point)
{
  return gp_XYZ(point.X(), point.Y(), 0.0);
}

/// A frame: origin and two axes with their lengths.
void set_conic(Spline& out, Kind kind, const gp_XYZ& origin, const gp_XYZ& x, const gp_XYZ& y)
{
  out.kind = kind;
  out.origin = numbers(origin);
  out.x = numbers(x);
  out.y = numbers(y);
}

/// A conic of space, moved. Each axis is given with its length.
void set_conic(Spline& out, Kind kind, const gp_Ax2& axes, double x, double y, const gp_Trsf& move)
{
  const gp_Vec along = gp_Vec(axes.XDirection()) * x, across = gp_Vec(axes.YDirection()) * y;
  set_conic(out, kind, axes.Location().Transformed(move).XYZ(), along.Transformed(move).XYZ(),
            across.Transformed(move).XYZ());
}

/// A B-spline of the plane or of space; `place` gives the coordinates of a pole.
template <typename Curve, typename Place>
void add_spline(Spline& out, const Curve& curve, const Place& place)
{
  out.kind = SPLINE;
  out.degrees[0] = static_cast<std::uint32_t>(curve->Degree());
  out.periods[0] = curve->IsPeriodic() ? curve->Period() : 0.0;
  out.rational = curve->IsRational();
  add_knots(out, curve->KnotSequence());
  const int count = curve->KnotSequence().Length() - curve->Degree() - 1;
  for (int i = 0; i < count; ++i) {
    const int pole = 1 + i % curve->NbPoles();
    add_pole(out, place(curve->Pole(pole)), curve->Weight(pole));
  }
}

/// A Bezier curve, as a B-spline.
template <typename Curve, typename Place>
void add_bezier(Spline& out, const Curve& curve, const Place& place)
{
  out.kind = SPLINE;
  out.degrees[0] = static_cast<std::uint32_t>(curve->Degree());
  out.rational = curve->IsRational();
  add_bezier_knots(out, curve->Degree());
  for (int i = 1; i <= curve->NbPoles(); ++i) {
    add_pole(out, place(curve->Pole(i)), curve->Weight(i));
  }
}

void set_curve(Spline& out, const Handle(Geom_Curve)& curve, const gp_Trsf& move)
{
  const auto moved = [&](const gp_Pnt& point) { return point.Transformed(move).XYZ(); };
  if (const auto trimmed = Handle(Geom_TrimmedCurve)::DownCast(curve); !trimmed.IsNull()) {
    set_curve(out, trimmed->BasisCurve(), move);
  } else if (const auto spline = Handle(Geom_BSplineCurve)::DownCast(curve); !spline.IsNull()) {
    add_spline(out, spline, moved);
  } else if (const auto bezier = Handle(Geom_BezierCurve)::DownCast(curve); !bezier.IsNull()) {
    add_bezier(out, bezier, moved);
  } else if (const auto line = Handle(Geom_Line)::DownCast(curve); !line.IsNull()) {
    const gp_XYZ along = gp_Vec(line->Lin().Direction()).Transformed(move).XYZ();
    set_conic(out, LINE, line->Lin().Location().Transformed(move).XYZ(), along, along);
  } else if (const auto circle = Handle(Geom_Circle)::DownCast(curve); !circle.IsNull()) {
    set_conic(out, ELLIPSE, circle->Position(), circle->Radius(), circle->Radius(), move);
  } else if (const auto ellipse = Handle(Geom_Ellipse)::DownCast(curve); !ellipse.IsNull()) {
    set_conic(out, ELLIPSE, ellipse->Position(), ellipse->MajorRadius(), ellipse->MinorRadius(), move);
  } else if (const auto hyperbola = Handle(Geom_Hyperbola)::DownCast(curve); !hyperbola.IsNull()) {
    set_conic(out, HYPERBOLA, hyperbola->Position(), hyperbola->MajorRadius(), hyperbola->MinorRadius(), move);
  } else if (const auto parabola = Handle(Geom_Parabola)::DownCast(curve); !parabola.IsNull()) {
    set_conic(out, PARABOLA, parabola->Position(), 0.25 / parabola->Focal(), 1.0, move);
  }
}

void set_pcurve(Spline& out, const Handle(Geom2d_Curve)& curve)
{
  const auto conic = [&](const gp_Ax22d& axes, double x, double y) {
    set_conic(out, ELLIPSE, flat(axes.Location()), flat(axes.XDirection().XY()) * x, flat(axes.YDirection().XY()) * y);
  };
  if (const auto trimmed = Handle(Geom2d_TrimmedCurve)::DownCast(curve); !trimmed.IsNull()) {
    set_pcurve(out, trimmed->BasisCurve());
  } else if (const auto spline = Handle(Geom2d_BSplineCurve)::DownCast(curve); !spline.IsNull()) {
    add_spline(out, spline, flat);
  } else if (const auto bezier = Handle(Geom2d_BezierCurve)::DownCast(curve); !bezier.IsNull()) {
    add_bezier(out, bezier, flat);
  } else if (const auto line = Handle(Geom2d_Line)::DownCast(curve); !line.IsNull()) {
    const gp_XYZ along = flat(line->Direction().XY());
    set_conic(out, LINE, flat(line->Location()), along, along);
  } else if (const auto circle = Handle(Geom2d_Circle)::DownCast(curve); !circle.IsNull()) {
    conic(circle->Circ2d().Axis(), circle->Radius(), circle->Radius());
  } else if (const auto ellipse = Handle(Geom2d_Ellipse)::DownCast(curve); !ellipse.IsNull()) {
    conic(ellipse->Elips2d().Axis(), ellipse->MajorRadius(), ellipse->MinorRadius());
  }
}

/// The surface of a face without its trimming, and the move that places it.
Handle(Geom_Surface) untrimmed(const Model& model, std::uint32_t face, gp_Trsf& move)
{
  TopLoc_Location location;
  Handle(Geom_Surface) surface = BRep_Tool::Surface(model.face(face), location);
  move = location.Transformation();
  for (;;) {
    const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
    if (trimmed.IsNull()) {
      return surface;
    }
    surface = trimmed->BasisSurface();
  }
}

void set_spline(Spline& out, const Handle(Geom_BSplineSurface)& surface, const gp_Trsf& move)
{
  out.kind = SPLINE;
  out.degrees = {static_cast<std::uint32_t>(surface->UDegree()), static_cast<std::uint32_t>(surface->VDegree())};
  out.periods = {surface->IsUPeriodic() ? surface->UPeriod() : 0.0, surface->IsVPeriodic() ? surface->VPeriod() : 0.0};
  out.rational = surface->IsURational() || surface->IsVRational();
  add_knots(out, surface->UKnotSequence());
  add_knots(out, surface->VKnotSequence());
  out.first_knots = static_cast<std::uint32_t>(surface->UKnotSequence().Length());
  const int rows = surface->UKnotSequence().Length() - surface->UDegree() - 1;
  const int columns = surface->VKnotSequence().Length() - surface->VDegree() - 1;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int u = 1 + i % surface->NbUPoles(), v = 1 + j % surface->NbVPoles();
      add_pole(out, surface->Pole(u, v).Transformed(move).XYZ(), surface->Weight(u, v));
    }
  }
}

void set_bezier(Spline& out, const Handle(Geom_BezierSurface)& surface, const gp_Trsf& move)
{
  out.kind = SPLINE;
  out.degrees = {static_cast<std::uint32_t>(surface->UDegree()), static_cast<std::uint32_t>(surface->VDegree())};
  out.rational = surface->IsURational() || surface->IsVRational();
  add_bezier_knots(out, surface->UDegree());
  add_bezier_knots(out, surface->VDegree());
  out.first_knots = static_cast<std::uint32_t>(2 * (surface->UDegree() + 1));
  for (int i = 1; i <= surface->NbUPoles(); ++i) {
    for (int j = 1; j <= surface->NbVPoles(); ++j) {
      add_pole(out, surface->Pole(i, j).Transformed(move).XYZ(), surface->Weight(i, j));
    }
  }
}

} // namespace

Spline surface_spline(const Model& model, std::uint32_t face)
{
  Spline out{};
  gp_Trsf move;
  const Handle(Geom_Surface) surface = untrimmed(model, face, move);
  if (const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface); !spline.IsNull()) {
    set_spline(out, spline, move);
  } else if (const auto bezier = Handle(Geom_BezierSurface)::DownCast(surface); !bezier.IsNull()) {
    set_bezier(out, bezier, move);
  } else if (const auto turned = Handle(Geom_SurfaceOfRevolution)::DownCast(surface); !turned.IsNull()) {
    // A mirrored turn goes the other way about.
    const gp_Dir axis = turned->Axis().Direction().Transformed(move);
    const gp_XYZ along = move.IsNegative() ? axis.Reversed().XYZ() : axis.XYZ();
    set_conic(out, REVOLUTION, turned->Axis().Location().Transformed(move).XYZ(), along, along);
  } else if (const auto drawn = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(surface); !drawn.IsNull()) {
    const gp_XYZ along = gp_Vec(drawn->Direction()).Transformed(move).XYZ();
    set_conic(out, EXTRUSION, gp_XYZ(0.0, 0.0, 0.0), along, along);
  }
  return out;
}

Spline surface_generatrix(const Model& model, std::uint32_t face)
{
  Spline out{};
  gp_Trsf move;
  const Handle(Geom_Surface) surface = untrimmed(model, face, move);
  if (const auto swept = Handle(Geom_SweptSurface)::DownCast(surface); !swept.IsNull()) {
    set_curve(out, swept->BasisCurve(), move);
  }
  return out;
}

Spline curve_spline(const Model& model, std::uint32_t edge)
{
  Spline out{};
  TopLoc_Location location;
  double first = 0.0, last = 0.0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(model.edge(edge), location, first, last);
  if (!curve.IsNull()) {
    set_curve(out, curve, location.Transformation());
  }
  return out;
}

Spline pcurve_spline(const Model& model, std::uint32_t edge, std::uint32_t face, bool reversed)
{
  Spline out{};
  TopoDS_Edge here = model.edge(edge);
  if (reversed) {
    here.Reverse();
  }
  double first = 0.0, last = 0.0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(here, model.face(face), first, last);
  if (!curve.IsNull()) {
    set_pcurve(out, curve);
  }
  return out;
}

} // namespace geo_adapt
