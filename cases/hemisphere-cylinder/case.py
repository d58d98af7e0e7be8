"""The hemisphere-cylinder of the UGAWG: a metric from a flow, scaled to complexity 60 000, on spheres with poles, a cylinder and planes.

Two runs, each with the metric of the shared mesh interpolated on the mesh it starts from; judged with the same, interpolated on the result.
Exit code: 0 when every floor is held, 1 when one is lost; 0 where the shared files are not there.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from comparing.expected import Bound  # noqa: E402
from judging import on_cad  # noqa: E402

COMPLEXITY = 60_000
# (target, floor of today)
BOUNDS = [*on_cad.quality((0.97, 0.99), (0.25, 0.50), (0.82, 0.89)), Bound("geometry_share", "≤", 0.25, 0.25)]


def main():
    options = on_cad.arguments(__doc__, 2)
    names = ("hsc-gmsh-26-adapt.meshb", "hsc-gmsh-26-adapt-metric.solb", "hemisph-cyl.stp")
    mesh, sizes, model = on_cad.shared("hemisphere-cylinder", *names)
    case = on_cad.Case("hemisphere-cylinder", mesh, model, None, BOUNDS, 2)
    case.folder.mkdir(parents=True, exist_ok=True)
    scaled = case.folder / "scaled.solb"
    on_cad.tool(options.program, "metric", "scale", mesh, sizes, "--complexity", COMPLEXITY, "-o", scaled, "-q")
    case.field = on_cad.interpolated(options.program, mesh, scaled)
    return on_cad.run(case, options)


if __name__ == "__main__":
    sys.exit(main())
