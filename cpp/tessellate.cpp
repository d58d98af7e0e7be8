// OpenCASCADE's own triangles of a model's surface, joined along its edges: what a mesher of volumes can begin with where meshers of
// surfaces fail.
#include "geo-adapt/cpp/occt.hpp"

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

namespace geo_adapt {
namespace {

/// Nodes and triangles of the faces, a node of an edge or a vertex once.
class Surface
{
public:
  explicit Surface(const TopoDS_Shape& shape)
  {
    TopExp::MapShapes(shape, TopAbs_EDGE, edges);
    TopExp::MapShapes(shape, TopAbs_VERTEX, vertices);
    on_edge.resize(static_cast<std::size_t>(edges.Extent()));
    on_vertex.assign(static_cast<std::size_t>(vertices.Extent()), 0);
  }

  void add(const TopoDS_Face& face, int number)
  {
    TopLoc_Location place;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
    if (mesh.IsNull()) {
      throw std::runtime_error("OpenCASCADE has no triangles for face " + std::to_string(number));
    }
    std::vector<int> id(static_cast<std::size_t>(mesh->NbNodes()) + 1, 0);
    const auto point = [&](int node) { return mesh->Node(node).Transformed(place.Transformation()); };
    for (TopExp_Explorer it(face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(it.Current());
      const Handle(Poly_PolygonOnTriangulation) line = BRep_Tool::PolygonOnTriangulation(edge, mesh, place);
      if (line.IsNull()) {
        throw std::runtime_error("OpenCASCADE has no nodes on an edge of face " + std::to_string(number));
      }
      add_line(edge, *line, point, id);
    }
    for (int node = 1; node <= mesh->NbNodes(); ++node) {
      if (id[static_cast<std::size_t>(node)] == 0) {
        id[static_cast<std::size_t>(node)] = add_point(point(node));
      }
    }
    for (int triangle = 1; triangle <= mesh->NbTriangles(); ++triangle) {
      int a = 0, b = 0, c = 0;
      mesh->Triangle(triangle).Get(a, b, c);
      a = id[static_cast<std::size_t>(a)];
      b = id[static_cast<std::size_t>(b)];
      c = id[static_cast<std::size_t>(c)];
      // Those at a pole are flat.
      if (a != b && b != c && c != a) {
        triangles.push_back({number, a, b, c});
      }
    }
  }

  /// As MSH 2.2, where a triangle's elementary entity is its face.
  void write(const std::string& path) const
  {
    const std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(path.c_str(), "w"), std::fclose);
    if (!file) {
      throw std::runtime_error("the triangles cannot be written");
    }
    std::fprintf(file.get(), "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%zu\n", points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::fprintf(file.get(), "%zu %.17g %.17g %.17g\n", i + 1, points[i].X(), points[i].Y(), points[i].Z());
    }
    std::fprintf(file.get(), "$EndNodes\n$Elements\n%zu\n", triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const auto& [face, a, b, c] = triangles[i];
      std::fprintf(file.get(), "%zu 2 2 0 %d %d %d %d\n", i + 1, face, a, b, c);
    }
    std::fprintf(file.get(), "$EndElements\n");
    if (std::fflush(file.get()) != 0 || std::ferror(file.get()) != 0) {
      throw std::runtime_error("the triangles cannot be written; is the disk full?");
    }
  }

private:
  int add_point(const gp_Pnt& point)
  {
    points.push_back(point);
    return static_cast<int>(points.size());
  }

  template <typename Point>
  int at_vertex(const TopoDS_Vertex& vertex, const Point& point, int node)
  {
    int& id = on_vertex[static_cast<std::size_t>(vertices.FindIndex(vertex) - 1)];
    if (id == 0) {
      id = add_point(point(node));
    }
    return id;
  }

  template <typename Point>
  void add_line(const TopoDS_Edge& edge, const Poly_PolygonOnTriangulation& line, const Point& point, std::vector<int>& id)
  {
    TopoDS_Vertex first, last;
    TopExp::Vertices(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)), first, last);
    const int count = line.NbNodes();
    std::vector<int>& known = on_edge[static_cast<std::size_t>(edges.FindIndex(edge) - 1)];
    if (known.empty()) {
      known.assign(static_cast<std::size_t>(count), 0);
    }
    if (known.size() != static_cast<std::size_t>(count)) {
      throw std::runtime_error("OpenCASCADE divides an edge in two ways");
    }
    for (int i = 1; i <= count; ++i) {
      const int node = line.Node(i);
      int& at = known[static_cast<std::size_t>(i - 1)];
      if (BRep_Tool::Degenerated(edge) || i == 1) {
        at = at_vertex(first, point, node);
      } else if (i == count) {
        at = at_vertex(last, point, node);
      } else if (at == 0) {
        at = add_point(point(node));
      }
      id[static_cast<std::size_t>(node)] = at;
    }
  }

  TopTools_IndexedMapOfShape edges, vertices;
  std::vector<std::vector<int>> on_edge;
  std::vector<int> on_vertex;
  std::vector<gp_Pnt> points;
  std::vector<std::array<int, 4>> triangles;
};

} // namespace

void Model::write_tessellation(rust::Str path, double deflection, double angle) const
{
  // Triangles stay with a shape: this one is not to change.
  BRepBuilderAPI_Copy copy(joined, Standard_False, Standard_False);
  const TopoDS_Shape own = copy.Shape();
  BRepMesh_IncrementalMesh(own, deflection, Standard_False, angle, Standard_False);
  TopTools_IndexedMapOfShape own_faces;
  TopExp::MapShapes(own, TopAbs_FACE, own_faces);
  if (own_faces.Extent() != faces.Extent()) {
    throw std::runtime_error("OpenCASCADE's copy has other faces");
  }
  Surface surface(own);
  for (int i = 1; i <= own_faces.Extent(); ++i) {
    surface.add(TopoDS::Face(own_faces(i)), i);
  }
  surface.write(std::string(path));
}

rust::Vec<std::uint32_t> Model::solid_faces(std::uint32_t solid) const
{
  TopTools_IndexedMapOfShape own;
  TopExp::MapShapes(solids(static_cast<int>(solid) + 1), TopAbs_FACE, own);
  rust::Vec<std::uint32_t> found;
  for (int i = 1; i <= own.Extent(); ++i) {
    found.push_back(static_cast<std::uint32_t>(faces.FindIndex(own(i)) - 1));
  }
  return found;
}

} // namespace geo_adapt
