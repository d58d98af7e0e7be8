"""Small meshes and models for examples and tests."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np

from .mesh import Mesh


def cube(n: int = 4) -> Mesh:
    """The unit cube of n³ cells, six tetrahedra each, about a diagonal (Kuhn).

    Parameters
    ----------
    n : int
        Cells along a side, at least 1.

    Returns
    -------
    Mesh
        Its sides are called "x=0", "x=1", …, of references 1 to 6.

    Examples
    --------
    >>> import geo_adapt
    >>> geo_adapt.examples.cube(2)
    <geo_adapt.Mesh: 27 points, 48 tetrahedra, 48 triangles, 6 named surfaces>
    """
    axis = np.arange(n + 1)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    steps = np.array([(n + 1) ** 2, n + 1, 1])
    corner = (np.stack(np.meshgrid(axis[:-1], axis[:-1], axis[:-1], indexing="ij"), axis=-1).reshape(-1, 3) @ steps)[:, None]
    tets = []
    for order in itertools.permutations(range(3)):
        path = np.concatenate([[0], np.cumsum(steps[list(order)])])
        # Odd permutations are mirrored.
        turned = path[[0, 2, 1, 3]] if np.linalg.det(np.eye(3)[list(order)]) < 0 else path
        tets.append(corner + turned)
    cells = np.concatenate(tets)
    points = grid / n
    faces = np.concatenate([cells[:, [1, 2, 3]], cells[:, [0, 3, 2]], cells[:, [0, 1, 3]], cells[:, [0, 2, 1]]])
    triangles, references, names = [], [], {}
    for number, (side, value) in enumerate(itertools.product(range(3), (0, n)), 1):
        on = faces[(grid[faces, side] == value).all(axis=1)]
        triangles.append(on)
        references.append(np.full(len(on), number, np.int32))
        names[f"{'xyz'[side]}={value // n}"] = [number]
    return Mesh(points, cells, np.concatenate(triangles), np.concatenate(references), names)


def cylinder() -> bytes:
    """The BREP of a cylinder of radius 1 and height 2 along z, for `Model`."""
    return (Path(__file__).parent / "data" / "cylinder.brep").read_bytes()
