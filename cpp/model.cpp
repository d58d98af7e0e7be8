// The entities of a loaded model.
#include "geo-adapt/cpp/occt.hpp"
#include "geo-adapt/src/geometry/occt/bridge.rs.h"

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace geo_adapt {
namespace {

std::array<double, 3> coordinates(const gp_Pnt& point)
{
  return {point.X(), point.Y(), point.Z()};
}

/// Least and greatest coordinates; zeros where there is nothing.
std::array<double, 6> corners(const Bnd_Box& bounds)
{
  if (bounds.IsVoid()) {
    return {};
  }
  if (bounds.IsOpen()) {
    throw std::runtime_error("the model is unbounded; trim its surfaces");
  }
  const gp_Pnt low = bounds.CornerMin(), high = bounds.CornerMax();
  return {low.X(), low.Y(), low.Z(), high.X(), high.Y(), high.Z()};
}

std::array<double, 6> box(const TopoDS_Shape& shape)
{
  Bnd_Box bounds;
  BRepBndLib::AddOptimal(shape, bounds, Standard_False, Standard_False);
  bounds.SetGap(0.0);
  return corners(bounds);
}

/// Whether OCCT's box of the edge's p-curve is exact rather than a numerical extremum.
bool has_exact_box(const TopoDS_Edge& edge, const TopoDS_Face& face)
{
  double first = 0.0, last = 0.0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull()) {
    return false;
  }
  const GeomAbs_CurveType type = Geom2dAdaptor_Curve(curve).GetType();
  return type == GeomAbs_Line || type == GeomAbs_Circle || type == GeomAbs_Ellipse;
}

/// Greatest coordinate: products of three are to be numbers.
constexpr double FARTHEST = 1e100;

/// Whether no sample of a surface's range is at infinity.
bool is_finite(const BRepAdaptor_Surface& surface, const std::array<double, 4>& range)
{
  constexpr int SAMPLES = 4;
  for (int i = 0; i <= SAMPLES; ++i) {
    for (int j = 0; j <= SAMPLES; ++j) {
      const double u = range[0] + (range[1] - range[0]) * i / SAMPLES, v = range[2] + (range[3] - range[2]) * j / SAMPLES;
      try {
        // A comparison with NaN is false.
        if (!(surface.Value(u, v).XYZ().Modulus() < FARTHEST)) {
          return false;
        }
      } catch (const Standard_Failure&) {
        // An offset surface has no point at a pole.
      }
    }
  }
  return true;
}

/// Most turns of a face round a periodic surface.
constexpr double TURNS = 1e5;

/// The length of an edge that has a curve on a surface and none in space, by Simpson's rule. OCCT's own integration may crash on one.
double length_on_surface(const BRepAdaptor_Curve& curve)
{
  constexpr int PARTS = 256;
  const double first = curve.FirstParameter(), step = (curve.LastParameter() - first) / PARTS;
  double sum = 0.0;
  for (int i = 0; i <= PARTS; ++i) {
    gp_Pnt at;
    gp_Vec along;
    curve.D1(first + i * step, at, along);
    sum += along.Magnitude() * (i == 0 || i == PARTS ? 1.0 : i % 2 == 1 ? 4.0 : 2.0);
  }
  return sum * std::abs(step) / 3.0;
}

} // namespace

Model::Model(const TopoDS_Shape& loaded, const Labels& given, const TopoDS_Shape& whole, std::vector<Box> known,
             std::vector<DoubleWall> divided, std::vector<Gap> closed)
  : shape(loaded), joined(whole.IsNull() ? loaded : whole), labels(given), walls(std::move(divided)), gaps(std::move(closed)),
    boxes(known.begin(), known.end())
{
  TopExp::MapShapes(shape, TopAbs_SOLID, solids);
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  TopExp::MapShapes(shape, TopAbs_VERTEX, vertices);
  if (boxes.size() != face_count() + 1) {
    boxes.assign(face_count() + 1, std::nullopt);
  }
}

rust::Vec<DoubleWallRecord> Model::double_walls() const
{
  rust::Vec<DoubleWallRecord> all;
  for (const DoubleWall& wall : walls) {
    all.push_back({wall.at, wall.solids});
  }
  return all;
}

rust::Vec<GapRecord> Model::gaps_closed() const
{
  rust::Vec<GapRecord> all;
  for (const Gap& gap : gaps) {
    all.push_back({gap.edge, gap.before, gap.after});
  }
  return all;
}

TopoDS_Face Model::face(std::uint32_t index) const
{
  return TopoDS::Face(faces(static_cast<int>(index) + 1).Oriented(TopAbs_FORWARD));
}

TopoDS_Edge Model::edge(std::uint32_t index) const
{
  return TopoDS::Edge(edges(static_cast<int>(index) + 1).Oriented(TopAbs_FORWARD));
}

std::uint32_t Model::solid_count() const
{
  return static_cast<std::uint32_t>(solids.Extent());
}

FaceRecord Model::face_record(std::uint32_t index) const
{
  const TopoDS_Face here = face(index);
  if (BRep_Tool::Surface(here).IsNull()) {
    throw std::runtime_error("a face has no surface; export exact geometry, not triangles");
  }
  const BRepAdaptor_Surface surface(here, Standard_False);
  FaceRecord record{};
  record.kind = static_cast<std::uint32_t>(surface.GetType());
  record.reversed = faces(static_cast<int>(index) + 1).Orientation() == TopAbs_REVERSED;
  BRepTools::UVBounds(here, record.range[0], record.range[1], record.range[2], record.range[3]);
  for (const double bound : record.range) {
    if (!std::isfinite(bound) || Precision::IsInfinite(bound)) {
      throw std::runtime_error("a face is unbounded; trim the model's surfaces");
    }
  }
  record.exact_range = true;
  record.spans = {static_cast<std::uint32_t>(surface.NbUIntervals(GeomAbs_CN)),
                  static_cast<std::uint32_t>(surface.NbVIntervals(GeomAbs_CN))};
  record.natural = {surface.FirstUParameter(), surface.LastUParameter(), surface.FirstVParameter(),
                    surface.LastVParameter()};
  record.period = {surface.IsUPeriodic() ? surface.UPeriod() : 0.0, surface.IsVPeriodic() ? surface.VPeriod() : 0.0};
  for (const std::size_t k : {0, 1}) {
    // OCCT walks to parameters turn by turn.
    if (record.range[2 * k + 1] - record.range[2 * k] > TURNS * record.period[k] && record.period[k] > 0.0) {
      throw std::runtime_error("face " + std::to_string(index + 1)
                               + " goes round its surface too often; its boundary is damaged, export the model again");
    }
  }
  if (!is_finite(surface, record.range)) {
    throw std::runtime_error("face " + std::to_string(index + 1)
                             + " has points at infinity; its surface is damaged, export the model again");
  }
  record.tolerance = BRep_Tool::Tolerance(here);
  record.bounds = bounds_of(index);
  for (TopExp_Explorer it(here, TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(it.Current());
    record.edges.push_back(static_cast<std::uint32_t>(edges.FindIndex(edge) - 1));
    record.exact_range = record.exact_range && has_exact_box(edge, here);
  }
  return record;
}

EdgeRecord Model::edge_record(std::uint32_t index) const
{
  const TopoDS_Edge here = edge(index);
  EdgeRecord record{};
  TopoDS_Vertex first, last;
  TopExp::Vertices(here, first, last);
  record.vertices = {first.IsNull() ? -1 : vertices.FindIndex(first) - 1, last.IsNull() ? -1 : vertices.FindIndex(last) - 1};
  record.tolerance = BRep_Tool::Tolerance(here);
  record.degenerate = BRep_Tool::Degenerated(here);
  BRep_Tool::Range(here, record.range[0], record.range[1]);
  if (!record.degenerate) {
    const BRepAdaptor_Curve curve(here);
    record.kind = static_cast<std::uint32_t>(curve.GetType());
    record.range = {curve.FirstParameter(), curve.LastParameter()};
    record.spans = static_cast<std::uint32_t>(curve.NbIntervals(GeomAbs_CN));
    record.period = curve.IsPeriodic() ? curve.Period() : 0.0;
    if (Precision::IsInfinite(record.range[0]) || Precision::IsInfinite(record.range[1])) {
      throw std::runtime_error("an edge is unbounded; trim the model's curves");
    }
  }
  return record;
}

Model::Box Model::bounds() const
{
  if (!boxes.back()) {
    // OCCT's box of the whole would measure each face again.
    Bnd_Box all;
    for (std::uint32_t index = 0; index < face_count(); ++index) {
      const Box& one = bounds_of(index);
      if (one != Box{}) {
        all.Update(one[0], one[1], one[2], one[3], one[4], one[5]);
      }
    }
    boxes.back() = corners(all);
  }
  return *boxes.back();
}

const Model::Box& Model::bounds_of(std::uint32_t index) const
{
  auto& known = boxes.at(index);
  if (!known) {
    known = box(face(index));
  }
  return *known;
}

VertexRecord Model::vertex_record(std::uint32_t index) const
{
  const TopoDS_Vertex here = TopoDS::Vertex(vertices(static_cast<int>(index) + 1));
  VertexRecord record{};
  record.point = coordinates(BRep_Tool::Pnt(here));
  record.tolerance = BRep_Tool::Tolerance(here);
  return record;
}

double Model::face_area(std::uint32_t index) const
{
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face(index), properties);
  return properties.Mass();
}

std::array<double, 3> Model::face_centre(std::uint32_t index) const
{
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face(index), properties);
  const gp_Pnt centre = properties.CentreOfMass();
  return {centre.X(), centre.Y(), centre.Z()};
}

double Model::edge_length(std::uint32_t index) const
{
  const BRepAdaptor_Curve curve(edge(index));
  if (!curve.Is3DCurve()) {
    return length_on_surface(curve);
  }
  GProp_GProps properties;
  BRepGProp::LinearProperties(edge(index), properties);
  return properties.Mass();
}

} // namespace geo_adapt
