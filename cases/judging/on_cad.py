"""Adapts a mesh on a CAD model to a metric, cycle by cycle, judges each mesh, and holds the last against bounds.

For the cases whose metric is known on a mesh or by a formula. The mesh and the figures are judged here; the distance from the
model, which needs a CAD kernel, is the one that `geo-adapt inspect --cad` measures from the file.
"""

import argparse
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from comparing.expected import Bound

from . import cycles, meshfile, metric, report

# Model units over the diagonal of the model's box (issue 6: on the CAD).
ON_CAD = 1e-7


@dataclass
class Case:
    """A start mesh with its model and the metric's values on any mesh of the domain."""

    name: str
    mesh: Path
    model: Path
    # (path of a mesh, the mesh, folder for files) → metric at its vertices, shape (n, 3, 3)
    field: object
    bounds: list
    cycles: int

    @property
    def folder(self):
        """Where everything of the case lies."""
        return cycles.ROOT / "out" / self.name


def quality(unit_edges, least, mean):
    """Bounds on the usual three, each (target, floor of today)."""
    return [Bound("unit_edges", "≥", *unit_edges), Bound("ratio_least", "≥", *least), Bound("ratio_mean", "≥", *mean)]


def arguments(doc, count, first=None):
    """The command line that all these cases have; with a first height of layers where one is given."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    program = cycles.ROOT / "target/release/geo-adapt"
    parser.add_argument("--program", type=Path, default=program, help="the built program (default %(default)s)")
    parser.add_argument("--cycles", type=int, default=count, help="runs in a row (default %(default)s); floors hold for the default")
    parser.add_argument("--threads", type=int, default=0, help="default: all cores")
    if first is not None:
        parser.add_argument("--first", type=float, default=first, help="first height of the layers (default %(default)s, for which the floors hold)")
    options = parser.parse_args()
    if not options.program.is_file():
        sys.exit(f"{options.program} is not there: cargo build --release, or cases/run, which does it")
    if options.cycles < 1:
        parser.error("--cycles: at least 1")
    return options


def shared(folder, *names):
    """The files ../shared/cases/FOLDER/NAME; ends the case with exit code 0 where one is not there."""
    paths = [cycles.SHARED / folder / name for name in names]
    for path in paths:
        if not path.is_file():
            cycles.say(f"not run: {path} is not there (GEO_ADAPT_SHARED names the place of the shared files)")
            sys.exit(0)
    return paths


def tool(program, *words):
    """Runs a subcommand of the program; returns what it prints, or ends with its message."""
    ran = subprocess.run([str(program), *map(str, words)], capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        sys.exit(f"geo-adapt {' '.join(map(str, words))}\nended with {ran.returncode}: {ran.stderr.strip()}")
    return ran.stdout


def interpolated(program, mesh, sizes):
    """The field of a Case: the metric `sizes`, known at the vertices of `mesh`, brought to another mesh by the program."""

    def field(path, _, folder):
        if path == mesh:
            return meshfile.read_metric(sizes)
        target = folder / f"{path.stem}-wanted.solb"
        tool(program, "metric", "interpolate", mesh, sizes, path, "-o", target, "-q")
        return meshfile.read_metric(target)

    return field


def run(case, options):
    """All cycles, the table, the bounds; the exit code."""
    case.folder.mkdir(parents=True, exist_ok=True)
    diagonal = json.loads(tool(options.program, "model", case.model, "--json"))["diagonal"]
    log = case.folder / "adapt.log"
    log.unlink(missing_ok=True)
    current, start, wrong, figures = case.mesh, meshfile.read_mesh(case.mesh), [], {}
    mesh = start
    cycles.say(cycles.COLUMNS)
    for number in range(1, options.cycles + 1):
        target, sizes = case.folder / f"{number}.meshb", case.folder / f"{number}-in.solb"
        meshfile.write_metric(sizes, case.field(current, mesh, case.folder))
        target.unlink(missing_ok=True)
        command = [options.program, "adapt", current, "-o", target, "--cad", case.model, "--metric", sizes]
        command += ["--report", target.with_suffix(".json")] + (["--threads", options.threads] if options.threads else [])
        ran = cycles.measured(command, log)
        if ran.code != 0:
            cycles.say(f"LOST  cycle {number}: geo-adapt ended with {ran.code} ({log}):\n{cycles.tail(log)}")
            return 1
        current, mesh = target, meshfile.read_mesh(target)
        values = case.field(current, mesh, case.folder)
        figures = report.figures(mesh, values) | _on_model(options.program, current, case.model, diagonal)
        figures |= _share_of_geometry(target.with_suffix(".json")) | {"cpu_seconds": ran.cpu_seconds, "wall_seconds": ran.wall_seconds}
        wrong += [f"cycle {number}: {finding}" for finding in figures["findings"] + _lost(start, mesh, figures)]
        cycles.say(cycles.row(f"geo-adapt, cycle {number}", "", figures, ran.cpu_seconds))
        _show_worst(mesh, values)
    (case.folder / "result.json").write_text(json.dumps(figures, indent=1))
    lost = wrong
    for bound in case.bounds:
        value = figures.get(bound.figure)
        cycles.say(f"  {bound.line(value)}")
        if value is not None and not bound.held(value):
            lost.append(bound.line(value))
    cycles.say(f"  farthest vertex from its entity {figures['off_model']:.2g} of the model's diagonal")
    cycles.say(f"meshes, reports and logs: {case.folder}")
    for line in lost:
        cycles.say(f"LOST  {line}")
    return 1 if lost else 0


def _on_model(program, mesh, model, diagonal):
    """The farthest vertex from its entity, over the diagonal."""
    seen = json.loads(tool(program, "inspect", mesh, "--cad", model, "--json"))["cad"]
    return {"off_model": seen["from_entity"]["distance"] / diagonal}


def _share_of_geometry(path):
    """The share of the adaptation that went into the geometry; thread seconds by the clock, both of them."""
    made = json.loads(path.read_text())
    return {"geometry_share": made["seconds"]["geometry"] / (made["seconds"]["adapt"] * made["threads"])}


def _lost(start, mesh, figures):
    """What the start mesh had and this one has not; vertices off the model."""
    found = []
    for name in ("triangle_refs", "tet_refs"):
        before, after = (set(np.unique(getattr(which, name)).tolist()) for which in (start, mesh))
        if before - after:
            found.append(f"{name} {sorted(before - after)} of the start mesh are not there any more")
    if figures["off_model"] > ON_CAD:
        found.append(f"a vertex lies {figures['off_model']:.3g} of the diagonal off the model")
    return found


def _show_worst(mesh, values, listed=5):
    """Where the worst tetrahedra are."""
    ratios = metric.mean_ratios(mesh.points, mesh.tets, values)
    on_boundary = np.zeros(len(mesh.points), bool)
    on_boundary[mesh.triangles.ravel()] = True
    for tet in np.argsort(ratios)[:listed]:
        at = mesh.points[mesh.tets[tet]].mean(0)
        count = int(on_boundary[mesh.tets[tet]].sum())
        cycles.say(f"    {ratios[tet]:.4f} at ({at[0]:.6f}, {at[1]:.6f}, {at[2]:.6f}), {count} vertices on the model")
