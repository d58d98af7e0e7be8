// Solids that touch in an edge or a vertex without a face between them there: each gets an edge or a vertex of its own.
//
// A mesh that hung together in a curve or a point alone would have edges with four triangles of its surface, which no operation on
// meshes can keep.
#include "geo-adapt/cpp/names.hpp"

#include <BRep_Builder.hxx>
#include <NCollection_DataMap.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Iterator.hxx>

#include <map>
#include <vector>

namespace geo_adapt {
namespace {

/// A shape of other parts: those of the old one in their order, by `image`.
template <typename Image> TopoDS_Shape rebuilt(const TopoDS_Shape& shape, Image&& image)
{
  TopoDS_Shape copy = shape.EmptyCopied();
  const BRep_Builder builder;
  for (TopoDS_Iterator it(shape); it.More(); it.Next()) {
    builder.Add(copy, image(it.Value()).Oriented(it.Value().Orientation()));
  }
  copy.Closed(shape.Closed());
  return copy;
}

/// The parts that the faces at an edge or a vertex fall into: faces of one solid belong together, and so those of two solids with one of
/// these faces in common.
class Fans
{
public:
  Fans(const TopTools_IndexedDataMapOfShapeListOfShape& solids_of, const TopTools_ListOfShape& faces)
  {
    TopTools_IndexedMapOfShape solids;
    for (const TopoDS_Shape& face : faces) {
      int first = 0;
      for (const TopoDS_Shape& solid : solids_of.FindFromKey(face)) {
        const int i = solids.Add(solid);
        if (i == static_cast<int>(parents.size())) {
          parents.push_back(i);
        }
        first = first == 0 ? root(i) : first;
        parents[static_cast<std::size_t>(root(i))] = root(first);
      }
      of_face.Bind(face, first);
    }
  }

  /// The part that a face belongs to; the first one for faces of no solid.
  int of(const TopoDS_Shape& face) const
  {
    const int solid = of_face.Find(face);
    return solid == 0 ? first() : root(solid);
  }

  /// The part that keeps what it has.
  int first() const { return root(1); }

  /// Whether there are several.
  bool is_split() const
  {
    for (int i = 1; i < static_cast<int>(parents.size()); ++i) {
      if (root(i) != root(1)) {
        return true;
      }
    }
    return false;
  }

private:
  int root(int i) const
  {
    while (i < static_cast<int>(parents.size()) && parents[static_cast<std::size_t>(i)] != i) {
      i = parents[static_cast<std::size_t>(i)];
    }
    return i;
  }

  std::vector<int> parents = {0};
  NCollection_DataMap<TopoDS_Shape, int, TopTools_ShapeMapHasher> of_face;
};

/// All that changes.
class Separation
{
public:
  Separation(const TopoDS_Shape& shape, Labels& given) : labels(given)
  {
    TopTools_IndexedDataMapOfShapeListOfShape solids_of;
    TopExp::MapShapesAndUniqueAncestors(shape, TopAbs_FACE, TopAbs_SOLID, solids_of);
    for (const TopAbs_ShapeEnum type : {TopAbs_EDGE, TopAbs_VERTEX}) {
      TopTools_IndexedDataMapOfShapeListOfShape faces_of;
      TopExp::MapShapesAndUniqueAncestors(shape, type, TopAbs_FACE, faces_of);
      for (int i = 1; i <= faces_of.Extent(); ++i) {
        Fans at(solids_of, faces_of(i));
        if (at.is_split()) {
          fans.Bind(faces_of.FindKey(i), at);
        }
      }
    }
  }

  bool is_needed() const { return !fans.IsEmpty(); }

  /// What a compound, a solid, a shell or a face becomes: itself, where it has nothing that is split.
  TopoDS_Shape image(const TopoDS_Shape& shape)
  {
    if (const TopoDS_Shape* known = images.Seek(shape); known != nullptr) {
      return *known;
    }
    TopTools_IndexedMapOfShape parts;
    TopExp::MapShapes(shape, TopAbs_EDGE, parts);
    TopExp::MapShapes(shape, TopAbs_VERTEX, parts);
    bool is_touched = false;
    for (int i = 1; i <= parts.Extent() && !is_touched; ++i) {
      is_touched = fans.IsBound(parts(i));
    }
    TopoDS_Shape found = shape;
    if (is_touched) {
      const bool is_face = shape.ShapeType() == TopAbs_FACE;
      found = rebuilt(shape, [&](const TopoDS_Shape& part) { return is_face ? wire(part, shape) : image(part); });
      hand_on(labels, shape, found);
    }
    images.Bind(shape, found);
    return found;
  }

private:
  TopoDS_Shape wire(const TopoDS_Shape& old, const TopoDS_Shape& face)
  {
    if (old.ShapeType() != TopAbs_WIRE) {
      return part_of(old, face); // a vertex inside a face
    }
    return rebuilt(old, [&](const TopoDS_Shape& edge) { return part_of(edge, face); });
  }

  /// The edge or the vertex of a face: another one in each part of the faces there but the first. An edge with another vertex is another.
  TopoDS_Shape part_of(const TopoDS_Shape& old, const TopoDS_Shape& face)
  {
    Fans* at = fans.ChangeSeek(old);
    bool is_other = at != nullptr && at->of(face) != at->first();
    for (TopoDS_Iterator it(old); it.More(); it.Next()) {
      is_other = is_other || !part_of(it.Value(), face).IsSame(it.Value());
    }
    if (!is_other) {
      return old;
    }
    std::map<int, TopoDS_Shape>* copies = others.ChangeSeek(old);
    if (copies == nullptr) {
      copies = others.Bound(old, std::map<int, TopoDS_Shape>());
    }
    TopoDS_Shape& copy = (*copies)[at == nullptr ? 0 : at->of(face)];
    if (copy.IsNull()) {
      const TopoDS_Shape forward = old.Oriented(TopAbs_FORWARD);
      copy = rebuilt(forward, [&](const TopoDS_Shape& vertex) { return part_of(vertex, face); });
      hand_on(labels, old, copy);
    }
    return copy;
  }

  Labels& labels;
  NCollection_DataMap<TopoDS_Shape, Fans, TopTools_ShapeMapHasher> fans;
  NCollection_DataMap<TopoDS_Shape, TopoDS_Shape, TopTools_ShapeMapHasher> images;
  NCollection_DataMap<TopoDS_Shape, std::map<int, TopoDS_Shape>, TopTools_ShapeMapHasher> others;
};

} // namespace

TopoDS_Shape separated(const TopoDS_Shape& shape, Labels& labels)
{
  Separation separation(shape, labels);
  return separation.is_needed() ? separation.image(shape) : shape;
}

} // namespace geo_adapt
