// Copies of splines and conics, from which src/geometry/occt/ evaluates without OpenCASCADE.
#pragma once

#include "geo-adapt/cpp/occt.hpp"

namespace geo_adapt {

struct Spline;

/// The surface of a face: a B-spline, or a swept surface's axis; kind 0 for any other.
Spline surface_spline(const Model& model, std::uint32_t face);
/// The curve that a swept surface is swept from.
Spline surface_generatrix(const Model& model, std::uint32_t face);
/// The curve of an edge; kind 0 where there is no copy of it.
Spline curve_spline(const Model& model, std::uint32_t edge);
/// The curve of an edge in the parameters of a face (z = 0); on a seam the first or, `reversed`, the second one.
Spline pcurve_spline(const Model& model, std::uint32_t edge, std::uint32_t face, bool reversed);
/// Triangles of all faces, nine coordinates each, by BRepMesh on a copy, no chord being farther off than `deflection`:
/// for the tests.
rust::Vec<double> tessellation(const Model& model, double deflection);

} // namespace geo_adapt
