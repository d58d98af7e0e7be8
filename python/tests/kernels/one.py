"""Imports packages in the order given and has each kernel at work, in one process: cadquery or build123d, netgen, gmsh, pyvista, and ours.

Usage: one.py NAME… with names of WORK. Each works once after all imports, in the order given, and once more in the reverse order.
"""

import importlib
import sys
import tempfile

MODULES = {"netgen": "netgen.occ"}


def ours():
    import numpy as np

    import geo_adapt

    model = geo_adapt.Model(geo_adapt.examples.cylinder())
    near = model.closest([[3.0, 0.0, 1.0], [0.0, 0.0, 5.0]])
    assert np.allclose(near.distances, [2, 3]), near
    mesh = geo_adapt.bootstrap(model, size=0.7)
    m = geo_adapt.metric.geometry(mesh, model)
    result = geo_adapt.adapt(mesh, m, model, complexity=400, order="medit")
    assert geo_adapt.inspect(result.mesh, model=model)["valid"]
    with tempfile.NamedTemporaryFile(suffix=".brep") as file:
        model.write_brep(file.name)
        assert len(geo_adapt.Model(file.name).faces) == 3


def same_faces(part, areas):
    """The faces are there, in the other kernel's order."""
    if "geo_adapt" not in sys.modules:
        return
    import geo_adapt

    assert len(areas) == 7
    for own, area in zip(geo_adapt.Model(part).faces, areas, strict=True):
        assert abs(own.area - area) < 1e-9


def cadquery():
    import cadquery

    part = cadquery.Workplane("XY").box(1, 2, 3).faces(">Z").workplane().hole(0.4)
    assert abs(part.val().Volume() - (6 - 3 * 3.141592653589793 * 0.04)) < 1e-9
    same_faces(part, [face.Area() for face in part.faces().vals()])


def build123d():
    import build123d

    part = build123d.Box(1, 2, 3) - build123d.Cylinder(0.2, 3)
    assert abs(part.volume - (6 - 3 * 3.141592653589793 * 0.04)) < 1e-9
    same_faces(part, [face.area for face in part.faces()])


def netgen():
    from netgen.occ import Box, OCCGeometry, Pnt

    box = Box(Pnt(0, 0, 0), Pnt(1, 1, 1))
    assert abs(box.mass - 1) < 1e-9
    assert len(OCCGeometry(box).GenerateMesh(maxh=0.5).Elements3D()) > 8


def gmsh():
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(3)
    assert len(gmsh.model.mesh.getNodes()[0]) > 8
    gmsh.finalize()


def pyvista():
    import pyvista

    assert pyvista.Sphere().volume > 0.4


WORK = {"geo_adapt": ours, "cadquery": cadquery, "build123d": build123d, "netgen": netgen, "gmsh": gmsh, "pyvista": pyvista}


def main():
    names = sys.argv[1:]
    if names[0] == "--global":
        # Whatever is loaded from now on shares its symbols with all: the worst that another package can do.
        import os

        sys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)
        names = names[1:]
    for name in names:
        importlib.import_module(MODULES.get(name, name))
    for name in [*names, *reversed(names)]:
        WORK[name]()
    with open("/proc/self/maps") as maps:
        kernels = {line.split()[-1] for line in maps if "/libTK" in line}
    ours_, others = ({k for k in kernels if ("geo_adapt.libs" in k) == own} for own in (True, False))
    assert ours_ or "geo_adapt" not in names, "no OpenCASCADE of ours"
    system = [k for k in others if k.startswith(("/usr/lib", "/lib"))]
    assert not system, f"the system's OpenCASCADE: {system}"
    print(f"{' '.join(names)}: {len(ours_)} libraries of OpenCASCADE are ours, {len(others)} are others'")


main()
