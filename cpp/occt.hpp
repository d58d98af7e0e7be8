// The C++ side of the OpenCASCADE bridge: a loaded model, and the evaluators that the threads take of it.
// It only loads, lists and evaluates. Projections, caches and decisions are in src/geometry/occt/.
#pragma once

#include "geo-adapt/cpp/gaps.hpp"
#include "geo-adapt/cpp/names.hpp"
#include "rust/cxx.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <Geom2d_Curve.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Shape.hxx>

#include <array>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <unordered_map>
#include <vector>

namespace geo_adapt {
/// OpenCASCADE was refused memory, which it does not ask C++ for: ends the program where there is none left.
void memory_ended();
} // namespace geo_adapt

// cxx catches std::exception only; in OCCT 7.6 Standard_Failure is none, and would end the process.
namespace rust::behavior {
template <typename Try, typename Fail>
static void trycatch(Try&& attempt, Fail&& fail) noexcept
{
  // Where memory has ended the program's handler does not come back (memory.cpp); else one request was beyond all bounds.
  const char* beyond = "it asks for more memory than there is: it is damaged, or too large for this machine";
  try {
    attempt();
  } catch (const Standard_OutOfMemory&) {
    geo_adapt::memory_ended();
    fail(beyond);
  } catch (const std::bad_alloc&) {
    fail(beyond);
  } catch (const Standard_Failure& failure) {
    const char* text = failure.GetMessageString();
    fail(text != nullptr && *text != '\0' ? text : failure.DynamicType()->Name());
  } catch (const std::exception& failure) {
    fail(failure.what());
  } catch (...) {
    fail("an unknown C++ exception");
  }
}
} // namespace rust::behavior

namespace geo_adapt {

struct FaceRecord;
struct EdgeRecord;
struct VertexRecord;
struct Form;
struct LabelRecord;
struct NamedRecord;
struct DomainRecord;
struct FlawRecord;
struct HealRecord;
struct DoubleWallRecord;
struct GapRecord;
struct EdgeUse;
struct FaceSide;

/// A shape with its faces, edges and vertices numbered from 0 in the order of TopExp::MapShapes.
/// Never changed after loading, so that threads may read it together.
class Model
{
public:
  using Box = std::array<double, 6>;

  /// `boxes` are those of the faces and of all, where they are known: OpenCASCADE takes long to find them.
  explicit Model(const TopoDS_Shape& shape, const Labels& labels = Labels(), const TopoDS_Shape& joined = TopoDS_Shape(),
                 std::vector<Box> boxes = {}, std::vector<DoubleWall> walls = {}, std::vector<Gap> gaps = {});

  std::uint32_t face_count() const { return static_cast<std::uint32_t>(faces.Extent()); }
  std::uint32_t edge_count() const { return static_cast<std::uint32_t>(edges.Extent()); }
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(vertices.Extent()); }
  std::uint32_t solid_count() const;

  FaceRecord face_record(std::uint32_t face) const;
  EdgeRecord edge_record(std::uint32_t edge) const;
  VertexRecord vertex_record(std::uint32_t vertex) const;
  Box bounds() const;
  double face_area(std::uint32_t face) const;
  std::array<double, 3> face_centre(std::uint32_t face) const;
  double edge_length(std::uint32_t edge) const;
  void write_brep(rust::Str path) const;
  /// Solids that were divided when the file was read, since faces of theirs lay on each other.
  rust::Vec<DoubleWallRecord> double_walls() const;
  /// Edges that were moved onto their faces when the file was read.
  rust::Vec<GapRecord> gaps_closed() const;
  /// What OpenCASCADE's own check finds wrong with faces.
  rust::Vec<FlawRecord> flaws() const;
  /// Writes all that it is made of in binary form, for `load_saved` of this same program.
  void save(rust::Str path) const;
  /// The edges of a face in the order of its wires, as the face with its orientation FORWARD has them.
  rust::Vec<EdgeUse> edge_uses(std::uint32_t face) const;
  /// Vertices that lie in a face and on none of its edges.
  rust::Vec<std::uint32_t> loose_vertices(std::uint32_t face) const;
  /// Parameters on a face of points of its edge; of a seam's second curve where the use is reversed. False without such a curve.
  bool edge_parameters(std::uint32_t edge, std::uint32_t face, bool reversed, rust::Slice<const double> t,
                       rust::Slice<double> uv) const;
  /// The faces that bound a solid, each with the side that the solid is on.
  rust::Vec<FaceSide> solid_sides(std::uint32_t solid) const;
  double solid_volume(std::uint32_t solid) const;
  /// Of an edge (dimension 1), face (2) or solid (3).
  LabelRecord label(std::uint32_t dimension, std::uint32_t index) const;
  /// The same shape with these labels in place of its own.
  std::shared_ptr<Model> relabelled(rust::Slice<const NamedRecord> named) const;
  /// The far field without this body.
  std::shared_ptr<Model> domain(const DomainRecord& domain) const;
  /// The model without edges and faces that are narrower than a length, sewn where it is no solid and gaps are narrower; what was done is told.
  std::shared_ptr<Model> healed(double length, rust::Vec<HealRecord>& done) const;

  /// The model multiplied by a factor about the origin, then moved; its entities keep their numbers, and have no labels.
  std::shared_ptr<Model> placed(double factor, const std::array<double, 3>& by) const;

  TopoDS_Face face(std::uint32_t index) const; // FORWARD, as its p-curves want it
  TopoDS_Edge edge(std::uint32_t index) const; // FORWARD

private:
  TopoDS_Shape shape;
  /// The same, with edges and vertices in common where solids touch in these alone: what a mesher is to mesh. Its faces have the same
  /// numbers.
  TopoDS_Shape joined;
  TopTools_IndexedMapOfShape solids, faces, edges, vertices;
  Labels labels;
  std::vector<DoubleWall> walls;
  std::vector<Gap> gaps;
  /// Of each face, then of all; found when the records are first read, before threads share the model.
  mutable std::vector<std::optional<Box>> boxes;

  const Box& bounds_of(std::uint32_t face) const;
};

/// Evaluates the shape of one model for one thread: adaptors and classifiers carry caches, so none is ever shared.
class Evaluator
{
public:
  explicit Evaluator(std::shared_ptr<Model> model);

  Form surface_form(std::uint32_t face);
  Form curve_form(std::uint32_t edge);
  void surface_d0(std::uint32_t face, double u, double v, std::array<double, 3>& out);
  void surface_d2(std::uint32_t face, double u, double v, std::array<double, 18>& out);
  void curve_d2(std::uint32_t edge, double t, std::array<double, 9>& out);
  bool pcurve_d0(std::uint32_t edge, std::uint32_t face, double t, std::array<double, 2>& out);
  bool inside(std::uint32_t face, double u, double v);
  double reference_distance(bool is_face, std::uint32_t index, const std::array<double, 3>& point) const;

private:
  BRepAdaptor_Surface& surface(std::uint32_t face);
  BRepAdaptor_Curve& curve(std::uint32_t edge);

  std::shared_ptr<const Model> model;
  std::vector<std::unique_ptr<BRepAdaptor_Surface>> surfaces;
  std::vector<std::unique_ptr<BRepAdaptor_Curve>> curves;
  std::vector<std::unique_ptr<BRepTopAdaptor_FClass2d>> classifiers;
  std::unordered_map<std::uint64_t, Handle(Geom2d_Curve)> pcurves;
};

/// Reads a file: format 0 is STEP, 1 IGES, 2 BREP. Not to be called by two threads at once.
std::shared_ptr<Model> load_model(rust::Str path, std::uint32_t format);
/// What `Model::save` has written. Not to be called by two threads at once.
std::shared_ptr<Model> load_saved(rust::Str path);
std::unique_ptr<Evaluator> new_evaluator(const std::shared_ptr<Model>& model);

} // namespace geo_adapt
