// Writes the spline models of this folder: rational, periodic, with poles, of high degree and of high curvature.
//   g++ -std=c++17 -isystem /usr/include/opencascade make_splines.cpp -o make_splines
//     -lTKPrim -lTKTopAlgo -lTKBRep -lTKGeomAlgo -lTKGeomBase -lTKG3d -lTKMath -lTKernel && ./make_splines
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_OffsetSurface.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>

#include <cmath>

namespace {

/// A Bezier surface of waves over the unit square.
Handle(Geom_BezierSurface) waves(int rows, int columns, double height)
{
  TColgp_Array2OfPnt poles(1, rows, 1, columns);
  for (int i = 1; i <= rows; ++i) {
    for (int j = 1; j <= columns; ++j) {
      const double x = double(i - 1) / (rows - 1), y = double(j - 1) / (columns - 1);
      poles(i, j) = gp_Pnt(x, y, height * std::sin(9.0 * x) * std::cos(7.0 * y));
    }
  }
  return new Geom_BezierSurface(poles);
}

} // namespace

int main()
{
  const gp_Ax2 axes(gp_Pnt(0.3, -0.2, 0.1), gp_Dir(1, 2, 3), gp_Dir(3, 0, -1));
  gp_Trsf mirror, shift;
  mirror.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 1, 0)));
  shift.SetTranslation(gp_Vec(5, 6, 7));
  // Rational and periodic, in u and v; with a location of its own.
  const TopoDS_Shape torus = BRepPrimAPI_MakeTorus(axes, 1.0, 0.3).Shape();
  BRepTools::Write(BRepBuilderAPI_NurbsConvert(torus).Shape().Moved(TopLoc_Location(shift)), "nurbs-torus.brep");
  // Rational with poles, mirrored.
  const TopoDS_Shape sphere = BRepBuilderAPI_NurbsConvert(BRepPrimAPI_MakeSphere(axes, 0.7).Shape()).Shape();
  BRepTools::Write(BRepBuilderAPI_Transform(sphere, mirror).Shape(), "nurbs-sphere.brep");

  // A periodic curve with a sharp end and a dent, drawn out: high curvature, and walls that face each other closely.
  const int count = 12;
  const Handle(TColgp_HArray1OfPnt) ring = new TColgp_HArray1OfPnt(1, count);
  for (int i = 0; i < count; ++i) {
    const double t = 2.0 * M_PI * i / count;
    ring->SetValue(i + 1, gp_Pnt(std::cos(t) + 0.3 * std::cos(2 * t), 0.12 * std::sin(t) * (1.2 - std::cos(t)), 0.0));
  }
  GeomAPI_Interpolate through(ring, Standard_True, 1e-9);
  through.Perform();
  const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(through.Curve());
  const TopoDS_Face base = BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(edge).Wire(), Standard_True);
  BRepTools::Write(BRepPrimAPI_MakePrism(base, gp_Vec(0.2, 0.1, 1.0)).Shape(), "blade.brep");

  // Loose faces: Bezier surfaces of a high degree and of a low one, and an offset surface.
  TopoDS_Compound faces;
  BRep_Builder builder;
  builder.MakeCompound(faces);
  const Handle(Geom_BezierSurface) high = waves(15, 12, 2.0), low = waves(3, 4, 0.5);
  low->Translate(gp_Vec(2, 0, 0));
  builder.Add(faces, BRepBuilderAPI_MakeFace(high, 1e-7).Face());
  builder.Add(faces, BRepBuilderAPI_MakeFace(low, 0.1, 0.8, 0.2, 0.9, 1e-7).Face());
  builder.Add(faces, BRepBuilderAPI_MakeFace(new Geom_OffsetSurface(low, 0.05), 1e-7).Face());
  BRepTools::Write(faces, "waves.brep");
  return 0;
}
