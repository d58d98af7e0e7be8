"""How far metrics at the same vertices are apart, and the tables that say so."""

import numpy as np

from . import recipe

PERCENTS = (10, 50, 90, 99, 100)


def distance(first, second):
    """|ln(M1^-1/2 M2 M1^-1/2)| (Frobenius), the affine-invariant distance, (n,). Sizes that all differ by a factor f give 2√3 ln f."""
    _, inverse = recipe.roots(first)
    return np.sqrt((np.log(np.linalg.eigvalsh(inverse @ second @ inverse)) ** 2).sum(1))


def size_ratios(first, second):
    """log2 of the size of M2 over that of M1 along the eigenvectors of M1, least size of M1 first, (n, 3)."""
    values, vectors = np.linalg.eigh(first)
    along = np.einsum("nik,nij,njk->nk", vectors, second, vectors)
    return -0.5 * np.log2(along / values)[:, ::-1]


def rms(values):
    return float(np.sqrt((values**2).mean()))


def head(zones):
    """The line above rows of `row`, and one with the zones' sizes."""
    columns = " ".join(f"{f'{p} %':>6}" for p in PERCENTS)
    widths = [f"{f'{name} ({members.sum()})':<18}" for name, members in zones.items()]
    return f"{'':<50}{'all: rms':>9} {columns}   rms on  {''.join(widths)}".rstrip()


def row(name, far, zones):
    """The distances over all vertices, and the rms of each zone."""
    over_all = " ".join(f"{x:6.3f}" for x in np.percentile(far, PERCENTS))
    return f"{name:<50}{rms(far):9.3f} {over_all}           {''.join(f'{rms(far[members]):<18.3f}' for members in zones.values())}".rstrip()
