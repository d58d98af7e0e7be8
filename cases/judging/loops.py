"""Loops of `geo-adapt cycle` in cases: their configurations with other values, and what they reported."""

import argparse
import json
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from . import meshfile
from .cycles import ROOT, say


def replaced(text, values):
    """A configuration with other values of some keys, each of which it has once; its paths then begin anywhere."""
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^{key} = \S+", f"{key} = {value}", text)
        if count != 1:
            sys.exit(f"the configuration has {key} {count} times")
    return text.replace('"../../', f'"{ROOT}/')


def filled(text, values):
    """A configuration with values in the places of "NAME"."""
    for name, value in values.items():
        text = text.replace(f'"{name}"', json.dumps(value if isinstance(value, (int, float)) else str(value)))
    return text


def layered(program, mesh, wall, words, turns):
    """A coarse mesh, adapted again and again to the layers along a wall that it can have; the last one. `words`: where the boundary is and how large sizes are,
    of `metric wall` and of `adapt`."""
    folder, (of_metric, of_adapt) = mesh.parent, words
    for turn in range(turns):
        sizes, made = folder / "wall.solb", folder / f"first-{turn}.meshb"
        for line in (["metric", "wall", mesh, *wall, *of_metric, "-o", sizes], ["adapt", mesh, "--metric", sizes, *of_adapt, "-o", made]):
            subprocess.run([str(word) for word in (program, *line, "-q")], check=True)
        mesh = made
    return mesh


def run(program, config, folder, *words):
    """Runs a loop; seconds, and the cycles of its report."""
    began = time.monotonic()
    if subprocess.run([str(word) for word in (program, "cycle", config, *words)], check=False).returncode != 0:
        sys.exit(f"{config}: the loop failed")
    return time.monotonic() - began, json.loads((folder / "report.json").read_text())["cycles"]


def has_su2():
    """Whether SU2 can be run; says where it is had if not."""
    found = shutil.which("SU2_CFD") is not None
    if not found:
        say("SU2_CFD is not on the PATH: nothing is run (https://su2code.github.io)")
    return found


def arguments(description, short, solvers=(), goal=None):
    """The command line of a case of a flow; `short`: what its short form is; `solvers`: between which there is a choice, the usual one first; `goal`: what the
    mesh can be made for."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/geo-adapt")
    parser.add_argument("--short", action="store_true", help=short)
    parser.add_argument("--restart", action="store_true", help="throw away what is there")
    parser.add_argument("--complexity", type=float, help="of the end (default: of loop.toml)")
    parser.add_argument("--processes", type=int, help="of the solver (default: 1)")
    if solvers:
        parser.add_argument("--solver", choices=solvers, default=solvers[0], help=f"default: {solvers[0]}")
    if goal:
        parser.add_argument("--goal", action="store_true", help=goal)
    options = parser.parse_args()
    if goal and options.goal and by_su2(options):
        parser.error("--goal needs an adjoint, which is OpenFOAM's: leave --solver su2 out")
    return options


def by_su2(options):
    """Whether a case that has a choice is to be run by SU2."""
    return getattr(options, "solver", None) == "su2"


def has_solver(options):
    """Whether the solver of a case can be run: cases/run installs all but SU2."""
    return not by_su2(options) or has_su2()


def variant(options):
    """What is added to the names of the loop's file and folder: by which solver, or for which goal."""
    return "-su2" if by_su2(options) else "-goal" if getattr(options, "goal", False) else ""


def configuration(here, options):
    """The loop of a case, as it was asked for."""
    return (here / f"loop{variant(options)}.toml").read_text()


def named(program, model, folder, names):
    """A copy of a model in a folder, with names for faces: {name: numbers}."""
    folder.mkdir(parents=True, exist_ok=True)
    copy = folder / model.name
    shutil.copyfile(model, copy)
    words = [word for name, faces in names.items() for word in ("--name", f"{name}={','.join(map(str, faces))}")]
    subprocess.run([str(word) for word in (program, "model", copy, *words)], check=True, stdout=subprocess.DEVNULL)
    return copy


def ran(options, here, out, shorter, values=()):
    """Runs loop.toml of the folder `here` (loop-su2.toml by SU2, loop-goal.toml for a goal) as these arguments say, `shorter` being the values of the short form and `values` what stands
    for names in capitals; the folder under `out` that the loop is in, and the cycles of its report."""
    folder = out / (("short" if options.short else "loop") + variant(options))
    folder.mkdir(parents=True, exist_ok=True)
    changed = {"folder": json.dumps(str(folder))} | (shorter if options.short else {})
    if options.complexity:
        changed["max_complexity"] = f"{options.complexity:g}"
    if options.processes:
        changed["processes"] = options.processes
    config = folder.with_suffix(".toml")
    config.write_text(replaced(filled(configuration(here, options), dict(values)), changed))
    return folder, run(options.program, config, folder, *(["--restart"] if options.restart or options.short else []))[1]


def last(loop, folder):
    """The last mesh of a loop, and the solution on it."""
    return folder / f"cycle-{loop[-2]['cycle']:02}/adapt/mesh.meshb", folder / f"cycle-{loop[-1]['cycle']:02}/solve/solution.solb"


def fields(solution):
    """The fields of a solution by their names, shape (n,) or (n, values)."""
    kinds, values = meshfile.read_fields(solution)
    names = json.loads(solution.with_suffix(".names.json").read_text())["fields"]
    columns = np.cumsum([0, *(meshfile.VALUES_OF_KIND[kind] for kind in kinds)])
    return {name: values[:, a:b].squeeze() for name, a, b in zip(names, columns, columns[1:], strict=False)}


def pressure(found):
    """The pressure among the fields of OpenFOAM or SU2; both have that of the free stream as their unit."""
    return found["p"] if "p" in found else found["Pressure"]


def adaptation(loop):
    """The share of metric, adaptation and transfer in the seconds of the loop without its pictures."""
    seconds = [(name, value) for step in loop for name, value in step["seconds"].items() if name != "picture"]
    return 1 - sum(value for name, value in seconds if name == "solve") / sum(value for _, value in seconds)


def judged(bounds, figures, lost=()):
    """Says each bound on the figures, and what is lost besides; the exit code."""
    for bound in bounds:
        say(f"  {bound.line(figures[bound.figure])}")
    lost = [*lost, *(bound.line(figures[bound.figure]) for bound in bounds if not bound.held(figures[bound.figure]))]
    for line in lost:
        say(f"LOST  {line}")
    return 1 if lost else 0
