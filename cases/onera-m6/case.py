"""The ONERA M6 wing of the UGAWG: a metric from a flow, its complexity 86 500, on B-splines with slivers beside them.

Two runs, each with the metric of the shared mesh interpolated on the mesh it starts from; judged with the same, interpolated on the result.
Exit code: 0 when every floor is held, 1 when one is lost; 0 where the shared files are not there.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from judging import on_cad  # noqa: E402

# (target, floor of today)
BOUNDS = on_cad.quality((0.98, 0.98), (0.20, 0.25), (0.80, 0.87))


def main():
    options = on_cad.arguments(__doc__, 2)
    mesh, sizes, model = on_cad.shared("onera-m6", "onera_curvAdapt.meshb", "onera_curvAdapt-metric.solb", "onera-m6-sharp-te.stp")
    field = on_cad.interpolated(options.program, mesh, sizes)
    return on_cad.run(on_cad.Case("onera-m6", mesh, model, field, BOUNDS, 2), options)


if __name__ == "__main__":
    sys.exit(main())
