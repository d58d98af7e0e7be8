// Names and colours of a STEP file: of representation items (faces, edges, solids), and of products for the solids in them.
#include "geo-adapt/cpp/names.hpp"
#include "geo-adapt/cpp/occt.hpp"
#include "geo-adapt/src/geometry/occt/bridge.rs.h"

#include <Quantity_Color.hxx>
#include <STEPConstruct_Styles.hxx>
#include <STEPControl_Reader.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepVisual_Colour.hxx>
#include <StepVisual_StyledItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <algorithm>
#include <vector>

namespace geo_adapt {
namespace {

/// A name that says something: programs write NONE, and OCCT its own name, where there is none.
std::string meaning(const Handle(TCollection_HAsciiString)& text)
{
  if (text.IsNull()) {
    return {};
  }
  const std::string name = text->ToCString();
  const auto first = name.find_first_not_of(" \t");
  if (first == std::string::npos || name == "NONE" || name.rfind("Open CASCADE", 0) == 0) {
    return {};
  }
  return name.substr(first, name.find_last_not_of(" \t") - first + 1);
}

bool is_named(TopAbs_ShapeEnum type)
{
  return type == TopAbs_FACE || type == TopAbs_EDGE || type == TopAbs_SOLID;
}

Label& label_of(Labels& labels, const TopoDS_Shape& shape)
{
  const TopoDS_Shape key = unplaced(shape);
  if (!labels.IsBound(key)) {
    labels.Bind(key, Label());
  }
  return labels.ChangeFind(key);
}

/// A product and the solids in it.
struct Product
{
  std::string name;
  TopTools_IndexedMapOfShape solids;
};

/// Names that solids have from their products, the innermost first.
void name_by_products(Labels& labels, std::vector<Product>& products)
{
  std::stable_sort(products.begin(), products.end(),
                   [](const Product& a, const Product& b) { return a.solids.Extent() < b.solids.Extent(); });
  for (const Product& product : products) {
    for (int i = 1; i <= product.solids.Extent(); ++i) {
      Label& label = label_of(labels, product.solids(i));
      if (label.name.empty()) {
        label.name = product.name;
      }
    }
  }
}

void add_colours(Labels& labels, const Handle(XSControl_WorkSession)& session,
                 const Handle(Transfer_TransientProcess)& process)
{
  STEPConstruct_Styles styles(session);
  if (!styles.LoadStyles()) {
    return;
  }
  for (int i = 1; i <= styles.NbStyles(); ++i) {
    const Handle(StepVisual_StyledItem) style = styles.Style(i);
    if (style.IsNull() || style->Item().IsNull()) {
      continue;
    }
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, style->Item());
    if (shape.IsNull() || !is_named(shape.ShapeType())) {
      continue;
    }
    Handle(StepVisual_Colour) surface, boundary, curve, render;
    double transparency = 0.0;
    bool is_component = false;
    if (!styles.GetColors(style, surface, boundary, curve, render, transparency, is_component)) {
      continue;
    }
    const Handle(StepVisual_Colour) colour = shape.ShapeType() == TopAbs_EDGE ? curve : surface.IsNull() ? render : surface;
    Quantity_Color decoded;
    if (!colour.IsNull() && STEPConstruct_Styles::DecodeColor(colour, decoded)) {
      label_of(labels, shape).colour = Quantity_Color::ColorToHex(decoded).ToCString();
    }
  }
}

} // namespace

void hand_on(Labels& labels, const TopoDS_Shape& from, const TopoDS_Shape& to)
{
  const TopoDS_Shape key = unplaced(to);
  if (const Label* label = labels.Seek(unplaced(from)); label != nullptr && !labels.IsBound(key)) {
    const Label copy = *label;
    labels.Bind(key, copy);
  }
}

Labels step_labels(const STEPControl_Reader& reader)
{
  Labels labels;
  const Handle(XSControl_WorkSession) session = reader.WS();
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  if (process.IsNull()) {
    return labels;
  }
  std::vector<Product> products;
  for (int i = 1; i <= process->NbMapped(); ++i) {
    const Handle(Standard_Transient) entity = process->Mapped(i);
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(entity);
    const auto definition = Handle(StepBasic_ProductDefinition)::DownCast(entity);
    if (item.IsNull() && definition.IsNull()) {
      continue;
    }
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
    if (shape.IsNull()) {
      continue;
    }
    if (!item.IsNull()) {
      const std::string name = meaning(item->Name());
      if (is_named(shape.ShapeType()) && !name.empty()) {
        label_of(labels, shape).name = name;
      }
    } else if (!definition->Formation().IsNull() && !definition->Formation()->OfProduct().IsNull()) {
      Product product{meaning(definition->Formation()->OfProduct()->Name()), {}};
      TopExp::MapShapes(shape, TopAbs_SOLID, product.solids);
      if (!product.name.empty()) {
        products.push_back(product);
      }
    }
  }
  name_by_products(labels, products);
  add_colours(labels, session, process);
  return labels;
}

LabelRecord Model::label(std::uint32_t dimension, std::uint32_t index) const
{
  const TopTools_IndexedMapOfShape& shapes = dimension == 1 ? edges : dimension == 2 ? faces : solids;
  const Label* label = labels.Seek(unplaced(shapes(static_cast<int>(index) + 1)));
  return label == nullptr ? LabelRecord{} : LabelRecord{rust::String::lossy(label->name), rust::String::lossy(label->colour)};
}

std::shared_ptr<Model> Model::relabelled(rust::Slice<const NamedRecord> named) const
{
  auto copy = std::make_shared<Model>(*this);
  for (const NamedRecord& one : named) {
    const TopTools_IndexedMapOfShape& shapes = one.dimension == 1 ? edges : one.dimension == 2 ? faces : solids;
    label_of(copy->labels, shapes(static_cast<int>(one.index) + 1)) = Label{std::string(one.name), std::string(one.colour)};
  }
  return copy;
}

} // namespace geo_adapt
