"""The delta wing of the UGAWG: from 143 vertices, without an association in the file, to a conical layer on the wing, complexity 50 000.

The start mesh is put on our own model (geometry/zoo/delta-wing-domain.step). The field is known by a formula (cone.py), written at the
vertices before each run and scaled to the complexity there; the judge evaluates it, scaled on the mesh it judges.
Exit code: 0 when every floor is held, 1 when one is lost; 0 where the shared files are not there.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import cone  # noqa: E402
from judging import cycles, meshfile, metric, on_cad  # noqa: E402

COMPLEXITY, RUNS = 50_000, 6
# (target, floor of today)
BOUNDS = on_cad.quality((0.97, 0.99), (0.25, 0.40), (0.82, 0.89))


def field(_, mesh, __):
    """The layer scaled to the complexity on the mesh itself: within a few runs it no longer changes."""
    values = cone.metric(mesh.points)
    return metric.scale_to(values, metric.complexity(mesh.points, mesh.tets, values), COMPLEXITY)


def main():
    options = on_cad.arguments(__doc__, RUNS)
    (start,) = on_cad.shared("delta-wing", "delta01.meshb")
    model = cycles.ROOT / "geometry/zoo/delta-wing-domain.step"
    case = on_cad.Case("delta-wing", start, model, field, BOUNDS, RUNS)
    case.folder.mkdir(parents=True, exist_ok=True)
    case.mesh = case.folder / "classified.meshb"
    cycles.say(on_cad.tool(options.program, "classify", start, "--cad", model, "-o", case.mesh))
    return on_cad.run(case, options)


if __name__ == "__main__":
    sys.exit(main())
