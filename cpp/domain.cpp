// The domain of an external flow: a box or a sphere without the body.
#include "geo-adapt/cpp/names.hpp"
#include "geo-adapt/cpp/occt.hpp"
#include "geo-adapt/src/geometry/occt/bridge.rs.h"

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRep_Builder.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Pln.hxx>

#include <cmath>
#include <stdexcept>

namespace geo_adapt {
namespace {

TopoDS_Shape make_outer(const DomainRecord& domain)
{
  const gp_Pnt low(domain.low[0], domain.low[1], domain.low[2]), high(domain.high[0], domain.high[1], domain.high[2]);
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(low, high).Solid();
  if (domain.radius <= 0.0) {
    return box;
  }
  const gp_Pnt centre(domain.centre[0], domain.centre[1], domain.centre[2]);
  const TopoDS_Shape sphere = BRepPrimAPI_MakeSphere(centre, domain.radius).Solid();
  if (domain.axis < 0) {
    return sphere;
  }
  BRepAlgoAPI_Common half(sphere, box);
  if (!half.IsDone() || half.HasErrors()) {
    throw std::runtime_error("OpenCASCADE cannot cut the sphere at the plane of symmetry");
  }
  return half.Shape();
}

/// Whether a face of the outer shape lies in the plane of symmetry.
bool is_symmetry(const TopoDS_Face& face, const DomainRecord& domain)
{
  const BRepAdaptor_Surface surface(face);
  if (domain.axis < 0 || surface.GetType() != GeomAbs_Plane) {
    return false;
  }
  const gp_Pln plane = surface.Plane();
  const int axis = domain.axis + 1;
  const double size = std::abs(domain.high[0] - domain.low[0]) + std::abs(domain.at);
  return std::abs(plane.Axis().Direction().Coord(axis)) > 1.0 - 1e-9 &&
         std::abs(plane.Location().Coord(axis) - domain.at) <= 1e-9 * size;
}

/// What became of a face in an operation: itself where it was left as it is.
TopTools_ListOfShape images(BRepAlgoAPI_Cut& cut, const TopoDS_Shape& face)
{
  TopTools_ListOfShape found = cut.Modified(face);
  if (found.IsEmpty() && !cut.IsDeleted(face)) {
    found.Append(face);
  }
  return found;
}

} // namespace

std::shared_ptr<Model> Model::domain(const DomainRecord& domain) const
{
  const TopoDS_Shape outer = make_outer(domain);
  TopTools_ListOfShape arguments, tools;
  arguments.Append(outer);
  for (int i = 1; i <= solids.Extent(); ++i) {
    tools.Append(solids(i));
  }
  BRepAlgoAPI_Cut cut;
  cut.SetArguments(arguments);
  cut.SetTools(tools);
  cut.SetNonDestructive(Standard_True);
  cut.SetRunParallel(Standard_False);
  cut.Build();
  if (!cut.IsDone() || cut.HasErrors()) {
    throw std::runtime_error("OpenCASCADE cannot subtract the body from the far field; repair the body's solid in the CAD program");
  }
  Labels named;
  TopTools_MapOfShape outside;
  for (TopExp_Explorer it(outer, TopAbs_FACE); it.More(); it.Next()) {
    const Label label{is_symmetry(TopoDS::Face(it.Current()), domain) ? "symmetry" : "farfield", ""};
    for (const TopoDS_Shape& image : images(cut, it.Current())) {
      named.Bind(unplaced(image), label);
      outside.Add(image);
    }
  }
  for (int i = 1; i <= faces.Extent(); ++i) {
    const Label* known = labels.Seek(unplaced(faces(i)));
    Label label = known == nullptr ? Label() : *known;
    if (label.name.empty()) {
      label.name = "wall";
    }
    for (const TopoDS_Shape& image : images(cut, faces(i))) {
      if (!named.IsBound(unplaced(image))) {
        named.Bind(unplaced(image), label);
      }
    }
  }
  // Without the cavities of a hollow body: no far field reaches them.
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  int count = 0;
  for (TopExp_Explorer it(cut.Shape(), TopAbs_SOLID); it.More(); it.Next()) {
    bool reached = false;
    for (TopExp_Explorer face(it.Current(), TopAbs_FACE); face.More() && !reached; face.Next()) {
      reached = outside.Contains(face.Current());
    }
    if (reached) {
      named.Bind(unplaced(it.Current()), Label{"fluid", ""});
      builder.Add(all, it.Current());
      ++count;
    }
  }
  if (count == 0) {
    throw std::runtime_error("nothing is left of the far field without the body");
  }
  BRepLib::BuildCurves3d(all);
  return std::make_shared<Model>(all, named);
}

} // namespace geo_adapt
