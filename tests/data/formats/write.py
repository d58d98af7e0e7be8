"""Writes the files of this folder as VTK, meshio and PyVista write them. Run by hand: python write.py (needs pyvista==0.49.1, meshio==5.3.5)."""

import subprocess
from pathlib import Path

import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

FOLDER = Path(__file__).resolve().parent
POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float) / 3
TETS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 4], [1, 4, 3], [2, 3, 4]])
PRESSURE = np.array([1.5, -2, 3, 1e-30, 7])
VELOCITY = np.arange(15.0).reshape(5, 3) / 7
REFERENCE = [[4, 4], [7, 7, 7, 9, 9, 9]]
DENSITY = [[1.0, 2.0], [0.0] * 6]


def write_by_vtk():
    """VTK's own writer in each of its modes."""
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(POINTS, deep=True))
    grid.SetPoints(points)
    for kind, cells in ((vtk.VTK_TETRA, TETS), (vtk.VTK_TRIANGLE, TRIANGLES)):
        for cell in cells:
            grid.InsertNextCell(kind, len(cell), cell.tolist())

    def attach(data, name, values):
        array = numpy_to_vtk(np.asarray(values), deep=True)
        array.SetName(name)
        data.AddArray(array)

    attach(grid.GetPointData(), "pressure", PRESSURE)
    attach(grid.GetPointData(), "velocity", VELOCITY)
    attach(grid.GetCellData(), "reference", np.concatenate(REFERENCE).astype(np.int32))
    attach(grid.GetCellData(), "density", np.concatenate(DENSITY))
    modes = {"ascii": vtk.vtkXMLWriter.Ascii, "inline": vtk.vtkXMLWriter.Binary, "appended": vtk.vtkXMLWriter.Appended}
    for name, mode in modes.items():
        for zlib in (False, True):
            for encode in (False, True):
                if (encode and name != "appended") or (zlib and name == "ascii"):
                    continue
                writer = vtk.vtkXMLUnstructuredGridWriter()
                writer.SetInputData(grid)
                writer.SetDataMode(mode)
                writer.SetCompressorTypeToZLib() if zlib else writer.SetCompressorTypeToNone()
                writer.SetEncodeAppendedData(encode)
                writer.SetByteOrderToBigEndian() if encode else writer.SetByteOrderToLittleEndian()
                writer.SetFileName(str(FOLDER / f"vtk-{name}{'-zlib' * zlib}{'-base64' * encode}.vtu"))
                assert writer.Write() == 1


def write_legacy_by_vtk():
    """VTK's legacy writer in both versions and modes, and a surface."""
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(POINTS, deep=True))
    grid.SetPoints(points)
    for kind, cells in ((vtk.VTK_TETRA, TETS), (vtk.VTK_TRIANGLE, TRIANGLES)):
        for cell in cells:
            grid.InsertNextCell(kind, len(cell), cell.tolist())

    def attach(data, name, values):
        array = numpy_to_vtk(np.asarray(values), deep=True)
        array.SetName(name)
        data.AddArray(array)

    attach(grid.GetPointData(), "pressure", PRESSURE)
    attach(grid.GetPointData(), "velocity", VELOCITY)
    grid.GetPointData().SetActiveScalars("pressure")
    grid.GetPointData().SetActiveVectors("velocity")
    grid.GetPointData().GetArray("velocity").SetComponentName(0, "u")
    attach(grid.GetCellData(), "reference", np.concatenate(REFERENCE).astype(np.int32))
    attach(grid.GetCellData(), "density ρ %", np.concatenate(DENSITY))
    for version, number in ((42, 42), (51, 51)):
        for text in (False, True):
            writer = vtk.vtkUnstructuredGridWriter()
            writer.SetInputData(grid)
            writer.SetFileVersion(number)
            writer.SetFileTypeToASCII() if text else writer.SetFileTypeToBinary()
            writer.SetFileName(str(FOLDER / f"vtk-legacy-{version}{'-ascii' * text}.vtk"))
            assert writer.Write() == 1
    surface = vtk.vtkGeometryFilter()
    only = vtk.vtkUnstructuredGrid()
    only.SetPoints(points)
    for cell in TRIANGLES:
        only.InsertNextCell(vtk.VTK_TRIANGLE, 3, cell.tolist())
    attach(only.GetPointData(), "pressure", PRESSURE)
    surface.SetInputData(only)
    writer = vtk.vtkPolyDataWriter()
    writer.SetInputConnection(surface.GetOutputPort())
    writer.SetFileVersion(42)
    writer.SetFileName(str(FOLDER / "vtk-legacy-polydata.vtk"))
    assert writer.Write() == 1


def write_by_gmsh():
    """A cube with physical groups, by `gmsh -3` as .inp and .bdf."""
    script = FOLDER / "cube.geo"
    script.write_text(
        "SetFactory(\"Built-in\");\nPoint(1) = {0, 0, 0, 1};\nline[] = Extrude {1, 0, 0} { Point{1}; Layers{1}; };\n"
        "face[] = Extrude {0, 1, 0} { Curve{line[1]}; Layers{1}; };\nbody[] = Extrude {0, 0, 1} { Surface{face[1]}; };\n"
        "Mesh.CharacteristicLengthMin = 1;\nPhysical Volume(\"fluid\") = {body[1]};\n"
        "Physical Surface(\"inlet\") = {face[1]};\nPhysical Surface(\"walls\") = {body[0], body[2]};\n"
    )
    for ending in ("inp", "bdf"):
        subprocess.run(["gmsh", "-3", "-v", "0", str(script), "-o", str(FOLDER / f"gmsh-cube.{ending}")], check=True)
    script.unlink()


def write_by_meshio():
    """meshio's writers."""
    mesh = meshio.Mesh(
        POINTS,
        [("tetra", TETS), ("triangle", TRIANGLES)],
        point_data={"pressure": PRESSURE, "velocity": VELOCITY},
        cell_data={"medit:ref": [np.array(r, np.int32) for r in REFERENCE], "density": [np.array(d) for d in DENSITY]},
    )
    meshio.vtu.write(FOLDER / "meshio-binary.vtu", mesh)
    meshio.vtu.write(FOLDER / "meshio-ascii.vtu", mesh, binary=False)
    grouped = meshio.Mesh(
        POINTS,
        [("tetra", TETS), ("triangle", TRIANGLES)],
        cell_data={
            "gmsh:physical": [np.array(r, np.int32) for r in REFERENCE],
            "gmsh:geometrical": [np.array(r, np.int32) for r in REFERENCE],
        },
        field_data={"inlet": np.array([7, 2]), "outlet": np.array([9, 2]), "fluid": np.array([4, 3])},
    )
    for name, version, binary in (("22", "2.2", True), ("22-ascii", "2.2", False), ("41", "4.1", True), ("41-ascii", "4.1", False)):
        grouped.point_data = {"pressure": PRESSURE, "velocity": VELOCITY}
        if not binary:
            grouped.point_data = {}  # meshio 5.3.5 writes np.float64(1.5) here with numpy 2
        if version == "4.1":
            grouped.point_data["gmsh:dim_tags"] = np.array([[3, 4]] * len(POINTS))
        meshio.gmsh.write(FOLDER / f"meshio-{name}.msh", grouped, version, binary=binary)


if __name__ == "__main__":
    write_by_vtk()
    write_legacy_by_vtk()
    write_by_gmsh()
    write_by_meshio()
