"""The slab of the flat plate: its coarse first mesh, and what a solution on a mesh says of the plate."""

import json
from itertools import permutations

import numpy as np

# x of the front, of the plate's begin and end, the height and the width of the slab.
FRONT, BEGIN, END, HEIGHT, WIDTH = -1 / 3, 0.0, 2.0, 1.0, 0.05
NAMES = {1: "wall", 2: "before", 3: "side0", 4: "side1", 5: "inlet", 6: "outlet", 7: "top"}
# Of the flow in flow.cfg, in its units: density and velocity of the free stream and pressure 1 at T = 300 K.
MACH, REYNOLDS, GAMMA = 0.2, 5e6, 1.4
# Spalding's and the logarithmic law's constants.
KAPPA, B = 0.41, 5.0


def coarse(path):
    """Writes the first mesh, .mesh with its names beside, of boxes cut into six tetrahedra each, one across the slab."""
    xs = np.concatenate([np.linspace(FRONT, BEGIN, 5), np.linspace(BEGIN, END, 25)[1:]])
    ys = HEIGHT * np.array([0, 0.01, 0.03, 0.07, 0.14, 0.25, 0.4, 0.6, 0.8, 1.0])
    zs = np.array([0.0, WIDTH])
    shape = (len(xs), len(ys), len(zs))
    points = np.array([[x, y, z] for x in xs for y in ys for z in zs])
    tets = []
    for cell in np.ndindex(*(n - 1 for n in shape)):
        for order in permutations(range(3)):
            corner, nodes = np.array(cell), [np.ravel_multi_index(cell, shape)]
            for axis in order:
                corner[axis] += 1
                nodes.append(np.ravel_multi_index(corner, shape))
            a, b, c, d = points[nodes]
            tets.append(nodes if np.linalg.det([b - a, c - a, d - a]) > 0 else [*nodes[:2], nodes[3], nodes[2]])
    faces = {}
    for nodes in tets:
        for face in ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)):
            face = tuple(nodes[i] for i in face)
            key = tuple(sorted(face))
            faces[key] = None if key in faces else face
    triangles = [face for face in faces.values() if face is not None]
    references = [reference(points[list(face)]) for face in triangles]

    def rows(name, nodes, numbers):
        return [name, str(len(nodes)), *(" ".join(str(n + 1) for n in row) + f" {number}" for row, number in zip(nodes, numbers, strict=True))]

    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points))]
    lines += [f"{x:.17g} {y:.17g} {z:.17g} 0" for x, y, z in points]
    lines += rows("Triangles", triangles, references) + rows("Tetrahedra", tets, [1] * len(tets)) + ["End"]
    path.write_text("\n".join(lines) + "\n")
    named = {str(number): {"name": name} for number, name in NAMES.items()}
    path.with_suffix(".names.json").write_text(json.dumps({"triangles": named}))


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


def spalding(y_plus):
    """u⁺ of the law of Spalding (1961)."""
    u = np.linspace(0, 40, 40001)
    terms = KAPPA * u
    y = u + np.exp(-KAPPA * B) * (np.exp(terms) - 1 - terms - terms**2 / 2 - terms**3 / 6)
    return np.interp(y_plus, y, u)


def heights(mesh):
    """Mean distance from the plate of the points opposite to its triangles, and the greatest ratio of the sizes of tetrahedra upon it."""
    on_wall = mesh.points[:, 1] == 0
    upon = mesh.tets[(on_wall[mesh.tets].sum(axis=1) == 3)]
    corners = mesh.points[upon]
    height = corners[:, :, 1].max(axis=1)
    beside = (corners[:, :, 0].mean(axis=1) > BEGIN + 0.05) & (corners[:, :, 0].mean(axis=1) < END - 0.05)
    length = np.ptp(corners[:, :, 0], axis=1)
    return float(height[beside].mean()), float((length / height)[beside].max())
