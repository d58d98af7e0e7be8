"""The recipe of the coarse start meshes beside this file, by gmsh as in cases/cube-cylinder/start.py.

    pip install gmsh==4.15.2 numpy; python tests/data/start_meshes.py

Seams are listed as edges and the poles of the sphere as corners, as gmsh has them: a user's file looks like that.
"""

import importlib.util
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
spec = importlib.util.spec_from_file_location("start", ROOT / "cases" / "cube-cylinder" / "start.py")
start = importlib.util.module_from_spec(spec)
spec.loader.exec_module(start)


def main():
    for name, points in [("filleted-block", 4), ("sphere-in-box", 8)]:
        with tempfile.TemporaryDirectory() as folder:
            raw = Path(folder) / "start.msh"
            start.generate(ROOT / "geometry" / f"{name}.step", raw, points)
            mesh = start.convert(raw)
        if start.metric.volumes(mesh.points, mesh.tets).sum() < 0:
            mesh.tets = mesh.tets[:, [1, 0, 2, 3]]
        target = Path(__file__).parent / f"{name}.meshb"
        start.meshfile.write_mesh(target, mesh)
        print(f"wrote {target}: {len(mesh.points)} vertices, {len(mesh.tets)} tetrahedra")


if __name__ == "__main__":
    main()
