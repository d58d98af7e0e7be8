#!/usr/bin/env python3
"""How well meshes that geo-adapt adapts to a scalar on the unit cube interpolate it, by the way Hessians are recovered.

    interpolation.py --program target/release/geo-adapt --complexity 2000 4000 8000 [--hessian fit l2] [--loops 6] [OPTIONS OF adapt --field ...]

From a uniform mesh: evaluate sinatan3 = 0.1 sin(50xz) + atan(0.1/(sin 5y - 2xz)) at the vertices, `geo-adapt adapt --field`, again. Prints vertices,
L2 error of the linear interpolant (a rule of degree 5 with 14 points on each tetrahedron), and error·N^(2/3), constant where
the error is of second order. The field is only continuous where sin 5y = 2xz: the arctangent there jumps, and so does the error's order suffer;
--function smooth takes tanh(25(x + y z - 0.8)) instead.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from judging import meshfile, metric  # noqa: E402


def sinatan3(points):
    x, y, z = points.T
    with np.errstate(divide="ignore"):
        return 0.1 * np.sin(50 * x * z) + np.arctan(0.1 / (np.sin(5 * y) - 2 * x * z))


def smooth(points):
    x, y, z = points.T
    return np.tanh(25 * (x + y * z - 0.8))


FUNCTIONS = {"sinatan3": sinatan3, "smooth": smooth}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/geo-adapt", help="the built program (default %(default)s)")
    parser.add_argument("--complexity", type=float, nargs="+", default=[2000, 4000, 8000])
    parser.add_argument("--hessian", nargs="+", default=["fit", "l2"])
    parser.add_argument("--function", choices=FUNCTIONS, default="sinatan3")
    parser.add_argument("--loops", type=int, default=6, help="adaptations (default %(default)s); the last three are averaged")
    return parser.parse_known_args()


def rule():
    """Weights and barycentric coordinates of a rule of degree 5 with 14 points (Walkington 2000)."""
    corner = [(0.31088591926330060980, 0.11268792571801585080), (0.092735250310891226402, 0.073493043116361949544)]
    weights, places = [], []
    for b, weight in corner:
        for i in range(4):
            place = np.full(4, b)
            place[i] = 1 - 3 * b
            weights.append(weight)
            places.append(place)
    b = 0.045503704125649649492
    for i in range(4):
        for j in range(i + 1, 4):
            place = np.full(4, b)
            place[[i, j]] = 0.5 - b
            weights.append(0.042546020777081466438)
            places.append(place)
    return np.array(weights), np.array(places)


def error(mesh, function):
    """L2 norm of function minus its linear interpolant."""
    values, volumes = function(mesh.points)[mesh.tets], np.abs(metric.volumes(mesh.points, mesh.tets))
    total = 0.0
    for weight, place in zip(*rule()):
        points = np.einsum("i,nij->nj", place, mesh.points[mesh.tets])
        total += weight * (volumes * (function(points) - values @ place) ** 2).sum()
    return np.sqrt(total)


def uniform(n):
    """The unit cube as n³ cells of six tetrahedra."""
    steps = np.stack(np.meshgrid(*[np.arange(n + 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
    cells = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3)
    tets = []
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (0, 2, 1), (2, 1, 0)):
        at, nodes = cells.copy(), []
        for axis in (None, *order):
            if axis is not None:
                at[:, axis] += 1
            nodes.append((at[:, 0] * (n + 1) + at[:, 1]) * (n + 1) + at[:, 2])
        if order in ((1, 0, 2), (0, 2, 1), (2, 1, 0)):
            nodes[0], nodes[1] = nodes[1], nodes[0]
        tets.append(np.stack(nodes, 1))
    tets = np.concatenate(tets)
    faces = np.concatenate([tets[:, face] for face in ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))])
    sides = [(faces[(steps[faces][:, :, axis] == value).all(1)], 2 * axis + side + 1)
             for axis in range(3) for side, value in enumerate((0, n))]
    triangles = np.concatenate([some for some, _ in sides])
    refs = np.concatenate([np.full(len(some), side) for some, side in sides])
    none = np.zeros((0, 2), int)
    return meshfile.Mesh(steps / n, np.zeros(len(steps), int), none, none[:, 0], triangles, refs, tets, np.ones(len(tets), int),
                         none[:, 0], *[None] * 5)


def adapted(options, extra, function, hessian, complexity, folder):
    """The errors and vertex counts of the last three meshes."""
    mesh, found = uniform(12), []
    names = [Path(folder) / name for name in ("in.meshb", "in.solb", "out.meshb")]
    for _ in range(options.loops):
        meshfile.write_mesh(names[0], mesh)
        meshfile.write_scalars(names[1], function(mesh.points)[:, None])
        command = [options.program, "adapt", names[0], "--field", names[1], "--complexity", str(complexity), "-o", names[2], "-q"]
        subprocess.run([*command, "--hessian", hessian, *extra], check=True)
        mesh = meshfile.read_mesh(names[2])
        found.append((len(mesh.points), error(mesh, function)))
    return np.array(found[-3:]).mean(0)


def main():
    options, extra = arguments()
    function = FUNCTIONS[options.function]
    print(f"{'hessian':<8} {'complexity':>10} {'vertices':>9} {'L2 error':>10} {'error N^(2/3)':>14}")
    with tempfile.TemporaryDirectory() as folder:
        for complexity in options.complexity:
            for hessian in options.hessian:
                count, off = adapted(options, extra, function, hessian, complexity, folder)
                print(f"{hessian:<8} {complexity:>10.0f} {count:>9.0f} {off:>10.3e} {off * count ** (2 / 3):>14.4f}", flush=True)


if __name__ == "__main__":
    try:
        main()
    except (meshfile.FileError, OSError, subprocess.CalledProcessError) as problem:
        print(f"interpolation.py: {problem}", file=sys.stderr)
        sys.exit(2)
