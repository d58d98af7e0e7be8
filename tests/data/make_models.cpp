// Writes the models of this folder: the shapes that the models in geometry/ lack.
//   g++ -std=c++17 -isystem /usr/include/opencascade make_models.cpp -o make_models -lTKIGES -lTKSTEP -lTKXSBase
//     -lTKOffset -lTKPrim -lTKTopAlgo -lTKBRep -lTKGeomBase -lTKG3d -lTKMath -lTKernel && ./make_models
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Writer.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Wire.hxx>
#include <gp_Elips.hxx>

#include <cmath>

int main()
{
  const gp_Ax2 axes(gp_Pnt(0.3, -0.2, 0.1), gp_Dir(1, 2, 3), gp_Dir(3, 0, -1));
  BRepTools::Write(BRepPrimAPI_MakeTorus(axes, 1.0, 0.3).Shape(), "torus.brep");
  BRepTools::Write(BRepPrimAPI_MakeCone(axes, 0.8, 0.0, 1.5, 2.0).Shape(), "cone-apex.brep");

  // A prism whose base crosses itself: no solid at all, but one to look at. In a folder of its own, out of the way of tests on all models.
  const TopoDS_Wire bow = BRepBuilderAPI_MakePolygon(gp_Pnt(0, 0, 0), gp_Pnt(1, 1, 0), gp_Pnt(1, 0, 0), gp_Pnt(0, 1, 0), Standard_True);
  BRepTools::Write(BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(bow, Standard_True).Face(), gp_Vec(0, 0, 1)).Shape(), "faulty/bow-tie.brep");

  // A mirrored, moved cylinder: its axes are left-handed.
  gp_Trsf mirror, shift;
  mirror.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 1, 0)));
  shift.SetTranslation(gp_Vec(5, 6, 7));
  const TopoDS_Shape cylinder = BRepPrimAPI_MakeCylinder(axes, 0.5, 2.0).Shape();
  BRepTools::Write(BRepBuilderAPI_Transform(cylinder, mirror).Shape().Moved(TopLoc_Location(shift)),
                   "mirrored-cylinder.brep");
  Interface_Static::SetIVal("write.step.schema", 3);
  STEPControl_Writer step;
  step.Transfer(cylinder, STEPControl_AsIs);
  step.Write("capped-cylinder.step");

  // A vase: a curve turned about an axis that it meets squarely, so that it closes with smooth poles.
  TColgp_Array1OfPnt points(1, 5);
  points(1) = gp_Pnt(0.0, 0, 0.0);
  points(2) = gp_Pnt(1.2, 0, 0.0);
  points(3) = gp_Pnt(-0.4, 0, 1.0);
  points(4) = gp_Pnt(1.5, 0, 2.0);
  points(5) = gp_Pnt(0.0, 0, 2.0);
  const TopoDS_Edge profile = BRepBuilderAPI_MakeEdge(new Geom_BezierCurve(points));
  const TopoDS_Shape vase = BRepPrimAPI_MakeRevol(profile, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape();
  BRepTools::Write(vase, "vase.brep");

  // A twisted duct of elliptic sections: a B-spline surface that closes on itself, with ellipses as edges.
  BRepOffsetAPI_ThruSections duct(Standard_True);
  for (int i = 0; i < 4; ++i) {
    const gp_Ax2 section(gp_Pnt(0.2 * i * i, 0, i), gp_Dir(0, 0, 1), gp_Dir(std::cos(0.3 * i), std::sin(0.3 * i), 0));
    const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(gp_Elips(section, 0.8, 0.5 + 0.05 * i));
    duct.AddWire(BRepBuilderAPI_MakeWire(edge).Wire());
  }
  BRepTools::Write(duct.Shape(), "duct.brep");

  // A cube beside a solid without faces, which some programs leave behind.
  BRep_Builder builder;
  TopoDS_Compound compound;
  TopoDS_Solid hollow;
  builder.MakeCompound(compound);
  builder.MakeSolid(hollow);
  builder.Add(compound, hollow);
  builder.Add(compound, BRepPrimAPI_MakeBox(1.0, 1.0, 1.0).Solid());
  BRepTools::Write(compound, "hollow-solid.brep");

  // A whole sphere and a whole torus: a face without wires each, as some programs write them. Beside the faulty ones, since there the
  // file's own numbers of edges are not those of the model that is read.
  const auto whole = [&](const Handle(Geom_Surface)& surface, const char* name) {
    TopoDS_Face face;
    TopoDS_Shell shell;
    TopoDS_Solid solid;
    builder.MakeFace(face, surface, 1e-7);
    builder.MakeShell(shell);
    builder.Add(shell, face);
    shell.Closed(Standard_True);
    builder.MakeSolid(solid);
    builder.Add(solid, shell);
    BRepTools::Write(solid, name);
  };
  whole(new Geom_SphericalSurface(axes, 0.5), "faulty/whole-sphere.brep");
  whole(new Geom_ToroidalSurface(axes, 1.0, 0.3), "faulty/whole-torus.brep");

  // A block in inches, as loose faces: what IGES is mostly.
  IGESControl_Writer iges("INCH", 0);
  iges.AddShape(BRepPrimAPI_MakeBox(25.4, 50.8, 76.2).Shape());
  iges.Write("block-inches.igs");
  return 0;
}
