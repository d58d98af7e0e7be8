"""What is compared: each case's geometry, field, complexity and input."""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from judging import cube, cube_cylinder, cycles, meshfile

from .adapters import Task
from .uniform import uniform_cube

OUT = cycles.ROOT / "out" / "compare"
CUBE_CYLINDER = cycles.ROOT / "geometry" / "cube-cylinder.step"
OWN_START = cycles.ROOT / "cases" / "cube-cylinder" / "start.meshb"
CUBE = cycles.ROOT / "geometry" / "cube.step"


@dataclass(frozen=True)
class Case:
    """One line of the comparison."""

    name: str
    summary: str
    field: str
    # (start mesh, CAD model), from our own adapter where it has to make the mesh
    start: Callable
    judge: Callable
    cycles: int = 4
    complexity: float | None = None
    # the program does not know the field: it takes it from a file, as mmg3d always does
    from_file: bool = False
    rivals: bool = True


def ugawg_or_own(_):
    """The UGAWG start mesh of the cube-cylinder (286 vertices), or the project's own (309)."""
    shared = cycles.SHARED / "cube-cylinder"
    if (shared / "cube-cylinder.meshb").is_file():
        return shared / "cube-cylinder.meshb", shared / "cube-cylinder.step"
    cycles.say(f"the UGAWG files are not at {shared} (GEO_ADAPT_SHARED names their place): own start mesh")
    return OWN_START, CUBE_CYLINDER


def coarse_cube(_):
    """The cube of 64 vertices: UGAWG's, or the same grid by our generator. Its model is our own STEP file."""
    shared = cycles.SHARED / "cube" / "cube-linear-00.meshb"
    if shared.is_file():
        return shared, CUBE
    cycles.say(f"{shared} is not there: the same grid by comparing/uniform.py")
    return _written("cube-64.meshb", 4), CUBE


def uniform(_):
    """The cube of 124³ = 1 906 624 vertices."""
    return _written("cube-uniform.meshb", 124), CUBE


def _written(name, count):
    path = OUT / name
    if not path.is_file():
        meshfile.write_mesh(path, uniform_cube(count))
    return path


@functools.cache
def natural(ours):
    """Our own mesh of polar-2 at its natural complexity (4 322): four cycles from the project's start mesh."""
    # cases/threads comes here first of all.
    OUT.mkdir(parents=True, exist_ok=True)
    current, log = OWN_START, OUT / "natural.log"
    log.unlink(missing_ok=True)
    for cycle in range(1, 5):
        target = OUT / f"natural-{cycle}.meshb"
        target.unlink(missing_ok=True)
        ran = cycles.measured(ours.command(Task(current, target, CUBE_CYLINDER, "polar-2", None, Path())), log)
        if ran.code != 0:
            raise RuntimeError(f"the natural mesh of polar-2: geo-adapt ended with {ran.code} ({log}):\n{cycles.tail(log)}")
        current = target
    return current, CUBE_CYLINDER


def _large(name, complexity):
    thousands = f"{complexity:,}".replace(",", " ")
    summary = f"cube-cylinder, polar-2 at complexity {thousands}, one run from our mesh of its natural complexity"
    return Case(name, summary, "polar-2", natural, cube_cylinder.judge, cycles=1, complexity=complexity)


CASES = {case.name: case for case in [
    Case("linear", "cube-cylinder, a layer at z = 0.5", "linear", ugawg_or_own, cube_cylinder.judge),
    Case("polar-2", "cube-cylinder, a layer on the wall and finer around it", "polar-2", ugawg_or_own, cube_cylinder.judge),
    Case("polar-1", "cube-cylinder, a layer on the wall", "polar-1", ugawg_or_own, cube_cylinder.judge),
    Case("cube-linear", "cube from 64 vertices, a layer at z = 0.5", "linear", coarse_cube, cube.judge),
    Case("ten-cycles", "cube-cylinder, polar-2 ten times in a row: no drift", "polar-2", ugawg_or_own, cube_cylinder.judge,
         cycles=10, rivals=False),
    _large("large-25k", 25_000),
    _large("large", 100_000),
    _large("large-400k", 400_000),
    Case("coarsen", "uniform cube of 1.9 million vertices onto a spherical front at complexity 49 000", "front", uniform, cube.judge,
         cycles=1, complexity=49_000, from_file=True),
]}
