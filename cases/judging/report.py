"""The figures of a mesh in a metric, and their printing."""

import numpy as np

from . import metric as formulas
from .validity import findings

LENGTH_BINS = [0, 0.1, 0.3, 0.5, np.sqrt(0.5), 0.9, 1.111, np.sqrt(2), 2, 3, np.inf]
RATIO_BINS = [-np.inf, 0, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0000001]


def figures(mesh, metric):
    """Validity, counts, and what the metric says of edges and shapes; ready for JSON."""
    lengths = formulas.edge_lengths(mesh.points, formulas.unique_edges(mesh.tets), metric)
    ratios = formulas.mean_ratios(mesh.points, mesh.tets, metric)
    complexity = formulas.complexity(mesh.points, mesh.tets, metric)
    unit = (lengths >= formulas.UNIT[0]) & (lengths <= formulas.UNIT[1])
    return counts(mesh) | {
        "complexity": complexity,
        "vertices_per_complexity": len(mesh.points) / complexity,
        "unit_edges": float(unit.mean()),
        "length_least": float(lengths.min()),
        "length_most": float(lengths.max()),
        "ratio_least": float(ratios.min()),
        "ratio_mean": float(ratios.mean()),
        "length_histogram": _histogram(lengths, LENGTH_BINS),
        "ratio_histogram": _histogram(ratios, RATIO_BINS),
    }


def counts(mesh):
    """Validity and counts, which need no metric."""
    return {
        "findings": findings(mesh),
        "vertices": len(mesh.points),
        "tetrahedra": len(mesh.tets),
        "triangles": len(mesh.triangles),
        "edges": len(mesh.edges),
        "triangle_references": np.unique(mesh.triangle_refs).tolist(),
        "edge_references": np.unique(mesh.edge_refs).tolist(),
        "regions": np.unique(mesh.tet_refs).tolist(),
    }


def _histogram(values, bins):
    count, _ = np.histogram(values, bins)
    return [[_bound(a), _bound(b), int(n)] for a, b, n in zip(bins[:-1], bins[1:], count)]


def _bound(value):
    return None if np.isinf(value) else round(float(value), 4)


def show(result):
    """Prints a result of `figures` or `counts` for people."""
    print(f"vertices {result['vertices']}, tetrahedra {result['tetrahedra']}, triangles {result['triangles']} "
          f"(references {_short(result['triangle_references'])}), tagged edges {result['edges']} "
          f"(references {_short(result['edge_references'])}), regions {result['regions']}")
    if "complexity" in result:
        print(f"complexity {result['complexity']:.1f}, vertices per complexity {result['vertices_per_complexity']:.3f}")
        print(f"unit edges {100 * result['unit_edges']:.2f} %, length {result['length_least']:.4f} to {result['length_most']:.4f}")
        print(f"mean ratio: least {result['ratio_least']:.4f}, mean {result['ratio_mean']:.4f}")
        for name in ("length", "ratio"):
            _show_histogram(name, result[f"{name}_histogram"])
    if "farthest_from_entity" in result:
        print(f"farthest boundary vertex from its own entity {result['farthest_from_entity']:.3g}, volume "
              f"{result['volume']:.6f} (off by {result['volume_error']:+.2e}), least cosine of normals {result['least_normal_cosine']:.5f}")
    print("valid" if not result["findings"] else "NOT VALID:")
    for finding in result["findings"]:
        print(f"  {finding}")


def _short(values):
    return f"{values[0]}..{values[-1]}, {len(values)} of them" if len(values) > 16 else values


def _show_histogram(name, rows):
    total = max(sum(n for *_, n in rows), 1)
    print(f"{name}:")
    for low, high, n in rows:
        if n:
            bounds = f"{'' if low is None else low:>8} – {'' if high is None else high:<8}"
            print(f"  {bounds} {n:>9} {100 * n / total:6.2f} % {'#' * round(50 * n / total)}")
