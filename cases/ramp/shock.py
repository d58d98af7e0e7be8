"""The oblique shock of a wedge in closed form, and how well a flow on tetrahedra meets it."""

import math
from dataclasses import dataclass

import numpy as np

# Where the shock is measured, in lengths of the ramp from its foot: away from foot and outlet.
NEAR, FAR = 0.2, 0.95
# Behind the shock and away from it: below a line of this angle, degrees, between these x.
BEHIND, FROM, TO = 38.0, 0.5, 0.9
# A tetrahedron is sampled at the centroids of so many pieces a side, cubed (a jump has no smooth quadrature).
PIECES = 4


@dataclass(frozen=True)
class Shock:
    """Angle of the weak shock (radians), pressure ratio, Mach number behind (NACA report 1135, equations 128, 132, 148)."""

    mach: float
    angle: float
    pressure: float
    behind: float


def oblique(mach, wedge, gamma=1.4):
    """The weak oblique shock of a wedge angle in radians: bisection between the Mach angle and 60°, where it is monotone at Mach 2."""
    def turned(angle):
        normal = (mach * math.sin(angle)) ** 2 - 1
        return math.atan(2 / math.tan(angle) * normal / (mach**2 * (gamma + math.cos(2 * angle)) + 2))

    low, high = math.asin(1 / mach), math.radians(60)
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if turned(middle) < wedge else (low, middle)
    square = (mach * math.sin(low)) ** 2
    behind = math.sqrt((1 + (gamma - 1) / 2 * square) / (gamma * square - (gamma - 1) / 2)) / math.sin(low - wedge)
    return Shock(mach, low, 1 + 2 * gamma / (gamma + 1) * (square - 1), behind)


def volumes(mesh):
    """Of the tetrahedra."""
    corners = mesh.points[mesh.tets]
    a, b, c = (corners[:, k] - corners[:, 0] for k in (1, 2, 3))
    return np.abs(np.einsum("ij,ij->i", np.cross(a, b), c)) / 6


def samples():
    """Barycentric coordinates, shape (n, 4), spread evenly over a tetrahedron: the points of a grid of its own."""
    ticks = np.arange(PIECES) + 0.25
    grid = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), -1).reshape(-1, 3) / PIECES
    inside = grid[grid.sum(1) < 1]
    return np.hstack([inside, 1 - inside.sum(1, keepdims=True)])


def mach_error(mesh, mach, shock):
    """The mean of |M − exact| over the volume, M linear in each tetrahedron."""
    slope, weights = math.tan(shock.angle), volumes(mesh)
    total = 0.0
    bary = samples()
    for at in bary:
        x, y, _ = np.einsum("k,nkd->dn", at, mesh.points[mesh.tets])
        exact = np.where((x > 0) & (y < slope * x), shock.behind, shock.mach)
        total += (weights * np.abs(np.einsum("k,nk->n", at, mach[mesh.tets]) - exact)).sum() / len(bary)
    return total / weights.sum()


def crossings(mesh, pressure, level):
    """Points on the edges of the tetrahedra where the pressure has a value."""
    pairs = [(i, j) for i in range(4) for j in range(i)]
    edges = np.unique(np.sort(np.concatenate([mesh.tets[:, pair] for pair in pairs]), 1), axis=0)
    a, b = pressure[edges[:, 0]], pressure[edges[:, 1]]
    cut = (a - level) * (b - level) < 0
    share = ((level - a[cut]) / (b[cut] - a[cut]))[:, None]
    return mesh.points[edges[cut, 0]] * (1 - share) + mesh.points[edges[cut, 1]] * share


def figures(mesh, pressure, mach, shock):
    """What the flow makes of the shock; pressures in units of the free stream's, lengths in those of the ramp (1).

    `angle` (degrees) of the line through the points of half the jump; `pressure` relative error behind; `mach_error` mean |M − exact|;
    `cells` median thickness across the shock of the tetrahedra that it passes through; `layer` distance across it of 90 % of the
    vertices between 10 and 90 % of the jump.
    """
    points = crossings(mesh, pressure, (1 + shock.pressure) / 2)
    points = points[(points[:, 0] > NEAR) & (points[:, 0] < FAR)]
    slope = np.polyfit(points[:, 0], points[:, 1], 1)[0]
    middle, weights = mesh.points[mesh.tets].mean(1), volumes(mesh)
    quiet = (middle[:, 0] > FROM) & (middle[:, 0] < TO) & (middle[:, 1] < middle[:, 0] * math.tan(math.radians(BEHIND)))
    mean = (weights * pressure[mesh.tets].mean(1))[quiet].sum() / weights[quiet].sum()
    normal = np.array([-math.sin(shock.angle), math.cos(shock.angle), 0])
    across = mesh.points @ normal
    at = (middle[:, 0] > NEAR) & (middle[:, 0] < FAR)
    jump = (pressure - 1) / (shock.pressure - 1)
    crossed = at & (jump[mesh.tets].min(1) < 0.5) & (jump[mesh.tets].max(1) > 0.5)
    spans = np.ptp(across[mesh.tets[crossed]], axis=1)
    x = mesh.points[:, 0]
    within = across[(x > NEAR) & (x < FAR) & (np.abs(across) < 0.1) & (jump > 0.1) & (jump < 0.9)]
    return {
        "vertices": len(mesh.points), "tetrahedra": len(mesh.tets), "angle": math.degrees(math.atan(slope)),
        "pressure": mean / shock.pressure - 1, "mach_error": mach_error(mesh, mach, shock),
        "cells": float(np.median(spans)), "layer": float(np.ptp(np.percentile(within, [5, 95]))) if len(within) else 0.0,
    }
