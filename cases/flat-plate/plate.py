"""The slab of the flat plate: its coarse first mesh, and what a solution on a mesh says of the plate."""

import numpy as np
from judging import slab
from judging.walls import B, KAPPA, spalding  # noqa: F401

# x of the front, of the plate's begin and end, the height and the width of the slab.
FRONT, BEGIN, END, HEIGHT, WIDTH = -1 / 3, 0.0, 2.0, 1.0, 0.05
NAMES = {1: "wall", 2: "before", 3: "side0", 4: "side1", 5: "inlet", 6: "outlet", 7: "top"}
# Of the flow in flow.cfg, in its units: density and velocity of the free stream and pressure 1 at T = 300 K.
MACH, REYNOLDS, GAMMA = 0.2, 5e6, 1.4


def coarse(path):
    """Writes the first mesh, .mesh with its names beside, of boxes cut into six tetrahedra each, one across the slab."""
    xs = np.concatenate([np.linspace(FRONT, BEGIN, 5), np.linspace(BEGIN, END, 25)[1:]])
    ys = HEIGHT * np.array([0, 0.01, 0.03, 0.07, 0.14, 0.25, 0.4, 0.6, 0.8, 1.0])
    grid = np.stack(np.meshgrid(xs, ys, [0.0, WIDTH], indexing="ij"), axis=-1)
    points, tets, triangles = slab.tetrahedra(grid)
    slab.write(path, points, tets, triangles, [reference(points[list(face)]) for face in triangles], NAMES)


def reference(corners):
    """Of a triangle of the boundary."""
    middle, flat = corners.mean(axis=0), np.ptp(corners, axis=0) < 1e-9
    if flat[1]:
        return 7 if middle[1] > 0.5 * HEIGHT else 1 if middle[0] > BEGIN else 2
    if flat[2]:
        return 3 if middle[2] < 0.5 * WIDTH else 4
    return 5 if middle[0] < BEGIN else 6


def friction(mesh, fields, at):
    """c_f along the plate (x, c_f, ascending), and at one x by a straight line through the points about it."""
    wall = np.unique(mesh.triangles[mesh.triangle_refs == 1])
    x, found = mesh.points[wall, 0], fields["Skin_Friction_Coefficient"][wall, 0]
    order = np.argsort(x)
    x, found = x[order], found[order]
    near = np.abs(x - at) < 0.1
    return x, found, float(np.polyval(np.polyfit(x[near], found[near], 1), at))


def profile(mesh, fields, at, c_f, width):
    """u⁺ of y⁺ at the points within a strip about one x, by the friction there."""
    strip = (np.abs(mesh.points[:, 0] - at) < width) & (mesh.points[:, 1] > 0)
    points = mesh.points[strip]
    velocity = fields["Momentum"][strip, 0] / fields["Density"][strip]
    outside = MACH * np.sqrt(GAMMA)
    shear = outside * np.sqrt(0.5 * c_f)
    y_plus = points[:, 1] * REYNOLDS * np.sqrt(0.5 * c_f)
    order = np.argsort(y_plus)
    return y_plus[order], (velocity / shear)[order]


def heights(mesh):
    """Mean distance from the plate of the points opposite to its triangles, and the greatest ratio of the sizes of tetrahedra upon it."""
    on_wall = mesh.points[:, 1] == 0
    upon = mesh.tets[(on_wall[mesh.tets].sum(axis=1) == 3)]
    corners = mesh.points[upon]
    height = corners[:, :, 1].max(axis=1)
    beside = (corners[:, :, 0].mean(axis=1) > BEGIN + 0.05) & (corners[:, :, 0].mean(axis=1) < END - 0.05)
    length = np.ptp(corners[:, :, 0], axis=1)
    return float(height[beside].mean()), float((length / height)[beside].max())
