"""The analytic scalars of the study (docs/METHOD.md 1.14; Tsolakis 2021, equations 21 to 23), on the unit cube: values (n,) from points (n, 3)."""

import numpy as np


def sinfun3(points):
    """Waves of two amplitudes; continuous, with kinks where the amplitude changes (s = -π/50 and 2π/50, zeros of the sine)."""
    s = (points - 0.4).prod(1)
    wide = (s > -np.pi / 50) & (s <= 2 * np.pi / 50)
    return np.where(wide, 1.0, 0.1) * np.sin(50 * s)


def tanh3(points):
    """Two fronts beside y = 0.3, and at z = 0 a layer that is 1e-6 thin at its thinnest."""
    x, y, z = points.T
    return np.tanh((x + 1.3) ** 20 * (y - 0.3) ** 9 * z)


def sinatan3(points):
    """Small waves, and a jump of π where sin 5y = 2xz: the branch of the arctangent."""
    x, y, z = points.T
    with np.errstate(divide="ignore"):
        return 0.1 * np.sin(50 * x * z) + np.arctan(0.1 / (np.sin(5 * y) - 2 * x * z))


SCALARS = {"sinfun3": sinfun3, "tanh3": tanh3, "sinatan3": sinatan3}
