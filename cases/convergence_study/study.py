"""The loop of the study: a scalar at the vertices, its multiscale metric, the mesh adapted to it, the error; again, and finer."""

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


@dataclass
class Cycle:
    """An adaptation and the error on its mesh; `doubt` is what the quadrature may be off by, as a part of the error."""

    complexity: float
    vertices: int
    tets: int
    error: float
    doubt: float
    adapt_seconds: float
    adapt_cpu_seconds: float


@dataclass
class Step:
    """A complexity: geometric means of its last cycles, and a uniform mesh of as many vertices."""

    complexity: float
    vertices: float
    error: float
    uniform_vertices: int
    uniform_error: float


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
        done = [self._cycle(complexity) for _ in range(count)]
        self.cycles += done
        last = done[-COUNTED:]
        vertices, error = (float(np.exp(np.mean(np.log([getattr(cycle, name) for cycle in last])))) for name in ("vertices", "error"))
        self.steps.append(Step(complexity, vertices, error, *uniform_error(self.scalar, vertices)))
        self.seconds += time.monotonic() - began
        return self.steps[-1]

    def _cycle(self, complexity):
        old, field, log = (self.place / name for name in ("in.meshb", "in.solb", "adapt.log"))
        new, report = (self.place / f"{complexity:.0f}.{end}" for end in ("meshb", "json"))
        meshfile.write_mesh(old, self.mesh)
        meshfile.write_scalars(field, self.scalar(self.mesh.points)[:, None])
        ran = cycles.measured([self.program, "adapt", old, "--field", field, "--complexity", complexity, "--norm", 2, "-o", new,
                               "--report", report, "--quiet", *self.extra], log)
        if ran.code != 0:
            raise RuntimeError(f"{self.name} at {complexity:g}: geo-adapt ended with {ran.code} ({log}):\n{cycles.tail(log)}")
        self.mesh = meshfile.read_mesh(new)
        error, doubt = interpolation_error(self.mesh.points, self.mesh.tets, self.scalar)
        return Cycle(complexity, len(self.mesh.points), len(self.mesh.tets), error, doubt, ran.wall_seconds, ran.cpu_seconds)

    def order(self):
        """The order p of error ∝ N^-p over the last complexities, or None when there are too few."""
        if len(self.steps) < FITTED:
            return None
        last = self.steps[-FITTED:]
        return fitted_order([step.vertices for step in last], [step.error for step in last])

    def result(self):
        """What is written as JSON."""
        return {"order": self.order(), "seconds": self.seconds, "doubt": max(cycle.doubt for cycle in self.cycles),
                "steps": [asdict(step) for step in self.steps], "cycles": [asdict(cycle) for cycle in self.cycles]}


def fitted_order(vertices, errors):
    """p of the least-squares line ln error = c - p ln N."""
    return float(-np.polyfit(np.log(vertices), np.log(errors), 1)[0])


def uniform_error(scalar, vertices):
    """Vertices and error of the uniform mesh whose vertices are nearest to so many."""
    mesh = uniform_cube(max(2, round(vertices ** (1 / 3))))
    error, _ = interpolation_error(mesh.points, mesh.tets, scalar)
    return len(mesh.points), error
