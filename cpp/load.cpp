// Reading of STEP, IGES and BREP files.
#include "geo-adapt/cpp/damage.hpp"
#include "geo-adapt/cpp/names.hpp"
#include "geo-adapt/cpp/occt.hpp"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepLib.hxx>
#include <BRepTools.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Surface.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Precision.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_GlobalFactors.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>

#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace geo_adapt {
namespace {

/// OCCT reports on its messenger and, in places, straight on std::cout: errors are ours to print.
class Silence
{
public:
  Silence() : out(std::cout.rdbuf(nullptr)), err(std::cerr.rdbuf(nullptr))
  {
    Message::DefaultMessenger()->ChangePrinters().Clear();
  }
  ~Silence()
  {
    std::cout.rdbuf(out);
    std::cerr.rdbuf(err);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

private:
  std::streambuf *out, *err;
};

/// The length unit of a STEP file in millimetres: that of its first context with units; 0 when it states none.
double step_unit(const Handle(StepData_StepModel)& model)
{
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    Handle(StepRepr_GlobalUnitAssignedContext) context;
    if (const auto full = Handle(StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx)::DownCast(entity);
        !full.IsNull()) {
      context = full->GlobalUnitAssignedContext();
    } else if (const auto part =
                 Handle(StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext)::DownCast(entity);
               !part.IsNull()) {
      context = part->GlobalUnitAssignedContext();
    }
    if (context.IsNull()) {
      continue;
    }
    STEPConstruct_UnitContext units;
    if (units.ComputeFactors(context) == 0 && units.LengthDone()) {
      return units.LengthFactor();
    }
  }
  return 0.0;
}

/// OCCT converts lengths to its own unit, by default the millimetre. With its unit set to the file's, the factor
/// is one: the coordinates come as the file states them.
TopoDS_Shape read_step(const std::string& path, Labels& labels)
{
  STEPControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) {
    throw std::runtime_error("OpenCASCADE cannot read it as STEP: it is damaged or cut off; export it again");
  }
  refuse_fails(reader);
  // OCCT's unit is a global that the last file has left behind, and the factors of step_unit are relative to it.
  StepData_GlobalFactors::Intance().SetCascadeUnit(1.0);
  const double unit = step_unit(reader.StepModel());
  if (unit > 0.0) {
    reader.SetSystemLengthUnit(unit);
  }
  if (reader.NbRootsForTransfer() == 0) {
    throw std::runtime_error("the STEP file holds no shape; export the solid as AP203, AP214 or AP242");
  }
  reader.TransferRoots();
  labels = step_labels(reader);
  return reader.OneShape();
}

/// IGES knows faces rather than solids, and STEP and BREP files may hold a surface model: closed shells are made solid; where there is
/// none the faces are sewn. What stays open is left as it is in STEP and BREP files, sewn in IGES files.
TopoDS_Shape closed(const TopoDS_Shape& shape, Labels& labels, bool is_iges)
{
  if (TopExp_Explorer(shape, TopAbs_SOLID).More()) {
    return shape;
  }
  if (const TopoDS_Shape solids = filled(shape); !solids.IsNull()) {
    return solids;
  }
  double tolerance = 1e-7;
  for (TopExp_Explorer it(shape, TopAbs_EDGE); it.More(); it.Next()) {
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Edge(it.Current())));
  }
  return sewn(shape, labels, 10.0 * tolerance, is_iges);
}

TopoDS_Shape read_iges(const std::string& path)
{
  IGESControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) {
    throw std::runtime_error("OpenCASCADE cannot read it as IGES: it is damaged or cut off; export it again");
  }
  refuse_cycles(reader);
  const Handle(IGESData_IGESModel) model = reader.IGESModel();
  IGESData_GlobalSection header = model->GlobalSection();
  if (header.UnitValue() > 0.0) {
    header.SetCascadeUnit(header.UnitValue());
    model->SetGlobalSection(header);
  }
  reader.TransferRoots();
  return reader.OneShape();
}

TopoDS_Shape read_brep(const std::string& path)
{
  refuse_unknown_types();
  std::stringstream stream;
  stream << std::ifstream(path, std::ios::binary).rdbuf() << '\n';
  // In a cut file OCCT looks for the next word for ever: let the stream throw at its end.
  stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  TopoDS_Shape shape;
  try {
    BRepTools::Read(shape, stream, BRep_Builder());
  } catch (const std::ios::failure&) {
    shape.Nullify();
  }
  if (shape.IsNull()) {
    throw std::runtime_error("OpenCASCADE cannot read it as BREP: it is damaged or cut off; write it again");
  }
  return shape;
}

/// Faces without wires, which are all of their surface, with the seams and poles that a whole surface has.
TopoDS_Shape bounded(const TopoDS_Shape& shape, Labels& labels)
{
  BRepTools_ReShape change;
  std::vector<std::pair<TopoDS_Shape, TopoDS_Shape>> changed;
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) {
    const TopoDS_Face face = TopoDS::Face(faces(i).Oriented(TopAbs_FORWARD));
    if (TopExp_Explorer(face, TopAbs_WIRE).More()) {
      continue;
    }
    TopLoc_Location at;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, at);
    if (surface.IsNull()) {
      continue;
    }
    std::array<double, 4> ends{};
    surface->Bounds(ends[0], ends[1], ends[2], ends[3]);
    if (std::any_of(ends.begin(), ends.end(), [](double end) { return Precision::IsInfinite(end); })) {
      continue;
    }
    BRepBuilderAPI_MakeFace whole(surface, Precision::Confusion());
    if (whole.IsDone()) {
      const TopoDS_Shape made = whole.Face().Located(at);
      change.Replace(face, made);
      changed.emplace_back(faces(i), made);
    }
  }
  if (changed.empty()) {
    return shape;
  }
  const TopoDS_Shape found = change.Apply(shape);
  for (const auto& [from, to] : changed) {
    hand_on(labels, from, to);
  }
  return found;
}

} // namespace

std::shared_ptr<Model> load_model(rust::Str name, std::uint32_t format)
{
  const Silence silence;
  const std::string path(name);
  TopoDS_Shape shape;
  Labels labels;
  try {
    shape = format == 0 ? read_step(path, labels) : format == 1 ? read_iges(path) : read_brep(path);
  } catch (const Standard_OutOfMemory&) {
    throw; // nothing is wrong with the file
  } catch (const Standard_Failure& failure) {
    const std::string reason = failure.GetMessageString();
    throw std::runtime_error("OpenCASCADE stopped reading it (" + reason +
                             "): the file is damaged; copy or export it again");
  }
  if (!shape.IsNull()) {
    shape = with_faces(shape);
  }
  if (shape.IsNull()) {
    throw std::runtime_error("the model has no faces; export the solid's surfaces, not only curves or a mesh");
  }
  shape = bounded(shape, labels);
  BRepLib::BuildCurves3d(shape);
  std::vector<DoubleWall> walls;
  const TopoDS_Shape solids = divided(connected(closed(shape, labels, format == 1), labels), labels, walls);
  const TopoDS_Shape apart = separated(solids, labels);
  const std::vector<Gap> gaps = without_gaps(apart);
  return std::make_shared<Model>(apart, labels, solids, std::vector<Model::Box>(), walls, gaps);
}

} // namespace geo_adapt
