"""Advection and diffusion by scikit-fem in the loop: a layer of 0.005 on the cylinder's wall, against the exact solution and a uniform mesh.

Runs loop.toml anew, then the same solver on a uniform mesh of as many vertices. Exit code: 0 when every floor is held, else 1.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from comparing.expected import Bound  # noqa: E402
from judging import cycles, loops, meshfile, report  # noqa: E402

HERE = Path(__file__).resolve().parent
OUT = cycles.ROOT / "out" / "advection-diffusion"
START, MODEL = HERE.parent / "cube-cylinder/start.meshb", cycles.ROOT / "geometry/cube-cylinder.step"
# ε R: where the exact solution has fallen to 1/e.
LAYER, RADIUS = 0.005, 0.5
# π/2 R² / (1/ε - 2).
CONTENT = np.pi / 2 * RADIUS**2 / 98
# (target, floor of today)
BOUNDS = [
    Bound("uniform error / error", "≥", 500, 300), Bound("content, relative error", "≤", 0.005, 0.005),
    Bound("cells across the layer", "≥", 10, 8), Bound("unit_edges", "≥", 0.92, 0.90), Bound("seconds", "≤", 120, 360),
]


def run(*words):
    """A command that must end well."""
    ended = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if ended.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}\nended with {ended.returncode}: {ended.stderr.strip()}")


def uniform(program, vertices):
    """Vertices and functionals on a mesh of one size everywhere, with as many vertices as can be had in two tries."""
    sizes, mesh, grid = OUT / "uniform-in.solb", OUT / "uniform.meshb", OUT / "uniform.vtu"
    start = meshfile.read_mesh(START)
    meshfile.write_metric(sizes, np.tile(np.eye(3), (len(start.points), 1, 1)))
    complexity, found = vertices / 2, 0
    for _ in range(2):
        mesh.unlink(missing_ok=True)
        run(program, "adapt", START, "-o", mesh, "--cad", MODEL, "--metric", sizes, "--complexity", complexity, "--quiet")
        found = len(meshfile.read_mesh(mesh).points)
        complexity *= vertices / found
    run(program, "convert", mesh, grid)
    run(cycles.ROOT / ".venv/fem/bin/python", HERE / "solve.py", grid, OUT / "uniform-solution.vtu")
    return found, json.loads((OUT / "result.json").read_text())


def across(mesh):
    """Cells across the layer: its thickness over the mean height of the tetrahedra with a triangle on the wall."""
    radius = np.hypot(mesh.points[:, 0], mesh.points[:, 1])
    wall = np.abs(radius - RADIUS) < 1e-6
    count = wall[mesh.tets].sum(1)
    heights = np.where(wall[mesh.tets], 0, radius[mesh.tets] - RADIUS).max(1)[count == 3]
    return LAYER / heights.mean()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=cycles.ROOT / "target/release/geo-adapt")
    options = parser.parse_args()
    OUT.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    if subprocess.run([options.program, "cycle", HERE / "loop.toml", "--restart"], check=False).returncode != 0:
        return 1
    seconds = time.monotonic() - began
    loop = json.loads((OUT / "loop/report.json").read_text())["cycles"]
    told = loop[-1]["functionals"]
    path = OUT / f"loop/cycle-{loop[-2]['cycle']:02}/adapt/mesh.meshb"
    mesh = meshfile.read_mesh(path)
    figures = report.figures(mesh, meshfile.read_metric(path.with_suffix(".solb")))
    vertices, plain = uniform(options.program, len(mesh.points))
    cycles.say(f"  adapted {len(mesh.points)} vertices: error {told['error']:.4g}, content {told['content']:.6f} (exact {CONTENT:.6f})")
    cycles.say(f"  uniform {vertices} vertices: error {plain['error']:.4g}, content {plain['content']:.6f}")
    figures |= {
        "uniform error / error": plain["error"] / told["error"],
        "content, relative error": abs(told["content"] / CONTENT - 1),
        "cells across the layer": across(mesh),
        "seconds": seconds,
    }
    return loops.judged(BOUNDS, figures, figures["findings"])


if __name__ == "__main__":
    sys.exit(main())
