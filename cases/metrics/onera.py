#!/usr/bin/env python3
"""Compares geo-adapt's multiscale metric on the ONERA M6 wing with the one that another code made from the same field.

    onera.py --program target/release/geo-adapt [--shared /work/shared/cases/onera-m6] [OPTIONS OF metric multiscale ...]

From the Mach number on the shared mesh, L2 norm, at the complexity of the file's metric: with Hessians by the quadratic fit and by L2
projection. Prints how far the three metrics are apart, as percentiles over the vertices: the distance |ln(M1^-1/2 M2 M1^-1/2)| (Frobenius), and
log2 of the ratio of sizes along the eigenvectors of M1 (+1: M2 is twice as coarse there). Exit code 2: a file cannot be read or a run failed.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from judging import meshfile, metric  # noqa: E402

PERCENTS = (0, 1, 10, 50, 90, 99, 100)
NAME = "onera_curvAdapt"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/geo-adapt", help="the built program (default %(default)s)")
    parser.add_argument("--shared", type=Path, default=Path("/work/shared/cases/onera-m6"), help="folder of the shared files")
    return parser.parse_known_args()


def roots(matrices):
    """M^-1/2."""
    values, vectors = np.linalg.eigh(matrices)
    return np.einsum("nik,nk,njk->nij", vectors, values**-0.5, vectors)


def relative(first, second):
    """M1^-1/2 M2 M1^-1/2 at each vertex."""
    root = roots(first)
    return root @ second @ root


def distance(first, second):
    """|ln(M1^-1/2 M2 M1^-1/2)|, Frobenius, shape (n,)."""
    return np.sqrt((np.log(np.linalg.eigvalsh(relative(first, second))) ** 2).sum(1))


def size_ratios(first, second):
    """log2 of the size of M2 over that of M1 along the eigenvectors of M1, least size of M1 first, shape (n, 3)."""
    values, vectors = np.linalg.eigh(first)
    along = np.einsum("nik,nij,njk->nk", vectors, second, vectors)
    return -0.5 * np.log2(along / values)[:, ::-1]


def show(name, values):
    print(f"  {name:<34}" + " ".join(f"{x:9.3f}" for x in np.percentile(values, PERCENTS)))


def compare(title, mesh, boundary, first, second):
    far = distance(first, second)
    print(f"{title}")
    print(" " * 36 + " ".join(f"{p:8}%" for p in PERCENTS))
    show("distance", far)
    show("distance, on the boundary", far[boundary])
    show("distance, inside", far[~boundary])
    ratios = size_ratios(first, second)
    for k, size in enumerate(("least", "middle", "greatest")):
        show(f"log2 of sizes, {size}", ratios[:, k])
    worst = int(far.argmax())
    sizes = [np.array2string(np.linalg.eigvalsh(m[worst])[::-1] ** -0.5, precision=3) for m in (first, second)]
    print(f"  farthest apart: vertex {worst + 1} at {mesh.points[worst]}, sizes {sizes[0]} and {sizes[1]}")
    return far


def main():
    options, extra = arguments()
    path = {kind: options.shared / f"{NAME}{kind}" for kind in (".meshb", "-mach.solb", "-metric.solb")}
    mesh = meshfile.read_mesh(path[".meshb"])
    given = meshfile.read_metric(path["-metric.solb"])
    target = metric.complexity(mesh.points, mesh.tets, given)
    boundary = np.zeros(len(mesh.points), bool)
    boundary[mesh.triangles.ravel()] = True
    print(f"{len(mesh.points)} vertices, {boundary.sum()} on the boundary; complexity of the file's metric {target:.1f}")
    ours = {}
    with tempfile.TemporaryDirectory() as folder:
        for hessian in ("fit", "l2"):
            output = Path(folder) / f"{hessian}.solb"
            command = [options.program, "metric", "multiscale", path[".meshb"], path["-mach.solb"], "-o", output, "-q"]
            subprocess.run([*command, "--complexity", str(target), "--hessian", hessian, *extra], check=True)
            ours[hessian] = meshfile.read_metric(output)
            print(f"{hessian}: complexity {metric.complexity(mesh.points, mesh.tets, ours[hessian]):.1f}")
    fit = compare("file against fit", mesh, boundary, ours["fit"], given)
    l2 = compare("file against l2", mesh, boundary, ours["l2"], given)
    between = compare("l2 against fit", mesh, boundary, ours["fit"], ours["l2"])
    nearer = np.minimum(fit, l2)
    show("file against the nearer of both", nearer)
    print(f"vertices where the file is farther from both than they are apart: {100 * (nearer > between).mean():.1f} %, "
          f"by a factor of two {100 * (nearer > 2 * between).mean():.1f} %")


if __name__ == "__main__":
    try:
        main()
    except (meshfile.FileError, OSError, subprocess.CalledProcessError) as error:
        print(f"onera.py: {error}", file=sys.stderr)
        sys.exit(2)
