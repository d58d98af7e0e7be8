#include "geo-adapt/cpp/damage.hpp"

#include <GeomTools.hxx>
#include <GeomTools_UndefinedTypeHandler.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepGeom_Direction.hxx>
#include <StepGeom_Point.hxx>
#include <StepShape_VertexPoint.hxx>
#include <TColStd_HArray1OfReal.hxx>

#include <array>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace geo_adapt {
namespace {

/// Whether a STEP entity is part of the shape. Fails elsewhere (annotations, say) do no harm.
bool is_shape(const Handle(Standard_Transient)& entity)
{
  static const std::array<std::string, 4> packages{"StepGeom_", "StepShape_", "StepRepr_Representation",
                                                   "StepRepr_Definitional"};
  const std::string type = entity->DynamicType()->Name();
  for (const std::string& package : packages) {
    if (type.rfind(package, 0) == 0) {
      return true;
    }
  }
  return entity->IsKind(STANDARD_TYPE(StepData_UndefinedEntity));
}

/// Entities that OCCT reads without a word, and then takes for whole: a direction or a point without numbers, a vertex
/// whose point is none in space.
bool is_hollow(const Handle(Standard_Transient)& entity)
{
  if (const auto direction = Handle(StepGeom_Direction)::DownCast(entity); !direction.IsNull()) {
    return direction->DirectionRatios().IsNull();
  }
  if (const auto point = Handle(StepGeom_CartesianPoint)::DownCast(entity); !point.IsNull()) {
    return point->NbCoordinates() < 2;
  }
  if (const auto vertex = Handle(StepShape_VertexPoint)::DownCast(entity); !vertex.IsNull()) {
    const auto point = Handle(StepGeom_CartesianPoint)::DownCast(vertex->VertexGeometry());
    return point.IsNull() || point->NbCoordinates() != 3;
  }
  return false;
}

/// Numbers of the geometric entities (types 100 to 199) that an entity refers to.
std::vector<int> geometry_below(const Interface_Graph& graph, int number)
{
  std::vector<int> below;
  Interface_EntityIterator shared = graph.Shareds(graph.Entity(number));
  for (shared.Start(); shared.More(); shared.Next()) {
    const auto entity = Handle(IGESData_IGESEntity)::DownCast(shared.Value());
    if (!entity.IsNull() && entity->TypeNumber() >= 100 && entity->TypeNumber() < 200) {
      below.push_back(graph.EntityNumber(entity));
    }
  }
  return below;
}

/// Throws where OCCT's own handler only prints a line and goes on with a null handle.
class RefuseUnknown : public GeomTools_UndefinedTypeHandler
{
public:
  Standard_IStream& ReadCurve(const int, Standard_IStream&, Handle(Geom_Curve)&) const override { refuse(); }
  Standard_IStream& ReadCurve2d(const int, Standard_IStream&, Handle(Geom2d_Curve)&) const override { refuse(); }
  Standard_IStream& ReadSurface(const int, Standard_IStream&, Handle(Geom_Surface)&) const override { refuse(); }

private:
  [[noreturn]] static void refuse()
  {
    throw std::runtime_error("it has a curve or surface of an unknown type: the file is damaged; write it again");
  }
};

} // namespace

void refuse_fails(const STEPControl_Reader& reader)
{
  const Handle(StepData_StepModel) model = reader.StepModel();
  // The reader's own findings: OCCT's further checks crash on what these would have told.
  for (int number = 1; number <= model->NbEntities(); ++number) {
    const Handle(Standard_Transient) entity = model->Value(number);
    if (!model->IsErrorEntity(number) && !is_hollow(entity)) {
      continue;
    }
    if (is_shape(entity)) {
      throw std::runtime_error("its entity #" + std::to_string(model->IdentLabel(entity)) +
                               " cannot be read: the file is damaged; copy or export it again");
    }
  }
}

void refuse_cycles(const IGESControl_Reader& reader)
{
  const Interface_Graph graph(reader.IGESModel(), Standard_False);
  enum class Mark { fresh, open, done };
  std::vector<Mark> marks(static_cast<std::size_t>(graph.Size()) + 1, Mark::fresh);
  for (int root = 1; root <= graph.Size(); ++root) {
    // Depth first, each entity on the path with those below it that are still to be visited.
    std::vector<std::pair<int, std::vector<int>>> path;
    const auto enter = [&](int number) {
      marks[static_cast<std::size_t>(number)] = Mark::open;
      path.emplace_back(number, geometry_below(graph, number));
    };
    if (marks[static_cast<std::size_t>(root)] == Mark::fresh) {
      enter(root);
    }
    while (!path.empty()) {
      auto& [number, below] = path.back();
      if (below.empty()) {
        marks[static_cast<std::size_t>(number)] = Mark::done;
        path.pop_back();
        continue;
      }
      const int next = below.back();
      below.pop_back();
      if (marks.at(static_cast<std::size_t>(next)) == Mark::open) {
        throw std::runtime_error("one of its entities refers to itself: the file is damaged; copy or export it again");
      }
      if (marks[static_cast<std::size_t>(next)] == Mark::fresh) {
        enter(next);
      }
    }
  }
}

void refuse_unknown_types()
{
  GeomTools::SetUndefinedTypeHandler(new RefuseUnknown);
}

} // namespace geo_adapt
