// Distances from points to the faces of a model, by other means than the program's: BRepMesh's triangles in CGAL's AABB
// trees. A program of its own that tests/cad/projections.rs builds and runs: CGAL's trees are GPL, and never linked with
// geo-adapt.
//   g++ -std=c++17 -O2 -isystem /usr/include/opencascade aabb.cpp -o aabb -lTKMesh -lTKSTEP -lTKXSBase -lTKTopAlgo
//     -lTKBRep -lTKGeomBase -lTKG3d -lTKG2d -lTKMath -lTKernel
//   aabb MODEL CHORD < points > distances
// MODEL is STEP or BREP, CHORD what a triangle may be off, as a share of its face's size. Points come as four numbers
// (doubles) each: a face from 0, x, y, z. Out go, as doubles, the number of faces, for each face the greatest error of
// its triangles that was measured, then a distance for each point.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <list>
#include <stdexcept>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::list<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

namespace {

TopoDS_Shape read(const std::string& path)
{
  TopoDS_Shape shape;
  if (path.size() > 5 && (path.substr(path.size() - 5) == ".step" || path.substr(path.size() - 4) == ".stp")) {
    STEPControl_Reader reader;
    if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) {
      throw std::runtime_error(path + " cannot be read");
    }
    reader.TransferRoots();
    shape = reader.OneShape();
  } else {
    std::ifstream stream(path);
    BRepTools::Read(shape, stream, BRep_Builder());
  }
  if (shape.IsNull()) {
    throw std::runtime_error(path + " has no shape");
  }
  return shape;
}

double distance_to_chord(const gp_Pnt& point, const gp_Pnt& a, const gp_Pnt& b)
{
  const gp_Vec along(a, b);
  const double square = along.SquareMagnitude();
  const double s = square > 0.0 ? std::clamp(gp_Vec(a, point).Dot(along) / square, 0.0, 1.0) : 0.0;
  return point.Distance(gp_Pnt(a.XYZ() + along.XYZ() * s));
}

/// How far the surface is off the triangles along its normal, at their middles and those of their sides: across it
/// parameters stray without any harm.
double chord_error(const TopoDS_Face& face, const Poly_Triangulation& mesh, const TopLoc_Location& location)
{
  const BRepAdaptor_Surface surface(face, Standard_False);
  double error = 0.0;
  for (int i = 1; i <= mesh.NbTriangles(); ++i) {
    int n[3];
    mesh.Triangle(i).Get(n[0], n[1], n[2]);
    gp_Pnt p[3];
    gp_Pnt2d q[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = mesh.Node(n[k]).Transformed(location);
      q[k] = mesh.UVNode(n[k]);
    }
    const double weights[4][3] = {{1 / 3., 1 / 3., 1 / 3.}, {.5, .5, 0}, {0, .5, .5}, {.5, 0, .5}};
    for (const auto& w : weights) {
      gp_XYZ flat(0, 0, 0);
      gp_XY uv(0, 0);
      for (int k = 0; k < 3; ++k) {
        flat += p[k].XYZ() * w[k];
        uv += q[k].XY() * w[k];
      }
      gp_Pnt point;
      gp_Vec du, dv;
      surface.D1(uv.X(), uv.Y(), point, du, dv);
      const gp_Vec off(gp_Pnt(flat), point), normal = du.Crossed(dv);
      const double length = normal.Magnitude();
      error = std::max(error, length > 0.0 ? std::abs(off.Dot(normal)) / length : off.Magnitude());
    }
  }
  return error;
}

/// How far an edge is off its chords on the face, at five places of each.
double border_error(const TopoDS_Edge& edge, const Handle(Poly_Triangulation)& mesh, const TopLoc_Location& location)
{
  const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
  if (polygon.IsNull() || polygon->Parameters().IsNull() || BRep_Tool::Degenerated(edge)) {
    return 0.0;
  }
  const BRepAdaptor_Curve curve(edge);
  double error = 0.0;
  for (int i = 1; i < polygon->NbNodes(); ++i) {
    const gp_Pnt a = mesh->Node(polygon->Nodes()(i)).Transformed(location);
    const gp_Pnt b = mesh->Node(polygon->Nodes()(i + 1)).Transformed(location);
    const double s = polygon->Parameters()->Value(i), t = polygon->Parameters()->Value(i + 1);
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      error = std::max(error, distance_to_chord(curve.Value(s + (t - s) * share), a, b));
    }
  }
  return error;
}

void put(double x)
{
  std::fwrite(&x, sizeof x, 1, stdout);
}

} // namespace

int main(int count, char** arguments)
try {
  if (count != 3) {
    throw std::runtime_error("aabb MODEL CHORD < points > distances");
  }
  // OCCT writes about its reading on std::cout.
  std::cout.setstate(std::ios::failbit);
  const TopoDS_Shape shape = read(arguments[1]);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  std::vector<Triangles> triangles(faces.Extent());
  std::vector<Tree> trees(faces.Extent());
  put(faces.Extent());
  for (int i = 0; i < faces.Extent(); ++i) {
    const TopoDS_Face face = TopoDS::Face(faces(i + 1).Oriented(TopAbs_FORWARD));
    Bnd_Box box;
    BRepBndLib::Add(face, box, Standard_False);
    const double size = std::sqrt(box.SquareExtent());
    BRepMesh_IncrementalMesh(face, size * std::stod(arguments[2]), Standard_False, 0.3);
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull()) {
      // Nothing can be said of its distances.
      put(HUGE_VAL);
      continue;
    }
    double error = chord_error(face, *mesh, location);
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      error = std::max(error, border_error(TopoDS::Edge(it.Current()), mesh, location));
    }
    put(error);
    for (int k = 1; k <= mesh->NbTriangles(); ++k) {
      int n[3];
      mesh->Triangle(k).Get(n[0], n[1], n[2]);
      Kernel::Point_3 p[3];
      for (int c = 0; c < 3; ++c) {
        const gp_Pnt node = mesh->Node(n[c]).Transformed(location);
        p[c] = Kernel::Point_3(node.X(), node.Y(), node.Z());
      }
      const Kernel::Triangle_3 triangle(p[0], p[1], p[2]);
      if (!triangle.is_degenerate()) {
        triangles[i].push_back(triangle);
      }
    }
    trees[i].insert(triangles[i].begin(), triangles[i].end());
    trees[i].accelerate_distance_queries();
  }
  double query[4];
  while (std::fread(query, sizeof query, 1, stdin) == 1) {
    const Tree& tree = trees.at(static_cast<std::size_t>(query[0]));
    put(tree.empty() ? HUGE_VAL : std::sqrt(tree.squared_distance(Kernel::Point_3(query[1], query[2], query[3]))));
  }
  return 0;
} catch (const Standard_Failure& failure) {
  std::cerr << failure.GetMessageString() << '\n';
  return 1;
} catch (const std::exception& failure) {
  std::cerr << failure.what() << '\n';
  return 1;
}
