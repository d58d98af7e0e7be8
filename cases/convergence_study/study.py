"""The loop of the study: a scalar at the vertices, its multiscale metric, the mesh adapted to it, the error; again, and finer.

The error is measured twice: against the exact function, by a quadrature that resolves what is within a tetrahedron, and, as in the dissertation
(and as the benchmark's `ref_interp_test` does), against the interpolant on the finest mesh that was made.
"""

import json
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from comparing.uniform import uniform_cube
from judging import cycles, meshfile

from .quadrature import interpolation_error

# Vertices along an edge of the first mesh: 64 vertices, as in the dissertation.
START = 4
# The first complexity; each further one is twice as much.
FIRST = 1000
# Of the cycles at a complexity the last ones that count: in the first the mesh still follows the metric of a coarser one.
COUNTED = 3
# Complexities that the order is fitted to.
FITTED = 3
# Cycles at each complexity beyond the last, up to that of the finest mesh.
BEYOND = 3


@dataclass
class Cycle:
    """An adaptation and the error on its mesh; `doubt` is what the quadrature may be off by, as a part of the error."""

    complexity: float
    mesh: str
    vertices: int
    tets: int
    error: float
    doubt: float
    adapt_seconds: float
    adapt_cpu_seconds: float
    # Against the interpolant on the finest mesh.
    finest_error: float | None = None


@dataclass
class Step:
    """A complexity: geometric means of its last cycles, and a uniform mesh of as many vertices."""

    complexity: float
    vertices: float
    error: float
    uniform_vertices: int
    uniform_error: float
    # Both against the interpolant on the finest mesh.
    finest_error: float | None = None
    uniform_finest_error: float | None = None


def complexities(most):
    """FIRST, twice as much, ..., up to `most`, which is the last."""
    found = [float(most)]
    while found[0] > FIRST:
        found.insert(0, found[0] / 2)
    return found


class Study:
    """One scalar from the first mesh to the finest; files go to `place`."""

    def __init__(self, name, scalar, program, place, extra=()):
        self.name, self.scalar, self.program, self.place, self.extra = name, scalar, program, Path(place), extra
        self.mesh, self.cycles, self.steps = uniform_cube(START), [], []
        self.place.mkdir(parents=True, exist_ok=True)
        self.seconds = 0.0

    def run(self, complexity, count):
        """`count` cycles at a complexity; returns its Step."""
        began = time.monotonic()
        done = []
        for number in range(1, count + 1):
            mesh, ran = self._adapt(complexity, number)
            error, doubt = interpolation_error(self.mesh.points, self.mesh.tets, self.scalar)
            done.append(Cycle(complexity, mesh, len(self.mesh.points), len(self.mesh.tets), error, doubt, ran.wall_seconds, ran.cpu_seconds))
        self.cycles += done
        vertices, error = (_mean(done, name) for name in ("vertices", "error"))
        self.steps.append(Step(complexity, vertices, error, *uniform_error(self.scalar, vertices)))
        self.seconds += time.monotonic() - began
        return self.steps[-1]

    def measure_against(self, finest):
        """Goes on to a mesh of the complexity `finest`, and measures all cycles that count against the interpolant there."""
        began = time.monotonic()
        for complexity in beyond(self.steps[-1].complexity, finest):
            for number in range(1, BEYOND + 1):
                mesh, _ = self._adapt(complexity, number)
        truth = self._write(self.mesh, mesh)
        for step in self.steps:
            counted = [cycle for cycle in self.cycles if cycle.complexity == step.complexity][-COUNTED:]
            for cycle in counted:
                cycle.finest_error = self._against(truth, meshfile.read_mesh(self.place / cycle.mesh), cycle.mesh)
            step.finest_error = _mean(counted, "finest_error")
            uniform = uniform_cube(round(step.uniform_vertices ** (1 / 3)))
            step.uniform_finest_error = self._against(truth, uniform, "uniform.meshb")
        self.seconds += time.monotonic() - began

    def _write(self, mesh, name):
        """A mesh and the scalar at its vertices; returns the two files."""
        paths = [self.place / name, (self.place / name).with_suffix(".solb")]
        meshfile.write_mesh(paths[0], mesh)
        meshfile.write_scalars(paths[1], self.scalar(mesh.points)[:, None])
        return paths

    def _ran(self, command, log, what):
        ran = cycles.measured([self.program, *command, "--quiet"], log)
        if ran.code != 0:
            raise RuntimeError(f"{self.name}, {what}: geo-adapt ended with {ran.code} ({log}):\n{cycles.tail(log)}")
        return ran

    def _against(self, truth, mesh, name):
        """The error of the interpolant on a mesh against that on the finest."""
        report = self.place / "error.json"
        self._ran(["field", "error", *self._write(mesh, name), "--truth", *truth, "--report", report], self.place / "error.log", name)
        return json.loads(report.read_text())["values"][0]["norm"]

    def _adapt(self, complexity, number):
        """The mesh adapted once more: the name of its file, and how the program ran."""
        name, log = f"{complexity:.0f}-{number}.meshb", self.place / "adapt.log"
        new = self.place / name
        old, field = self._write(self.mesh, "in.meshb")
        command = ["adapt", old, "--field", field, "--complexity", complexity, "--norm", 2, "-o", new, "--report", new.with_suffix(".json")]
        ran = self._ran([*command, *self.extra], log, f"at {complexity:g}")
        self.mesh = meshfile.read_mesh(new)
        return name, ran

    def order(self, which="error"):
        """The order p of error ∝ N^-p over the last complexities, or None when there are too few or they were not measured."""
        last = self.steps[-FITTED:]
        errors = [getattr(step, which) for step in last]
        if len(last) < FITTED or None in errors:
            return None
        return fitted_order([step.vertices for step in last], errors)

    def result(self):
        """What is written as JSON."""
        return {"order": self.order(), "finest_order": self.order("finest_error"), "seconds": self.seconds,
                "doubt": max(cycle.doubt for cycle in self.cycles),
                "steps": [asdict(step) for step in self.steps], "cycles": [asdict(cycle) for cycle in self.cycles]}


def beyond(last, finest):
    """Complexities after the last, each twice as much, up to the finest."""
    found = []
    while last < finest:
        last = min(2 * last, finest)
        found.append(last)
    return found


def _mean(done, name):
    """Geometric mean over the last cycles."""
    return float(np.exp(np.mean(np.log([getattr(cycle, name) for cycle in done[-COUNTED:]]))))


def fitted_order(vertices, errors):
    """p of the least-squares line ln error = c - p ln N."""
    return float(-np.polyfit(np.log(vertices), np.log(errors), 1)[0])


def uniform_error(scalar, vertices):
    """Vertices and error of the uniform mesh whose vertices are nearest to so many."""
    mesh = uniform_cube(max(2, round(vertices ** (1 / 3))))
    error, _ = interpolation_error(mesh.points, mesh.tets, scalar)
    return len(mesh.points), error
