"""The turbulent flat plate of NASA's Turbulence Modeling Resource by SU2 in the loop: drag and friction against its figures.

A coarse slab of tetrahedra gets layers by `metric wall`, then SU2 (Spalart and Allmaras) solves three times, and the mesh is adapted to wall and flow between. --short:
twice. It needs SU2_CFD on the PATH, and ends with 0 where that is not there. Exit code: 0 when every floor is held, else 1.
"""

import argparse
import json
import shutil
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import plate  # noqa: E402
from comparing.expected import Bound  # noqa: E402
from judging import cycles, loops, meshfile, metric  # noqa: E402

HERE = Path(__file__).resolve().parent
OUT = cycles.ROOT / "out" / "flat-plate"
# y⁺ about 1 at a metre.
WALL = "wall:yplus=1,re=5e6,length=1,growth=1.2,tangential=0.04"
FIRST = 6
AT, DRAG, FRICTION = 0.97, 0.00286, 0.0027
# (target, floor of today).
BOUNDS = [
    Bound("drag, error", "≤", 0.02, 0.02), Bound("friction, error", "≤", 0.02, 0.02), Bound("law, error", "≤", 0.05, 0.05),
    Bound("least ratio", "≥", 0.05, 0.05), Bound("adaptation", "≤", 0.05, 0.05), Bound("greatest ratio at the wall", "≥", 1000, 1000),
]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=cycles.ROOT / "target/release/geo-adapt")
    parser.add_argument("--short", action="store_true", help="two solves")
    return parser.parse_args()


def first(program, folder):
    """The first mesh: the coarse one, adapted to the layers that it can have."""
    mesh = folder / "coarse.mesh"
    plate.coarse(mesh)
    return loops.layered(program, mesh, ["--wall", WALL], (["--hmax", "0.15"], []), FIRST)


def judged(path, solve, functionals):
    """The figures of a solve on a mesh, whose metric lies beside it."""
    mesh, found = meshfile.read_mesh(path), loops.fields(solve / "solution.solb")
    ratios = metric.mean_ratios(mesh.points, mesh.tets, meshfile.read_metric(path.with_suffix(".solb")))
    x, along, friction = plate.friction(mesh, found, AT)
    y_plus, u_plus = plate.profile(mesh, found, AT, friction, 0.05)
    inside = (y_plus > 1) & (y_plus < 500)
    law = plate.spalding(y_plus)
    height, stretched = plate.heights(mesh)
    return {
        "vertices": len(mesh.points), "CD": functionals["CD"], "iterations": functionals["iterations"], "friction": friction,
        "drag, error": abs(functionals["CD"] / DRAG - 1), "friction, error": abs(friction / FRICTION - 1),
        "law, error": float(np.abs(u_plus[inside] / law[inside] - 1).mean()), "first height, y⁺": height * plate.REYNOLDS * float(np.sqrt(friction / 2)),
        "greatest ratio at the wall": stretched, "least ratio": float(ratios.min()),
    }, (x, along), (y_plus, u_plus)


def drawn(path, along, profile):
    """c_f along the plate, and u⁺ of y⁺ beside the law."""
    _, (left, right) = pyplot.subplots(1, 2, figsize=(11, 4.2))
    left.plot(*along, ".", ms=3)
    left.plot(AT, FRICTION, "r+", ms=12, label="TMR at x = 0.97")
    left.set(xlabel="x", ylabel="c_f", ylim=(0, 0.006))
    left.legend()
    right.semilogx(*profile, ".", ms=3, label=f"points about x = {AT}")
    y = np.geomspace(0.5, 1e3)
    right.semilogx(y, plate.spalding(y), label="Spalding")
    right.set(xlabel="y⁺", ylabel="u⁺", xlim=(0.5, 1e4), ylim=(0, 30))
    right.legend()
    pyplot.tight_layout()
    pyplot.savefig(path, dpi=110)
    pyplot.close()


def main():
    options = arguments()
    if not loops.has_su2():
        return 0
    folder = OUT / ("short" if options.short else "loop")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    flow = folder.parent / f"{folder.name}.cfg"
    shutil.copyfile(HERE / "flow.cfg", flow)
    values = {"MESH": first(options.program, folder.parent), "FLOW": flow, "WALLS": WALL, "FOLDER": folder}
    text = loops.filled((HERE / "loop.toml").read_text(), values)
    if options.short:
        text = text.replace("max_complexity = 8000", "max_complexity = 4000")
    config = folder.parent / f"{folder.name}.toml"
    config.write_text(text)
    seconds, steps = loops.run(options.program, config, folder, "--restart")
    for step in steps:
        number = step["cycle"]
        mesh = values["MESH"] if number == 1 else folder / f"cycle-{number - 1:02}/adapt/mesh.meshb"
        result, along, profile = judged(mesh, folder / f"cycle-{number:02}/solve", step["functionals"])
        cycles.say("  ".join(f"{name} {value:.4g}" for name, value in result.items()))
    drawn(OUT / f"{folder.name}.png", along, profile)
    result |= {"seconds": seconds, "adaptation": loops.adaptation(steps)}
    (OUT / f"{folder.name}.json").write_text(json.dumps(result, indent=1))
    cycles.say(f"{seconds:.0f} s in the loop; {OUT / folder.name}.png, {folder}/report.html")
    return loops.judged(BOUNDS, result)


if __name__ == "__main__":
    sys.exit(main())
