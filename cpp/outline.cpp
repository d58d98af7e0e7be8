// What bounds the faces and the solids of a model: wires with the orientation of their edges, curves in the parameters of a face, sides.
#include "geo-adapt/cpp/occt.hpp"
#include "geo-adapt/src/geometry/occt/bridge.rs.h"

#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>

#include <stdexcept>

namespace geo_adapt {

rust::Vec<EdgeUse> Model::edge_uses(std::uint32_t index) const
{
  rust::Vec<EdgeUse> uses;
  std::uint32_t wire = 0;
  for (TopExp_Explorer of(face(index), TopAbs_WIRE); of.More(); of.Next(), ++wire) {
    for (TopExp_Explorer it(of.Current(), TopAbs_EDGE); it.More(); it.Next()) {
      const int number = edges.FindIndex(it.Current());
      if (number > 0) {
        uses.push_back({static_cast<std::uint32_t>(number - 1), wire, static_cast<std::uint32_t>(it.Current().Orientation())});
      }
    }
  }
  return uses;
}

rust::Vec<std::uint32_t> Model::loose_vertices(std::uint32_t index) const
{
  rust::Vec<std::uint32_t> found;
  for (TopExp_Explorer it(face(index), TopAbs_VERTEX, TopAbs_EDGE); it.More(); it.Next()) {
    found.push_back(static_cast<std::uint32_t>(vertices.FindIndex(it.Current()) - 1));
  }
  return found;
}

bool Model::edge_parameters(std::uint32_t index, std::uint32_t on, bool reversed, rust::Slice<const double> t,
                            rust::Slice<double> uv) const
{
  if (uv.size() < 2 * t.size()) {
    throw std::logic_error("no room for the parameters");
  }
  const TopoDS_Edge here = TopoDS::Edge(edge(index).Oriented(reversed ? TopAbs_REVERSED : TopAbs_FORWARD));
  double first = 0.0, last = 0.0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(here, face(on), first, last);
  if (curve.IsNull()) {
    return false;
  }
  // The range of the curve in space, where there is one: the two may differ.
  double from = first, to = last;
  if (!BRep_Tool::Degenerated(here)) {
    const BRepAdaptor_Curve space(edge(index));
    from = space.FirstParameter();
    to = space.LastParameter();
  }
  const bool is_same = from == first && to == last;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double s = is_same || to == from ? t[i] : first + (last - first) * ((t[i] - from) / (to - from));
    const gp_Pnt2d point = curve->Value(s);
    uv[2 * i] = point.X();
    uv[2 * i + 1] = point.Y();
  }
  return true;
}

rust::Vec<FaceSide> Model::solid_sides(std::uint32_t solid) const
{
  rust::Vec<FaceSide> found;
  for (TopExp_Explorer it(solids(static_cast<int>(solid) + 1), TopAbs_FACE); it.More(); it.Next()) {
    found.push_back({static_cast<std::uint32_t>(faces.FindIndex(it.Current()) - 1),
                     static_cast<std::uint32_t>(it.Current().Orientation())});
  }
  return found;
}

double Model::solid_volume(std::uint32_t solid) const
{
  GProp_GProps properties;
  BRepGProp::VolumeProperties(solids(static_cast<int>(solid) + 1), properties);
  return properties.Mass();
}

} // namespace geo_adapt
