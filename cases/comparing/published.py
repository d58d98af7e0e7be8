"""What other codes reached, as facts to stand beside: nothing here is run, and none of it decides anything."""

from dataclasses import dataclass

EARLIER = ("measured earlier by the same judge on a two-core Debian 12 machine, one thread; the cube-cylinder by four cycles from the "
           "UGAWG mesh of 286 vertices, refine on the .egads model, mmg3d and Omega_h without CAD, tucanos on an analytic stand-in")
UGAWG = "published by UGAWG (2017): other cycles, refine's own measure of quality"
BLAST = "published (Tsolakis 2021, spherical blast): a metric of its own from 1.9 million vertices to complexity 49 000, another machine"


@dataclass(frozen=True)
class Published:
    """One code's figures on a case, None where they are not known; shares from 0 to 1, CPU seconds, MiB."""

    case: str
    code: str
    source: str
    vertices: int | None = None
    vertices_per_complexity: float | None = None
    unit_edges: float | None = None
    length_least: float | None = None
    length_most: float | None = None
    ratio_least: float | None = None
    ratio_mean: float | None = None
    cpu_seconds: float | None = None
    peak_mib: float | None = None
    vertices_per_second: float | None = None


PUBLISHED = [
    Published("linear", "refine 3", EARLIER, 7863, 2.09, 0.992, 0.67, 1.58, 0.468, 0.901, 57),
    Published("polar-2", "refine 3", EARLIER, 9582, 2.22, 0.978, 0.39, 1.63, 0.459, 0.872, 171),
    Published("polar-1", "refine 3", EARLIER, 7596, 3.19, 0.855, 0.25, 3.42, 0.158, 0.754, 333),
    Published("linear", "mmg3d -hgrad -1", EARLIER, 7951, 2.12, 0.942, 0.10, 3.07, 0.047, 0.849, 6.7),
    Published("polar-2", "mmg3d -hgrad -1", EARLIER, 9448, 2.13, 0.921, 0.011, 2.51, 0.014, 0.828, 14.0),
    Published("polar-1", "mmg3d -hgrad -1", EARLIER, 7407, 2.97, 0.798, 0.009, 9.66, 0.004, 0.674, 20.7),
    Published("linear", "mmg3d", EARLIER, 10797, 2.87, 0.773, 0.06, 2.56, 0.069, 0.764, 12.3),
    Published("polar-2", "mmg3d", EARLIER, 28836, 6.51, 0.548, 0.009, 2.51, 0.010, 0.540, 47),
    Published("linear", "tucanos", EARLIER, 8661, 2.31, 0.934, 0.32, 3.79, 0.211, 0.867, 21),
    Published("polar-2", "tucanos", EARLIER, 10093, 2.34, 0.919, 0.34, 3.23, 0.136, 0.852, 23),
    Published("polar-1", "tucanos", EARLIER, 7914, 3.33, 0.796, 0.11, 5.26, 0.002, 0.659, 15),
    Published("polar-2", "Omega_h 9.34", EARLIER, 11132, 2.40, 0.885, 0.22, 1.96, 0.263, 0.768, 11.7),
    Published("polar-1", "Feflo.a", UGAWG, vertices=6697, ratio_least=0.006, ratio_mean=0.596),
    Published("polar-1", "Omega_h", UGAWG, vertices=10146, ratio_least=0.128, ratio_mean=0.550),
    Published("polar-1", "Pragmatic", UGAWG, vertices=6931, ratio_least=0.007, ratio_mean=0.641),
    Published("polar-1", "EPIC", UGAWG, vertices=4221, ratio_least=0.063, ratio_mean=0.591),
    Published("polar-2", "Feflo.a", UGAWG, vertices=9929, ratio_least=0.056, ratio_mean=0.735),
    Published("polar-2", "Omega_h", UGAWG, ratio_least=0.239, ratio_mean=0.697),
    Published("polar-2", "EPIC", UGAWG, ratio_least=0.218, ratio_mean=0.709),
    Published("large", "mmg3d -hgrad -1", EARLIER, vertices=175366, unit_edges=0.955, ratio_least=0.006, ratio_mean=0.849,
              cpu_seconds=43, peak_mib=494, vertices_per_second=4000),
    Published("large", "tucanos", EARLIER, vertices=216987, unit_edges=0.898, ratio_least=0.449, ratio_mean=0.844,
              cpu_seconds=211, peak_mib=666, vertices_per_second=1000),
    Published("coarsen", "Feflo.a", BLAST, ratio_least=0.2, cpu_seconds=63),
    Published("coarsen", "CDT3D", BLAST, ratio_least=0.1, cpu_seconds=152),
    Published("coarsen", "refine", BLAST, ratio_least=0.3, cpu_seconds=62575),
]


def beside(case):
    """The figures of other codes on a case."""
    return [row for row in PUBLISHED if row.case == case]
