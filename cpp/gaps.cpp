// Edges whose curves in space lie off the surfaces of their faces: CAD programs write them within their tolerances, which are many layers of a
// boundary layer (METHOD.md §3).
#include "geo-adapt/cpp/gaps.hpp"

#include <BRep_Builder.hxx>
#include <BRep_TEdge.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <Geom2dAPI_Interpolate.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Surface.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TColgp_HArray1OfPnt2d.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <gp_Mat.hxx>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace geo_adapt {
namespace {

/// An edge is moved where it is off its faces by more than this share of its length,
constexpr double OFF = 1e-5;
/// and by more than this, model units: OpenCASCADE takes what is nearer than half of it for one;
constexpr double LEAST = 2e-7;
/// where it is off by more than this share of its length the file is damaged, or means another edge.
constexpr double MOST = 0.05;
/// A point moves on by least squares of its distances from the surfaces, with this weight on the step: where surfaces touch nearly it stays.
constexpr double DAMPING = 0.1;
constexpr int STEPS = 20;
/// No point moves by more than so many times the greatest distance of the edge from its faces.
constexpr double FARTHEST_MOVE = 20.0;
/// A vertex that would move by less stays, model units.
constexpr double STILL = 1e-6;
/// Points that an edge is looked at by.
constexpr int LOOKS = 32;
/// A curve through so many points a knot span, then so many, then so many.
constexpr int POINTS[] = {4, 12, 36};
/// Most points of a curve.
constexpr int MOST_POINTS = 4000;
/// An edge is moved where that brings it to this share of its distance from its faces.
constexpr double NEARER = 0.5;
/// More points are kept only where they bring it to this share of the distance before.
constexpr double ENOUGH = 0.7;

using Uv = std::array<double, 2>;

/// A surface within its own range.
class Bounded
{
public:
  explicit Bounded(const TopoDS_Face& face) : surface(BRep_Tool::Surface(face))
  {
    surface->Bounds(low[0], high[0], low[1], high[1]);
    periodic = {surface->IsUPeriodic() == Standard_True, surface->IsVPeriodic() == Standard_True};
  }

  /// The closest point to one, from parameters near it, which become its own; and its unit normal, zero where there is none.
  std::pair<gp_XYZ, gp_XYZ> closest(const gp_XYZ& to, Uv& uv) const
  {
    gp_Pnt at;
    gp_Vec du, dv;
    for (int step = 0; step < STEPS; ++step) {
      surface->D1(uv[0], uv[1], at, du, dv);
      const gp_XYZ way = to - at.XYZ();
      const std::array<double, 2> slope{way.Dot(du.XYZ()), way.Dot(dv.XYZ())};
      std::array<bool, 2> stays{stays_at_border(uv, slope, 0), stays_at_border(uv, slope, 1)};
      const double a = du.SquareMagnitude(), b = du.Dot(dv), c = dv.SquareMagnitude();
      Uv change{0.0, 0.0};
      const double determinant = a * c - b * b;
      if (!stays[0] && !stays[1] && determinant > 1e-12 * a * c) {
        change = {(c * slope[0] - b * slope[1]) / determinant, (a * slope[1] - b * slope[0]) / determinant};
      } else {
        change[0] = !stays[0] && a > 0.0 ? slope[0] / a : 0.0;
        change[1] = stays[0] && !stays[1] && c > 0.0 ? slope[1] / c : 0.0;
      }
      const Uv before = uv;
      for (std::size_t k = 0; k < 2; ++k) {
        uv[k] += change[k];
        if (!periodic[k]) {
          uv[k] = std::min(std::max(uv[k], low[k]), high[k]);
        }
      }
      const double moved = std::abs(uv[0] - before[0]) * std::sqrt(a) + std::abs(uv[1] - before[1]) * std::sqrt(c);
      if (!(moved > 1e-15 + 1e-13 * at.XYZ().Modulus())) {
        break;
      }
    }
    surface->D1(uv[0], uv[1], at, du, dv);
    const gp_XYZ normal = du.XYZ().Crossed(dv.XYZ());
    const double length = normal.Modulus(), size = du.Magnitude() * dv.Magnitude();
    return {at.XYZ(), length > 1e-9 * size && size > 0.0 ? normal / length : gp_XYZ(0.0, 0.0, 0.0)};
  }

  gp_XYZ value(const Uv& uv) const { return surface->Value(uv[0], uv[1]).XYZ(); }

private:
  Handle(Geom_Surface) surface;
  std::array<double, 2> low{}, high{};
  std::array<bool, 2> periodic{};

  bool stays_at_border(const Uv& uv, const std::array<double, 2>& slope, std::size_t k) const
  {
    return !periodic[k] && ((uv[k] <= low[k] && slope[k] <= 0.0) || (uv[k] >= high[k] && slope[k] >= 0.0));
  }
};

/// A point on several surfaces, and its parameters on each.
struct Settled
{
  gp_XYZ point;
  std::vector<Uv> at;
};

/// The point near one where surfaces meet, by least squares of the distances from them; parameters near it are given.
Settled settled(const gp_XYZ& from, const std::vector<const Bounded*>& surfaces, std::vector<Uv> at)
{
  gp_XYZ point = from;
  for (int step = 0; step < STEPS; ++step) {
    gp_Mat matrix(DAMPING * DAMPING, 0, 0, 0, DAMPING * DAMPING, 0, 0, 0, DAMPING * DAMPING);
    gp_XYZ right(0.0, 0.0, 0.0);
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      auto [foot, direction] = surfaces[k]->closest(point, at[k]);
      const gp_XYZ way = foot - point;
      const double away = way.Modulus();
      if (away > 0.0 && (direction.Modulus() == 0.0 || way.Crossed(direction).Modulus() > 0.1 * away)) {
        direction = way / away; // at the border of the surface
      }
      gp_Mat outer;
      outer.SetRows(direction * direction.X(), direction * direction.Y(), direction * direction.Z());
      matrix += outer;
      right += direction * direction.Dot(way);
    }
    matrix.Invert();
    const gp_XYZ move = right * matrix;
    point += move;
    if (!(move.Modulus() > 1e-15 + 1e-13 * point.Modulus())) {
      break;
    }
  }
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    surfaces[k]->closest(point, at[k]);
  }
  return {point, at};
}

/// An edge between two faces.
struct Between
{
  TopoDS_Edge edge;
  std::vector<TopoDS_Face> faces;
  std::vector<Bounded> surfaces;
  Handle(Geom_Curve) curve;
  std::vector<Handle(Geom2d_Curve)> flat;
  double first = 0.0, last = 0.0, length = 0.0;
  /// The greatest distance from the surfaces.
  double off = 0.0;

  std::vector<const Bounded*> all() const
  {
    std::vector<const Bounded*> found;
    for (const Bounded& one : surfaces) {
      found.push_back(&one);
    }
    return found;
  }

  std::vector<Uv> parameters(double t) const
  {
    std::vector<Uv> found;
    for (const auto& one : flat) {
      const gp_Pnt2d at = one->Value(t);
      found.push_back({at.X(), at.Y()});
    }
    return found;
  }

  gp_XYZ point(double t) const { return curve->Value(t).XYZ(); }

  /// The greatest distance of a point from the surfaces.
  double distance(const gp_XYZ& from, std::vector<Uv> near) const
  {
    double greatest = 0.0;
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      greatest = std::max(greatest, (surfaces[k].closest(from, near[k]).first - from).Modulus());
    }
    return greatest;
  }
};

/// What is known of an edge between two faces; none where it has others, is a seam, or has no curves.
std::optional<Between> between(const TopoDS_Shape& shape, const TopTools_ListOfShape& around)
{
  Between found;
  found.edge = TopoDS::Edge(shape.Oriented(TopAbs_FORWARD));
  if (around.Extent() != 2 || around.First().IsSame(around.Last()) || BRep_Tool::Degenerated(found.edge)) {
    return {};
  }
  found.curve = BRep_Tool::Curve(found.edge, found.first, found.last);
  if (found.curve.IsNull() || !(found.last > found.first)) {
    return {};
  }
  for (const TopoDS_Shape& one : around) {
    const TopoDS_Face face = TopoDS::Face(one.Oriented(TopAbs_FORWARD));
    double first = 0.0, last = 0.0;
    const Handle(Geom2d_Curve) flat = BRep_Tool::CurveOnSurface(found.edge, face, first, last);
    if (flat.IsNull() || BRep_Tool::Surface(face).IsNull() || std::abs(first - found.first) + std::abs(last - found.last) > 1e-9 * (last - first)) {
      return {};
    }
    found.faces.push_back(face);
    found.surfaces.emplace_back(face);
    found.flat.push_back(flat);
  }
  found.length = GCPnts_AbscissaPoint::Length(GeomAdaptor_Curve(found.curve, found.first, found.last));
  for (int i = 0; i <= LOOKS; ++i) {
    const double t = found.first + (found.last - found.first) * i / LOOKS;
    found.off = std::max(found.off, found.distance(found.point(t), found.parameters(t)));
  }
  return found;
}

/// The curves of an edge that was moved.
struct Moved
{
  Handle(Geom_BSplineCurve) curve;
  std::vector<Handle(Geom2d_BSplineCurve)> flat;
  /// The greatest distance from the surfaces, by the curve in space and those on the surfaces.
  double off = 0.0;
};

/// Parameters for the points of a curve: so many a knot span.
std::vector<double> places(const Between& edge, int each)
{
  GeomAdaptor_Curve adaptor(edge.curve, edge.first, edge.last);
  std::vector<double> ends{edge.first, edge.last};
  if (const int spans = adaptor.NbIntervals(GeomAbs_CN); spans > 1) {
    TColStd_Array1OfReal knots(1, spans + 1);
    adaptor.Intervals(knots, GeomAbs_CN);
    ends.assign(knots.begin(), knots.end());
  }
  each *= ends.size() < 9 ? 8 : 1;
  std::vector<double> found;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    for (int i = 0; i < each; ++i) {
      found.push_back(ends[k] + (ends[k + 1] - ends[k]) * i / each);
    }
  }
  found.push_back(edge.last);
  return found;
}

/// Curves through points on the surfaces, so many a knot span, between ends that are given; none where points go far, or are too many.
std::optional<Moved> through(const Between& edge, const std::array<gp_XYZ, 2>& ends, int each)
{
  const std::vector<double> t = places(edge, each);
  const int count = static_cast<int>(t.size());
  if (count > MOST_POINTS) {
    return {};
  }
  const std::array<gp_XYZ, 2> shifts{ends[0] - edge.point(edge.first), ends[1] - edge.point(edge.last)};
  const std::vector<const Bounded*> surfaces = edge.all();
  const double farthest = FARTHEST_MOVE * std::max({edge.off, shifts[0].Modulus(), shifts[1].Modulus()});
  const auto on = [&](double at, std::vector<Uv> near) {
    const double s = (at - edge.first) / (edge.last - edge.first);
    return settled(edge.point(at) + shifts[0] * (1.0 - s) + shifts[1] * s, surfaces, std::move(near));
  };
  Handle(TColStd_HArray1OfReal) parameters = new TColStd_HArray1OfReal(1, count);
  Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, count);
  std::vector<Handle(TColgp_HArray1OfPnt2d)> flat;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    flat.push_back(new TColgp_HArray1OfPnt2d(1, count));
  }
  for (int i = 0; i < count; ++i) {
    const double at = t[static_cast<std::size_t>(i)];
    Settled here{i == 0 ? ends[0] : ends[1], edge.parameters(at)};
    if (i > 0 && i + 1 < count) {
      here = on(at, here.at);
    } else {
      for (std::size_t k = 0; k < surfaces.size(); ++k) {
        surfaces[k]->closest(here.point, here.at[k]);
      }
    }
    if (!((here.point - edge.point(at)).Modulus() <= farthest)) {
      return {};
    }
    parameters->SetValue(i + 1, at);
    points->SetValue(i + 1, gp_Pnt(here.point));
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      flat[k]->SetValue(i + 1, gp_Pnt2d(here.at[k][0], here.at[k][1]));
    }
  }
  Moved made;
  GeomAPI_Interpolate in_space(points, parameters, Standard_False, 1e-14);
  in_space.Perform();
  if (!in_space.IsDone()) {
    return {};
  }
  made.curve = in_space.Curve();
  for (const auto& one : flat) {
    Geom2dAPI_Interpolate on_surface(one, parameters, Standard_False, 1e-14);
    on_surface.Perform();
    if (!on_surface.IsDone()) {
      return {};
    }
    made.flat.push_back(on_surface.Curve());
  }
  // How far the curve is from the surfaces, and from those on them, between the points and at them.
  for (int i = 0; i < 2 * count - 1; ++i) {
    const auto k = static_cast<std::size_t>(i / 2);
    const double at = i % 2 == 0 ? t[k] : 0.5 * (t[k] + t[k + 1]);
    const gp_XYZ point = made.curve->Value(at).XYZ();
    std::vector<Uv> near;
    for (std::size_t side = 0; side < surfaces.size(); ++side) {
      const gp_Pnt2d uv = made.flat[side]->Value(at);
      near.push_back({uv.X(), uv.Y()});
      made.off = std::max(made.off, (surfaces[side]->value(near.back()) - point).Modulus());
    }
    made.off = std::max(made.off, edge.distance(point, near));
  }
  return made;
}

/// The best of such curves; none where an edge that `is_off` its faces comes no nearer to them, or another one is off them then.
std::optional<Moved> moved(const Between& edge, const std::array<gp_XYZ, 2>& ends, bool is_off)
{
  const double most = std::max(is_off ? NEARER * edge.off : edge.off, LEAST);
  std::optional<Moved> best;
  for (const int each : POINTS) {
    std::optional<Moved> made = through(edge, ends, each);
    const bool gains = made && made->off <= (best ? ENOUGH * best->off : most);
    if (best && !gains) {
      break;
    }
    if (gains) {
      best = std::move(made);
    }
  }
  return best;
}

/// The ends of an edge.
std::array<TopoDS_Vertex, 2> ends_of(const TopoDS_Edge& edge)
{
  return {TopExp::FirstVertex(edge), TopExp::LastVertex(edge)};
}

void put(const Between& edge, const Moved& to)
{
  const BRep_Builder builder;
  const double tolerance = std::max(to.off, Precision::Confusion());
  builder.UpdateEdge(edge.edge, to.curve, TopLoc_Location(), tolerance);
  for (std::size_t k = 0; k < edge.faces.size(); ++k) {
    builder.UpdateEdge(edge.edge, to.flat[k], edge.faces[k], tolerance);
  }
  builder.Range(edge.edge, edge.first, edge.last);
  builder.SameRange(edge.edge, Standard_True);
  builder.SameParameter(edge.edge, Standard_True);
  Handle(BRep_TEdge)::DownCast(edge.edge.TShape())->Tolerance(tolerance);
}

/// Where a vertex goes: onto all its faces. None where it is there, has no parameters on one of them, or would go far.
std::optional<gp_XYZ> met(const TopoDS_Vertex& vertex, const TopTools_ListOfShape& around, double off)
{
  std::vector<Bounded> own;
  std::vector<Uv> at;
  for (const TopoDS_Shape& one : around) {
    const TopoDS_Face face = TopoDS::Face(one.Oriented(TopAbs_FORWARD));
    if (BRep_Tool::Surface(face).IsNull()) {
      return {};
    }
    gp_Pnt2d uv;
    try {
      uv = BRep_Tool::Parameters(vertex, face);
    } catch (const Standard_Failure&) {
      return {}; // it has none, on a face that it is a loose vertex of
    }
    own.emplace_back(face);
    at.push_back({uv.X(), uv.Y()});
  }
  std::vector<const Bounded*> surfaces;
  for (const Bounded& one : own) {
    surfaces.push_back(&one);
  }
  const gp_XYZ from = BRep_Tool::Pnt(vertex).XYZ(), to = settled(from, surfaces, at).point;
  const double way = (to - from).Modulus();
  return way > STILL && way <= FARTHEST_MOVE * off ? std::optional<gp_XYZ>(to) : std::nullopt;
}

using Around = TopTools_IndexedDataMapOfShapeListOfShape;

/// The edges, vertices and faces of a shape.
struct Shapes
{
  Around faces_of_edge, faces_of_vertex, edges_of_vertex;

  explicit Shapes(const TopoDS_Shape& shape)
  {
    TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of_edge);
    TopExp::MapShapesAndUniqueAncestors(shape, TopAbs_VERTEX, TopAbs_FACE, faces_of_vertex);
    TopExp::MapShapesAndUniqueAncestors(shape, TopAbs_VERTEX, TopAbs_EDGE, edges_of_vertex);
  }

  TopoDS_Edge edge(int i) const { return TopoDS::Edge(faces_of_edge.FindKey(i).Oriented(TopAbs_FORWARD)); }

  /// The number of a vertex; 0 where there is none.
  int number(const TopoDS_Vertex& vertex) const { return vertex.IsNull() ? 0 : faces_of_vertex.FindIndex(vertex); }

  /// The numbers of the edges at a vertex.
  std::vector<int> edges_at(int vertex) const
  {
    std::vector<int> found;
    if (const TopTools_ListOfShape* all = edges_of_vertex.Seek(faces_of_vertex.FindKey(vertex)); all != nullptr) {
      for (const TopoDS_Shape& edge : *all) {
        found.push_back(faces_of_edge.FindIndex(edge));
      }
    }
    return found;
  }
};

/// What is to be done: curves of edges, and new points of vertices, by their numbers.
struct Changes
{
  std::map<int, std::pair<Between, Moved>> edges;
  std::map<int, gp_XYZ> vertices;
};

/// Finds what is to be moved. A vertex stays where an edge at it cannot follow.
Changes changes(const Shapes& shapes)
{
  std::map<int, Between> off;
  std::map<int, double> at_vertex;
  for (int i = 1; i <= shapes.faces_of_edge.Extent(); ++i) {
    std::optional<Between> one = between(shapes.edge(i), shapes.faces_of_edge(i));
    if (one && one->off > std::max(OFF * one->length, LEAST) && one->off < MOST * one->length) {
      for (const TopoDS_Vertex& end : ends_of(one->edge)) {
        double& most = at_vertex[shapes.number(end)];
        most = std::max(most, one->off);
      }
      off.emplace(i, std::move(*one));
    }
  }
  Changes all;
  std::set<int> left;
  for (const auto& one : off) {
    left.insert(one.first);
  }
  for (const auto& [vertex, most] : at_vertex) {
    if (vertex == 0) {
      continue;
    }
    const TopoDS_Vertex here = TopoDS::Vertex(shapes.faces_of_vertex.FindKey(vertex));
    if (const auto to = met(here, shapes.faces_of_vertex(vertex), most)) {
      all.vertices.emplace(vertex, *to);
      for (const int edge : shapes.edges_at(vertex)) {
        left.insert(edge);
      }
    }
  }
  while (!left.empty()) {
    const int i = *left.begin();
    left.erase(left.begin());
    all.edges.erase(i);
    if (i == 0) {
      continue; // an edge of no face
    }
    const auto known = off.find(i);
    const TopoDS_Edge edge = shapes.edge(i);
    const auto ends = ends_of(edge);
    std::array<int, 2> numbers{};
    std::array<gp_XYZ, 2> to;
    bool has_moved_end = false;
    for (std::size_t k = 0; k < 2; ++k) {
      numbers[k] = shapes.number(ends[k]);
      const auto place = all.vertices.find(numbers[k]);
      has_moved_end = has_moved_end || place != all.vertices.end();
      to[k] = place != all.vertices.end() ? place->second : ends[k].IsNull() ? gp_XYZ() : BRep_Tool::Pnt(ends[k]).XYZ();
    }
    if ((known == off.end() && !has_moved_end) || ends[0].IsNull() || ends[1].IsNull()) {
      continue;
    }
    const std::optional<Between> one =
      known != off.end() ? std::optional<Between>(known->second) : between(edge, shapes.faces_of_edge(i));
    const std::optional<Moved> made = one ? moved(*one, to, known != off.end()) : std::nullopt;
    if (made) {
      all.edges.emplace(i, std::make_pair(*one, *made));
      continue;
    }
    for (const int vertex : numbers) {
      if (all.vertices.erase(vertex) > 0) {
        for (const int beside : shapes.edges_at(vertex)) {
          left.insert(beside);
        }
      }
    }
  }
  return all;
}

} // namespace

std::vector<Gap> without_gaps(const TopoDS_Shape& shape)
{
  const Shapes shapes(shape);
  std::vector<Gap> done;
  try {
    const Changes all = changes(shapes);
    const BRep_Builder builder;
    for (const auto& [vertex, to] : all.vertices) {
      const TopoDS_Vertex here = TopoDS::Vertex(shapes.faces_of_vertex.FindKey(vertex));
      builder.UpdateVertex(here, gp_Pnt(to), Precision::Confusion());
    }
    TopTools_IndexedMapOfShape numbers;
    TopExp::MapShapes(shape, TopAbs_EDGE, numbers);
    for (const auto& [i, edge] : all.edges) {
      put(edge.first, edge.second);
      // The others have followed an end.
      if (edge.first.off > edge.second.off) {
        done.push_back({static_cast<std::uint64_t>(numbers.FindIndex(shapes.faces_of_edge.FindKey(i))) - 1, edge.first.off, edge.second.off});
      }
    }
  } catch (const Standard_Failure&) {
    // What OpenCASCADE cannot evaluate stays as it is: nothing is changed before all is found.
    done.clear();
  }
  return done;
}

} // namespace geo_adapt
