"""The loop on an analytic function: nothing to install; the interpolation error falls with second order, and edges are of unit length.

Runs loop.toml anew, and judges its last mesh. Exit code: 0 when every floor is held, else 1.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from comparing.expected import Bound  # noqa: E402
from convergence_study.quadrature import interpolation_error  # noqa: E402
from convergence_study.scalars import SCALARS  # noqa: E402
from convergence_study.study import fitted_order  # noqa: E402
from judging import cycles, loops, meshfile, report  # noqa: E402

HERE = Path(__file__).resolve().parent
OUT = cycles.ROOT / "out" / "analytic-cycle"
# (target, floor of today). Second order is 2/3 with the vertices.
BOUNDS = [
    Bound("order", "≥", 0.65, 0.62), Bound("unit_edges", "≥", 0.95, 0.95),
    Bound("ratio_least", "≥", 0.4, 0.3), Bound("ratio_mean", "≥", 0.87, 0.85),
    Bound("error", "≤", 0.005, 0.005), Bound("seconds", "≤", 30, 180),
]
# Complexities that the order is fitted to.
FITTED = 3
# The loop's error and the judge's, by other rules on other pieces.
AGREE = 0.02


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
    # The last mesh of each complexity.
    last = [now for now, then in zip(loop, [*loop[1:], {}]) if now["complexity"] != then.get("complexity")][-FITTED:]
    path = OUT / f"loop/cycle-{loop[-2]['cycle']:02}/adapt/mesh.meshb"
    mesh = meshfile.read_mesh(path)
    figures = report.figures(mesh, meshfile.read_metric(path.with_suffix(".solb")))
    figures["seconds"] = seconds
    figures["order"] = fitted_order([step["vertices"] for step in last], [step["functionals"]["error"] for step in last])
    figures["error"] = interpolation_error(mesh.points, mesh.tets, SCALARS["sinfun3"])[0]
    lost = list(figures["findings"])
    told = loop[-1]["functionals"]["error"]
    if abs(told - figures["error"]) > AGREE * figures["error"]:
        lost.append(f"the loop tells the error {told:.5g}, the judge {figures['error']:.5g}")
    return loops.judged(BOUNDS, figures, lost)


if __name__ == "__main__":
    sys.exit(main())
