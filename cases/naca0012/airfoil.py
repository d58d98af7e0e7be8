"""The NACA 0012 of NASA's Turbulence Modeling Resource, and the coarse first mesh of a slab of space about it; model.py has its model.

Chord 1 along x, z up, y across the slab. The profile ends sharp at x = 1 (turbmodels.larc.nasa.gov/naca0012_val.html): z = T (A √x + B x + C x² + D x³ + E x⁴).
In s = √x it is a
polynomial of degree eight, so that one Bézier curve is the whole upper side, exactly.
"""

from math import comb

import numpy as np
from judging import slab

SCALE = 0.594689181
# Of s, s², …, s⁸.
POWERS = {1: 0.298222773, 2: -0.127125232, 4: -0.357907906, 6: 0.291984971, 8: -0.105174606}
DEGREE = 8
# The width of the slab, and how far the square of the far field is from the middle of the chord, chords.
WIDTH, FAR = 0.02, 500.0
MIDDLE = 0.5
# Faces in their order in the model: their references in meshes are 1, 2, …
NAMES = {1: "upper", 2: "lower", 3: "side0", 4: "side1", **dict.fromkeys(range(5, 9), "farfield")}
# The first mesh: points about the profile (a multiple of eight), and away from it; the distance of the first ones.
AROUND, AWAY, FIRST = 48, 25, 0.01


def half(x):
    """z of the upper side."""
    s = np.sqrt(x)
    return SCALE * sum(factor * s**power for power, factor in POWERS.items())


def poles():
    """The Bézier points of the upper side from the nose to the trailing edge, shape (9, 2): x and z."""
    def bernstein(powers):
        return [sum(comb(i, j) / comb(DEGREE, j) * powers.get(j, 0.0) for j in range(i + 1)) for i in range(DEGREE + 1)]

    found = np.column_stack([bernstein({2: 1.0}), bernstein({power: SCALE * factor for power, factor in POWERS.items()})])
    found[-1] = 1.0, 0.0  # exactly, not but for rounding
    return found


def square(share):
    """Points on the square of the far field, (x, z), at shares of its circumference from (MIDDLE + FAR, 0) on, counterclockwise."""
    side, along = np.divmod(8 * np.asarray(share, float) + 1, 2)
    turn = np.exp(0.5j * np.pi * side) * FAR * (1 + 1j * (along - 1))
    return np.column_stack([MIDDLE + turn.real, turn.imag])


def coarse(path):
    """Writes the first mesh: rings of boxes about the profile, one across the slab."""
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    x = 0.5 * (1 + np.cos(angle))
    inner = np.column_stack([x, np.sign(np.sin(angle)) * half(x)])
    inner[0], inner[AROUND // 2] = (1, 0), (0, 0)
    outer = square(np.arange(AROUND) / AROUND)
    shares = np.concatenate([[0], np.geomspace(FIRST / FAR, 1, AWAY)])
    plane = inner[:, None] + shares[None, :, None] * (outer - inner)[:, None]
    plane[:, -1] = outer
    grid = np.stack([np.stack([plane[..., 0], np.full(plane.shape[:2], y), plane[..., 1]], -1) for y in (WIDTH, 0.0)], axis=2)
    points, tets, triangles = slab.tetrahedra(grid, closed=True)
    slab.write(path, points, tets, triangles, [reference(points[list(face)]) for face in triangles], NAMES)


def reference(corners):
    """Of a triangle of the boundary: the number of its face."""
    (x, y, z), flat = corners.mean(axis=0), np.ptp(corners, axis=0) < 1e-12
    if flat[1]:
        return 3 if y < 0.5 * WIDTH else 4
    if max(abs(x), abs(z)) < 0.5 * FAR:
        return 1 if z > 0 else 2
    return (5 if x > 0 else 7) if flat[0] else (6 if z > 0 else 8)
