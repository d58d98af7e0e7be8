// Damage in files that OCCT's readers would follow into null handles, endless loops or endless recursion.
// Each function throws std::runtime_error with what is wrong and the remedy.
#pragma once

#include <IGESControl_Reader.hxx>
#include <STEPControl_Reader.hxx>

namespace geo_adapt {

/// STEP: geometry or topology that could not be read, or that refers to nothing.
void refuse_fails(const STEPControl_Reader& reader);

/// IGES: geometry that refers to itself.
void refuse_cycles(const IGESControl_Reader& reader);

/// BREP: makes the reader throw where the type of a curve or a surface is unknown.
void refuse_unknown_types();

} // namespace geo_adapt
