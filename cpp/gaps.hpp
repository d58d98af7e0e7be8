// Edges whose curves in space lie off the surfaces of their faces.
#pragma once

#include <TopoDS_Shape.hxx>

#include <array>
#include <cstdint>
#include <vector>

namespace geo_adapt {

/// An edge that was moved.
struct Gap
{
  std::uint64_t edge;   // its number in the shape, from 0
  double before, after; // greatest distance from its surfaces, model units
};

/// Moves edges between two faces that are off the surfaces of these onto both, with their vertices and the edges at these; in place.
std::vector<Gap> without_gaps(const TopoDS_Shape& shape);

} // namespace geo_adapt
