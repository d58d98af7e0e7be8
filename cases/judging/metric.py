"""The formulas of METHOD.md §1 on arrays: analytic fields, edge lengths, mean ratio, complexity."""

import numpy as np

H0 = 0.001
UNIT = (np.sqrt(0.5), np.sqrt(2.0))
FIELDS = ("linear", "polar-1", "polar-2", "front")


def analytic(name, points):
    """A field at `points`, shape (n, 3); returns (n, 3, 3). `front` is ours, the others are UGAWG's on the cube-cylinder."""
    if name == "front":
        return front(points)
    x, y, z = points.T
    if name == "linear":
        sizes = np.stack([np.full_like(x, 0.1), np.full_like(x, 0.1), H0 + 2 * (0.1 - H0) * np.abs(z - 0.5)], 1)
        return np.einsum("ni,ij->nij", sizes**-2, np.eye(3))
    r, angle = np.hypot(x, y), np.arctan2(y, x)
    along_r = H0 + 2 * (0.1 - H0) * np.abs(r - 0.5)
    d = 10 * (0.6 - r)
    around = {"polar-1": np.full_like(r, 0.1), "polar-2": np.where(d < 0, 0.1, d / 40 + 0.1 * (1 - d))}[name]
    cos, sin, zero = np.cos(angle), np.sin(angle), np.zeros_like(r)
    frame = np.stack([np.stack([cos, sin, zero], 1), np.stack([-sin, cos, zero], 1),
                      np.stack([zero, zero, zero + 1], 1)], 1)
    sizes = np.stack([along_r, around, np.full_like(r, 0.1)], 1)
    turned = np.einsum("nki,nk,nkj->nij", frame, sizes**-2, frame)
    return (turned + turned.transpose(0, 2, 1)) / 2  # rounding leaves the halves apart


def front(points, thickness=0.01):
    """A spherical front of radius 0.5 about the corner at the origin of the unit cube; returns (n, 3, 3).

    Like UGAWG's layers: along the radius h = h0 + 2(0.1 − h0)|r − 0.5| with h0 the thickness, across it 0.1. That suits
    the curvature: an edge of length t on the sphere of radius r departs from it by t²/8r, at the front h0/4, and nowhere by more than h
    (towards the corner h and 0.1 become the same, so that the field has no singularity there).
    """
    r = np.linalg.norm(points, axis=1)
    along = thickness + 2 * (0.1 - thickness) * np.abs(r - 0.5)
    normal = points / np.maximum(r, 1e-300)[:, None]
    return 100 * np.eye(3) + (along**-2 - 100)[:, None, None] * np.einsum("ni,nj->nij", normal, normal)


def logarithm(matrices):
    """ln M by the spectral map; raises where a metric is not positive definite."""
    values, vectors = np.linalg.eigh(matrices)
    if not (values > 0).all():
        raise ValueError(f"the metric at vertex {int(np.argmin(values.min(1))) + 1} is not positive definite")
    return np.einsum("nik,nk,njk->nij", vectors, np.log(values), vectors)


def exponential(matrices):
    """exp by the spectral map."""
    values, vectors = np.linalg.eigh(matrices)
    return np.einsum("nik,nk,njk->nij", vectors, np.exp(values), vectors)


def volumes(points, tets):
    """Signed volumes."""
    a, b, c, d = (points[tets[:, i]] for i in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def complexity(points, tets, metric):
    """C = Σ_v √det(M_v)·V_v, V_v a quarter of the volume of the tets at v."""
    share = np.zeros(len(points))
    quarter = volumes(points, tets) / 4
    for corner in tets.T:
        share += np.bincount(corner, weights=quarter, minlength=len(points))
    return float((np.sqrt(np.linalg.det(metric)) * share).sum())


def scale_to(metric, current, target):
    """M ← (C_target/C)^(2/3) M."""
    return metric * (target / current) ** (2 / 3)


def row_keys(rows, limit):
    """One integer a row of vertices (all below `limit`), equal for equal rows: sorting these is many times faster than rows."""
    key, bound = rows[:, 0].astype(np.int64), limit
    for column in rows.T[1:]:
        if bound > np.iinfo(np.int64).max // limit:
            _, key = np.unique(key, return_inverse=True)
            bound = len(key)
        key, bound = key * limit + column, bound * limit
    return key


def unique_edges(tets):
    """All edges of the tets, each once, shape (n, 2)."""
    pairs = np.concatenate([tets[:, [i, j]] for i in range(4) for j in range(i + 1, 4)])
    limit = int(tets.max(initial=0)) + 1
    return np.stack(np.divmod(np.unique(row_keys(np.sort(pairs, axis=1), limit)), limit), axis=1)


def _in_blocks(function, rows, block=1 << 19):
    """`function` of the rows, some at a time, so that meshes of millions of tets need no tens of gigabytes."""
    return np.concatenate([function(rows[at : at + block]) for at in range(0, max(len(rows), 1), block)])


def edge_lengths(points, edges, metric):
    """The log law: (L_a − L_b)/ln(L_a/L_b), their mean where they differ by no more than 1e-3."""

    def lengths(some):
        a, b = some.T
        v = points[b] - points[a]
        at_a = np.sqrt(np.einsum("ni,nij,nj->n", v, metric[a], v))
        at_b = np.sqrt(np.einsum("ni,nij,nj->n", v, metric[b], v))
        apart = np.abs(at_a - at_b) > 1e-3
        found = (at_a + at_b) / 2
        found[apart] = (at_a[apart] - at_b[apart]) / np.log(at_a[apart] / at_b[apart])
        return found

    return _in_blocks(lengths, edges)


def mean_ratios(points, tets, metric):
    """Q = 36/3^(1/3)·(|k|·√det M̄)^(2/3)/Σ vᵀM̄v, M̄ the log-Euclidean mean at the four vertices; negative where inverted."""
    logs = logarithm(metric)

    def ratios(some):
        mean = exponential(logs[some].mean(1))
        volume = volumes(points, some) * np.sqrt(np.linalg.det(mean))
        total = np.zeros(len(some))
        for i in range(4):
            for j in range(i + 1, 4):
                v = points[some[:, j]] - points[some[:, i]]
                total += np.einsum("ni,nij,nj->n", v, mean, v)
        return np.sign(volume) * 36 / 3 ** (1 / 3) * np.abs(volume) ** (2 / 3) / total

    return _in_blocks(ratios, tets)
