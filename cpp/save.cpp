// A loaded model in binary form, which one process hands to another.
//
// Reading a STEP file and joining its solids takes seconds; what came of it is read in a tenth of that.
#include "geo-adapt/cpp/occt.hpp"

#include <BRep_Builder.hxx>
#include <BinTools.hxx>
#include <TopExp.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

namespace geo_adapt {
namespace {

constexpr TopAbs_ShapeEnum LABELLED[] = {TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID};

void put(std::ostream& out, const std::string& text)
{
  out << text.size() << ' ' << text << ' ';
}

std::string text(std::istream& in)
{
  std::size_t size = 0;
  in >> size;
  in.get();
  std::string found(size, ' ');
  in.read(found.data(), static_cast<std::streamsize>(size));
  return found;
}

} // namespace

void Model::save(rust::Str path) const
{
  std::ofstream out(std::string(path), std::ios::binary);
  for (const TopAbs_ShapeEnum type : LABELLED) {
    TopTools_IndexedMapOfShape all;
    TopExp::MapShapes(shape, type, all);
    for (int i = 1; i <= all.Extent(); ++i) {
      if (const Label* label = labels.Seek(unplaced(all(i))); label != nullptr) {
        out << static_cast<int>(type) << ' ' << i << ' ';
        put(out, label->name);
        put(out, label->colour);
      }
    }
  }
  std::vector<Box> known;
  for (const auto& one : boxes) {
    if (one) {
      known.push_back(*one);
    }
  }
  out << "-1 " << known.size() << '\n';
  out.write(reinterpret_cast<const char*>(known.data()), static_cast<std::streamsize>(known.size() * sizeof(Box)));
  const std::size_t count = walls.size();
  out.write(reinterpret_cast<const char*>(&count), sizeof count);
  out.write(reinterpret_cast<const char*>(walls.data()), static_cast<std::streamsize>(count * sizeof(DoubleWall)));
  const std::size_t moved = gaps.size();
  out.write(reinterpret_cast<const char*>(&moved), sizeof moved);
  out.write(reinterpret_cast<const char*>(gaps.data()), static_cast<std::streamsize>(moved * sizeof(Gap)));
  TopoDS_Compound both;
  const BRep_Builder builder;
  builder.MakeCompound(both);
  builder.Add(both, shape);
  builder.Add(both, joined);
  BinTools::Write(both, out, Standard_False, Standard_False, BinTools_FormatVersion_CURRENT);
  out.close();
  if (!out) {
    throw std::runtime_error("OpenCASCADE cannot write the model there; is the disk full?");
  }
}

std::shared_ptr<Model> load_saved(rust::Str path)
{
  std::ifstream in(std::string(path), std::ios::binary);
  struct Named
  {
    int index;
    Label label;
  };
  std::vector<Named> named[std::size(LABELLED)];
  for (int type = -1; in >> type && type >= 0;) {
    Named one{};
    in >> one.index;
    one.label.name = text(in);
    one.label.colour = text(in);
    for (std::size_t k = 0; k < std::size(LABELLED); ++k) {
      if (static_cast<int>(LABELLED[k]) == type) {
        named[k].push_back(one);
      }
    }
  }
  std::size_t count = 0;
  in >> count;
  in.get();
  if (!in) {
    throw std::runtime_error("the saved model cannot be read");
  }
  std::vector<Model::Box> boxes(count);
  in.read(reinterpret_cast<char*>(boxes.data()), static_cast<std::streamsize>(boxes.size() * sizeof(Model::Box)));
  std::size_t divided = 0;
  in.read(reinterpret_cast<char*>(&divided), sizeof divided);
  if (!in) {
    throw std::runtime_error("the saved model cannot be read");
  }
  std::vector<DoubleWall> walls(divided);
  in.read(reinterpret_cast<char*>(walls.data()), static_cast<std::streamsize>(divided * sizeof(DoubleWall)));
  std::size_t moved = 0;
  in.read(reinterpret_cast<char*>(&moved), sizeof moved);
  if (!in) {
    throw std::runtime_error("the saved model cannot be read");
  }
  std::vector<Gap> gaps(moved);
  in.read(reinterpret_cast<char*>(gaps.data()), static_cast<std::streamsize>(moved * sizeof(Gap)));
  TopoDS_Shape both;
  BinTools::Read(both, in);
  if (!in || both.IsNull() || both.NbChildren() != 2) {
    throw std::runtime_error("the saved model cannot be read");
  }
  TopoDS_Iterator part(both);
  const TopoDS_Shape apart = part.Value();
  part.Next();
  Labels labels;
  for (std::size_t k = 0; k < std::size(LABELLED); ++k) {
    TopTools_IndexedMapOfShape all;
    TopExp::MapShapes(apart, LABELLED[k], all);
    for (const Named& one : named[k]) {
      if (one.index >= 1 && one.index <= all.Extent()) {
        labels.Bind(unplaced(all(one.index)), one.label);
      }
    }
  }
  return std::make_shared<Model>(apart, labels, part.Value(), std::move(boxes), std::move(walls), std::move(gaps));
}

} // namespace geo_adapt
