"""Loops of `geo-adapt cycle` in cases: their configurations with other values, and what they reported."""

import argparse
import json
import re
import subprocess
import sys
import time
from pathlib import Path

from .cycles import ROOT, say


def replaced(text, values):
    """A configuration with other values of some keys, each of which it has once; its paths then begin anywhere."""
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^{key} = \S+", f"{key} = {value}", text)
        if count != 1:
            sys.exit(f"the configuration has {key} {count} times")
    return text.replace('"../../', f'"{ROOT}/')


def run(program, config, folder, *words):
    """Runs a loop; seconds, and the cycles of its report."""
    began = time.monotonic()
    if subprocess.run([str(word) for word in (program, "cycle", config, *words)], check=False).returncode != 0:
        sys.exit(f"{config}: the loop failed")
    return time.monotonic() - began, json.loads((folder / "report.json").read_text())["cycles"]


def arguments(description, short):
    """The command line of a case of a flow; `short`: what its short form is."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/geo-adapt")
    parser.add_argument("--short", action="store_true", help=short)
    parser.add_argument("--restart", action="store_true", help="throw away what is there")
    parser.add_argument("--complexity", type=float, help="of the end (default: of loop.toml)")
    parser.add_argument("--processes", type=int, help="of the solver (default: 1)")
    return parser.parse_args()


def ran(options, here, out, shorter):
    """Runs loop.toml of the folder `here` as these arguments say, `shorter` being the values of the short form; the folder under `out` that the loop
    is in, and the cycles of its report."""
    folder = out / ("short" if options.short else "loop")
    folder.mkdir(parents=True, exist_ok=True)
    changed = dict(shorter) if options.short else {}
    if options.complexity:
        changed["max_complexity"] = f"{options.complexity:g}"
    if options.processes:
        changed["processes"] = options.processes
    config = folder.with_suffix(".toml")
    config.write_text(replaced((here / "loop.toml").read_text(), changed))
    return folder, run(options.program, config, folder, *(["--restart"] if options.restart or options.short else []))[1]


def last(loop, folder):
    """The last mesh of a loop, and the solution on it."""
    return folder / f"cycle-{loop[-2]['cycle']:02}/adapt/mesh.meshb", folder / f"cycle-{loop[-1]['cycle']:02}/solve/solution.solb"


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
