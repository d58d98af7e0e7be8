"""Pictures of the case: the Mach number in planes across the wing, and the coefficients of each cycle."""

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

# Planes across the flow (x) and the window that is shown of them (y, z).
PLANES = (0.3, 0.6, 0.9, 1.1)
WINDOW = ((0, 0.4), (-0.1, 0.25))


def section(mesh, values, x):
    """Triangles in which the plane of that x cuts the tetrahedra: corners (n, 3, 2) in y and z, values there (n, 3)."""
    height = mesh.points[:, 0] - x
    height[height == 0] = 1e-14  # a plane through vertices: taken a hair before them
    above = height[mesh.tets] > 0
    cut = above.any(1) & ~above.all(1)
    # Those above the plane first: with one or three of them a triangle, with two a quadrilateral of two triangles.
    nodes = np.take_along_axis(mesh.tets[cut], np.argsort(~above[cut], axis=1, kind="stable"), 1)
    count = above[cut].sum(1)
    pairs = {1: [[(0, 1), (0, 2), (0, 3)]], 2: [[(0, 2), (0, 3), (1, 3)], [(0, 2), (1, 3), (1, 2)]], 3: [[(0, 3), (1, 3), (2, 3)]]}
    corners, found = [], []
    for number, triangles in pairs.items():
        some = nodes[count == number]
        for triangle in triangles:
            a, b = some[:, [i for i, _ in triangle]], some[:, [j for _, j in triangle]]
            share = height[a] / (height[a] - height[b])
            corners.append(mesh.points[a][..., 1:] + share[..., None] * (mesh.points[b] - mesh.points[a])[..., 1:])
            found.append(values[a] + share * (values[b] - values[a]))
    return np.concatenate(corners), np.concatenate(found)


def vortex(mesh, mach, path):
    """The Mach number above the wing."""
    figure, axes = pyplot.subplots(2, 2, figsize=(14, 11), sharex=True, sharey=True)
    levels = np.linspace(0, 0.45, 31)
    for axis, x in zip(axes.flat, PLANES):
        corners, values = section(mesh, mach, x)
        points = corners.reshape(-1, 2)
        triangles = np.arange(len(points)).reshape(-1, 3)
        shown = axis.tricontourf(points[:, 0], points[:, 1], triangles, values.ravel(), levels, cmap="turbo", extend="both")
        axis.triplot(points[:, 0], points[:, 1], triangles, color="black", linewidth=0.1)
        axis.set(xlim=WINDOW[0], ylim=WINDOW[1], aspect="equal", title=f"x = {x}", xlabel="y", ylabel="z")
    figure.colorbar(shown, ax=axes, label="Mach number", shrink=0.8)
    figure.suptitle(f"delta wing, Mach 0.3, Re 4000, 12.5°: {len(mesh.points)} vertices")
    figure.savefig(path, dpi=100)


def way(loop, published, path):
    """The coefficients of each cycle over its vertices."""
    figure, axes = pyplot.subplots(1, 2, figsize=(12, 5))
    vertices = [step["vertices"] for step in loop]
    for axis, (name, value) in zip(axes, published.items()):
        axis.semilogx(vertices, [step["functionals"][name] for step in loop], "o-", label="this loop")
        axis.axhline(value, color="black", linestyle="--", label=f"Tsolakis 2021, 5.7 million vertices: {value}")
        axis.axhspan(0.9945 * value, 1.0055 * value, alpha=0.15, label="0.55 %: the references from each other")
        axis.set(xlabel="vertices", title=name)
        axis.grid(alpha=0.3)
        axis.legend()
    figure.tight_layout()
    figure.savefig(path, dpi=100)
