// Names and colours of faces, edges and solids, as CAD programs write them.
#pragma once

#include <NCollection_DataMap.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Shape.hxx>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class STEPControl_Reader;

namespace geo_adapt {

/// What the file says of a shape; empty where it says nothing.
struct Label
{
  std::string name;
  std::string colour; // "#RRGGBB", sRGB
};

/// Labels of shapes without their location: the instances of a part have its names.
using Labels = NCollection_DataMap<TopoDS_Shape, Label, TopTools_ShapeMapHasher>;

/// A shape as the labels know it.
inline TopoDS_Shape unplaced(const TopoDS_Shape& shape)
{
  return shape.Located(TopLoc_Location());
}

/// Gives `to` the label of `from`, if that has one and `to` has none.
void hand_on(Labels& labels, const TopoDS_Shape& from, const TopoDS_Shape& to);

/// The labels of a STEP file whose shapes were transferred.
Labels step_labels(const STEPControl_Reader& reader);

/// The closed shells of a shape as solids, beside all else of it; null where there is none.
TopoDS_Shape filled(const TopoDS_Shape& shape);

/// The faces of a shape sewn where they are nearer than the tolerance, and what closes made solid; the shape itself where nothing closes, unless
/// it `stays` sewn. Labels are handed on.
TopoDS_Shape sewn(const TopoDS_Shape& shape, Labels& labels, double tolerance, bool stays);

/// A shape without its parts that have no faces: solids that some programs write, sketches of curves and points. They bound nothing, and
/// meshers number them, refuse them, or make points of them in the midst of a face. Null where nothing is left.
TopoDS_Shape with_faces(const TopoDS_Shape& shape);

/// What is nearer than this touches; of the diagonal.
constexpr double TOUCHING = 1e-7;

/// A solid with faces that lie on each other.
struct DoubleWall
{
  std::array<double, 3> at; // a point of them
  std::uint64_t solids;     // so many were made of it
};

/// Where faces of a solid lie on each other, the solids that its faces enclose, which have one face in common there. Labels are handed on, and
/// what was done is added to `walls`.
TopoDS_Shape divided(const TopoDS_Shape& shape, Labels& labels, std::vector<DoubleWall>& walls);

/// A file of several solids that touch in faces: these, their edges and vertices are made one, and there once. Solids that touch in edges
/// or points alone stay as they are. Labels are handed on.
TopoDS_Shape connected(const TopoDS_Shape& shape, Labels& labels);

/// Where solids touch in an edge or a vertex alone, each of them has one of its own. Labels are handed on.
TopoDS_Shape separated(const TopoDS_Shape& shape, Labels& labels);

} // namespace geo_adapt
