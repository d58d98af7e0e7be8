// Writing of a model for other programs.
#include "geo-adapt/cpp/occt.hpp"

#include <BRepTools.hxx>

#include <stdexcept>
#include <string>

namespace geo_adapt {

void Model::write_brep(rust::Str path) const
{
  if (!BRepTools::Write(joined, std::string(path).c_str())) {
    throw std::runtime_error("OpenCASCADE cannot write the model there; is the disk full?");
  }
}

} // namespace geo_adapt
