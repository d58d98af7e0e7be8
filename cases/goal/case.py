"""Meshes for a functional, by its adjoint: advection and diffusion with a layer off the path, an extruded corner, potential flow about a sphere.

Three solvers by scikit-fem in geo-adapt cycle with a [goal]. Each prints its meshes with the error of J, the estimate and its effectivity. Exit code: 0
when every floor is held, else 1.
"""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from comparing.expected import Bound  # noqa: E402
from convergence_study.study import fitted_order  # noqa: E402
from judging import cycles, loops, meshfile  # noqa: E402

HERE = Path(__file__).resolve().parent
OUT = cycles.ROOT / "out" / "goal"
PYTHON = cycles.ROOT / ".venv/fem/bin/python"
# Complexities that orders are fitted to.
FITTED = 4
# Of J in the problem of advection, where u goes from 0 to 1.
WANTED = 1e-5
# (target, floor of today): of the whole case, and of its short form.
BOUNDS = {
    "advection": [
        Bound("vertices to 1e-5, goal / multiscale", "≤", 0.45, 0.45), Bound("least effectivity", "≥", 0.8, 0.8),
        Bound("greatest effectivity", "≤", 1.25, 1.25),
    ],
    "corner": [Bound("order", "≥", 0.6, 0.6), Bound("order, uniform", "≤", 0.5)],
    "sphere": [
        Bound("error with the estimate / π R²", "≤", 1e-3, 1e-3), Bound("error with the estimate / J", "≤", 1e-3, 5e-3),
        Bound("error / J", "≤", 1e-3), Bound("vertices", "≤", 20_000, 20_000),
    ],
}
SHORT = {"advection": 2000, "corner": 2000, "sphere": 4000}


def told(problem, expression):
    """A number of a problem, computed where scikit-fem is."""
    code = f"import json, {problem}; print(json.dumps({expression}))"
    return json.loads(subprocess.run([PYTHON, "-c", code], cwd=HERE, check=True, capture_output=True, text=True).stdout)


def loop(options, problem, truth, name=None, fields=None):
    """Runs the loop of a problem with its goal, or for the error of some fields; the last cycle of each complexity."""
    name = name or problem
    text = (HERE / f"{problem}.toml").read_text().replace("{config}/../..", str(cycles.ROOT)).replace("{config}", str(HERE))
    values = {"reference": repr(truth), "folder": f'"{OUT / name}"'}
    if options.short:
        values["max_complexity"] = SHORT[problem]
    text = loops.replaced(text, values)
    if fields:
        text = re.sub(r"(?s)\[goal\].*?\[metric\]", f"[metric]\nfields = {json.dumps(fields)}", text)
    OUT.mkdir(parents=True, exist_ok=True)
    config = OUT / f"{name}.toml"
    config.write_text(text)
    _, all_cycles = loops.run(options.program, config, OUT / name, "--restart")
    return [now for now, then in zip(all_cycles, [*all_cycles[1:], {}]) if now["complexity"] != then.get("complexity")][1:]


def table(title, rows, truth):
    """Prints meshes with the errors of J, in its own unit; (vertices, errors without sign, effectivities)."""
    cycles.say(f"{title}: J = {truth:.10g}\n  {'vertices':>9} {'J':>14} {'error':>10} {'estimate':>10} {'effectivity':>12}")
    found = []
    for row in rows:
        value, estimate = row["functionals"]["J"], row["functionals"]["J estimate"]
        error = truth - value
        found.append((row["vertices"], abs(error), estimate / error))
        cycles.say(f"  {row['vertices']:>9} {value:>14.10f} {error:>10.2e} {estimate:>10.2e} {estimate / error:>12.3f}")
    return [np.array(column) for column in zip(*found)]


def reaching(vertices, errors, wanted):
    """The number of vertices at which an error is reached for good: between two meshes on the line of their logarithms. None where it is not."""
    above = np.flatnonzero(errors > wanted)
    at = above[-1] if len(above) else 0
    if at + 1 == len(errors):
        return None
    (x, y), (u, v) = np.log((vertices[at : at + 2], errors[at : at + 2])).T
    return float(np.exp(x + (np.log(wanted) - y) / (v - y) * (u - x)))


def uniform(options, problem, truth, start, sizes):
    """The same solver on meshes of one size everywhere."""
    rows = []
    for size in sizes:
        folder = OUT / "uniform"
        folder.mkdir(parents=True, exist_ok=True)
        mesh, grid = folder / "mesh.meshb", folder / "mesh.vtu"
        for path in folder.iterdir():
            path.unlink()
        for words in (["adapt", start, "-o", mesh, "--size", size, "--quiet"], ["convert", mesh, grid, "--quiet"]):
            subprocess.run([str(word) for word in (options.program, *words)], check=True)
        subprocess.run([PYTHON, HERE / "solve.py", problem, grid, folder / "solution.vtu"], check=True, stdout=subprocess.DEVNULL)
        rows.append({"vertices": len(meshfile.read_mesh(mesh).points), "functionals": json.loads((folder / "result.json").read_text())})
    return table(f"{problem}, uniform", rows, truth)


def advection(options):
    truth = told("advection", "advection.truth()")
    of_goal = table("advection, goal", loop(options, "advection", truth), truth)
    of_field = table("advection, multiscale", loop(options, "advection", truth, "advection-multiscale", ["u"]), truth)
    goal, field = (reaching(*found[:2], WANTED) for found in (of_goal, of_field))
    if goal is None or field is None:
        sys.exit(f"an error of {WANTED} was not reached: goal {goal}, multiscale {field}")
    cycles.say(f"  {WANTED} with {goal:.0f} vertices by the goal, {field:.0f} multiscale")
    # Where the error is what is asked for.
    last = of_goal[2][of_goal[1] <= WANTED]
    return {
        "vertices to 1e-5, goal / multiscale": goal / field,
        "least effectivity": last.min(),
        "greatest effectivity": last.max(),
    }


def corner(options):
    truth = told("corner", "corner.truth()")
    code = "import json, corner; print(json.dumps([part.tolist() for part in corner.start()]))"
    points, tets, faces, refs = (
        np.array(part) for part in json.loads(subprocess.run([PYTHON, "-c", code], cwd=HERE, check=True, capture_output=True, text=True).stdout)
    )
    empty = np.zeros((0, 2), int)
    mesh = meshfile.Mesh(
        points, np.zeros(len(points), int), empty, np.zeros(0, int), faces, refs, tets, np.ones(len(tets), int), np.zeros(0, int), empty, empty, empty,
        np.zeros((0, 2)), np.zeros((0, 3)),
    )
    OUT.mkdir(parents=True, exist_ok=True)
    start = OUT / "corner.meshb"
    meshfile.write_mesh(start, mesh)
    of_goal = table("corner, goal", loop(options, "corner", truth), truth)
    plain = uniform(options, "corner", truth, start, [0.25, 0.18, 0.125, 0.09])
    return {
        "order": fitted_order(of_goal[0][-FITTED:], of_goal[1][-FITTED:]),
        "order, uniform": fitted_order(plain[0], plain[1]),
    }


def sphere(options):
    truth = told("sphere", "sphere.truth()")
    rows = loop(options, "sphere", truth)
    vertices, errors, effectivities = table("sphere, goal", rows, truth)
    left, unit = errors * np.abs(1 - effectivities), -8 * truth
    for count, error in zip(vertices, left):
        cycles.say(f"  {count:>9} vertices: J with its estimate is off by {error / unit:.2e} π R², {error / abs(truth):.2e} of itself")
    return {
        "error with the estimate / π R²": left[-1] / unit, "error with the estimate / J": left[-1] / abs(truth),
        "error / J": errors[-1] / abs(truth), "vertices": vertices[-1],
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("problems", nargs="*", metavar="PROBLEM", help=f"of {', '.join(BOUNDS)}; all without")
    parser.add_argument("--program", type=Path, default=cycles.ROOT / "target/release/geo-adapt")
    parser.add_argument("--short", action="store_true", help="coarser meshes, in two minutes")
    options = parser.parse_args()
    code = 0
    for problem in options.problems or BOUNDS:
        if problem not in BOUNDS:
            parser.error(f"{problem}: no such problem")
        figures = globals()[problem](options)
        code |= loops.judged(BOUNDS[problem], figures)
    return code


if __name__ == "__main__":
    sys.exit(main())
