"""The recipe of start.meshb: a coarse mesh of geometry/cube-cylinder.step by gmsh, with the model's numbers as references.

    pip install gmsh==4.15.2 numpy; python cases/cube-cylinder/start.py

gmsh is started as a program (size from curvature, 12 points a circle). Its entity tags follow the order of the
STEP file (TopExp::MapShapes), so the elementary tag of a triangle is the number of its CAD face, that of an
edge the number of its CAD edge; nodes on points of the model become corners.
"""

import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cases"))
from judging import cube_cylinder, meshfile, metric, validity  # noqa: E402

POINT, LINE, TRIANGLE, TET = 15, 1, 2, 4
NODES = {POINT: 1, LINE: 2, TRIANGLE: 3, TET: 4}


def generate(model, target, points=12):
    """Writes gmsh's mesh of the model as MSH 2.2 text, with so many points a circle."""
    # PyPI's gmsh is a Python script whose interpreter must be the one of its virtual environment.
    script = Path(sysconfig.get_path("scripts")) / "gmsh"
    start = [sys.executable, script] if script.is_file() else [shutil.which("gmsh") or sys.exit("gmsh is not there: pip install gmsh==4.15.2")]
    options = ["-3", "-clcurv", str(points), "-nt", "1", "-format", "msh22", "-save_all", "-v", "1", "-o", target]
    subprocess.run([*start, model, *options], check=True)


def section(lines, name):
    """The lines between $name and $Endname, without the count."""
    first = lines.index(f"${name}")
    return lines[first + 2 : lines.index(f"$End{name}")]


def convert(path):
    """The mesh of an MSH 2.2 file, nodes numbered by their order, elementary tags as references."""
    lines = path.read_text().splitlines()
    nodes = [line.split() for line in section(lines, "Nodes")]
    number = {int(node[0]): i for i, node in enumerate(nodes)}
    cells = {kind: [] for kind in NODES}
    for line in section(lines, "Elements"):
        words = [int(word) for word in line.split()]
        # number, kind, number of tags, physical tag, elementary tag, …, nodes
        kind, tags = words[1], words[2]
        cells[kind].append([number[node] for node in words[3 + tags :]] + [words[4]])
    table = {kind: np.array(rows, np.int64).reshape(-1, NODES[kind] + 1) for kind, rows in cells.items()}
    points = np.array([[float(word) for word in node[1:4]] for node in nodes])
    none = np.zeros((0, 2), np.int64)
    return meshfile.Mesh(
        points, np.zeros(len(points), np.int64),
        table[LINE][:, :2], table[LINE][:, 2], table[TRIANGLE][:, :3], table[TRIANGLE][:, 3],
        table[TET][:, :4], table[TET][:, 4], table[POINT][:, 0], none, none, none, np.zeros((0, 2)), np.zeros((0, 3)),
    )


def main():
    with tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "start.msh"
        generate(ROOT / "geometry" / "cube-cylinder.step", raw)
        mesh = convert(raw)
    if metric.volumes(mesh.points, mesh.tets).sum() < 0:
        mesh.tets = mesh.tets[:, [1, 0, 2, 3]]
    found = validity.findings(mesh) + cube_cylinder.judge(mesh)[1]
    if found:
        sys.exit("the start mesh is not good:\n  " + "\n  ".join(found))
    target = Path(__file__).parent / "start.meshb"
    meshfile.write_mesh(target, mesh)
    print(f"wrote {target}: {len(mesh.points)} vertices, {len(mesh.tets)} tetrahedra")


if __name__ == "__main__":
    main()
