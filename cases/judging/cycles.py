"""Runs an adapter several times in a row, each on the last one's output, and holds the results against a floor."""

import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from . import cube_cylinder, meshfile, metric, report

ROOT = Path(__file__).resolve().parents[2]
# Files that may be there beside the project, and are never part of it.
SHARED = Path(os.environ.get("GEO_ADAPT_SHARED", ROOT.parent / "shared")) / "cases"


@dataclass
class Floor:
    """What a field's last mesh must reach, and how many vertices it may take."""

    unit_edges: float
    ratio_least: float
    ratio_mean: float
    vertices_per_complexity: float

    def missed(self, result):
        """One line for each figure that is missed."""
        least = [(name, getattr(self, name)) for name in ("unit_edges", "ratio_least", "ratio_mean")]
        lines = [f"{name} {result[name]:.4f} < {bound}" for name, bound in least if result[name] < bound]
        most = self.vertices_per_complexity
        if result["vertices_per_complexity"] > most:
            lines.append(f"vertices_per_complexity {result['vertices_per_complexity']:.3f} > {most}")
        return lines


# Issue 2: the floor that CDT3D reached, four cycles from the UGAWG mesh of 286 vertices.
FLOORS = {
    "linear": Floor(0.985, 0.45, 0.885, 2.15),
    "polar-2": Floor(0.98, 0.40, 0.88, 2.25),
    "polar-1": Floor(0.92, 0.20, 0.77, 3.0),
}


@dataclass
class Run:
    """What a process took: exit code, CPU seconds of user and system, wall seconds, peak resident bytes."""

    code: int
    cpu_seconds: float
    wall_seconds: float
    peak_bytes: int


def measured(command, log):
    """Runs a command, its output appended to `log`; returns its Run."""
    began = time.monotonic()
    with open(log, "ab") as sink:
        sink.write((" ".join(map(str, command)) + "\n").encode())
        sink.flush()
        read, write = os.pipe()
        launch = [sys.executable, "-I", "-S", Path(__file__).with_name("launch.py"), write, *command]
        with subprocess.Popen(list(map(str, launch)), stdout=sink, stderr=subprocess.STDOUT, pass_fds=[write]) as child:
            os.close(write)
            with open(read) as figures:
                text = figures.read()
    if not text:
        raise OSError(f"{command[0]} could not be started ({log}):\n{tail(log)}")
    code, cpu, peak = json.loads(text)
    return Run(code, cpu, time.monotonic() - began, peak)


def tail(log, lines=8):
    """The last lines of a log."""
    with open(log, errors="replace") as source:
        return "".join(source.readlines()[-lines:])


def judged(path, field, start=None):
    """The judge's figures of a mesh of the cube-cylinder in an analytic field."""
    mesh = meshfile.read_mesh(path)
    result = report.figures(mesh, metric.analytic(field, mesh.points))
    more, found = cube_cylinder.judge(mesh, start)
    result |= more
    result["findings"] = result["findings"] + found
    return result


COLUMNS = f"{'code, input':<20} {'field':<8} {'vertices (per C)':>18} {'unit edges':>10} {'length':>15} {'ratio least/mean':>17} {'CPU s':>7}"


def row(name, field, result, seconds):
    """A line of the table under COLUMNS."""
    count = f"{result['vertices']} ({result['vertices_per_complexity']:.2f})"
    length = f"{result['length_least']:.3f} – {result['length_most']:.2f}"
    ratio = f"{result['ratio_least']:.3f} / {result['ratio_mean']:.3f}"
    return f"{name:<20} {field:<8} {count:>18} {100 * result['unit_edges']:>8.1f} % {length:>15} {ratio:>17} {seconds:>7.1f}"


def say(text):
    """Prints at once, so that long runs show where they are."""
    print(text, flush=True)
    sys.stdout.flush()
