"""Coarse first meshes of cases that are plane flows: a grid of boxes, each cut into six tetrahedra, and its file."""

import json
from itertools import permutations

import numpy as np


def tetrahedra(points, closed=False):
    """Of a grid of points, shape (n, m, l, 3): points (n m l, 3), tetrahedra and triangles of the boundary, which point outwards; `closed`: the first
    direction ends where it begins."""
    shape = points.shape[:3]
    flat, tets = points.reshape(-1, 3), []
    for cell in np.ndindex(shape[0] if closed else shape[0] - 1, shape[1] - 1, shape[2] - 1):
        for order in permutations(range(3)):
            corner, nodes = np.array(cell), [np.ravel_multi_index(cell, shape)]
            for axis in order:
                corner[axis] += 1
                nodes.append(np.ravel_multi_index((corner[0] % shape[0], *corner[1:]), shape))
            a, b, c, d = flat[nodes]
            tets.append(nodes if np.linalg.det([b - a, c - a, d - a]) > 0 else [*nodes[:2], nodes[3], nodes[2]])
    faces = {}
    for nodes in tets:
        for face in ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)):
            face = tuple(nodes[i] for i in face)
            key = tuple(sorted(face))
            faces[key] = None if key in faces else face
    return flat, tets, [face for face in faces.values() if face is not None]


def write(path, points, tets, triangles, references, names):
    """Writes .mesh, and the names of its surfaces beside it; `names`: of references."""

    def rows(name, nodes, numbers):
        return [name, str(len(nodes)), *(" ".join(str(n + 1) for n in row) + f" {number}" for row, number in zip(nodes, numbers, strict=True))]

    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points))]
    lines += [f"{x:.17g} {y:.17g} {z:.17g} 0" for x, y, z in points]
    lines += rows("Triangles", triangles, references) + rows("Tetrahedra", tets, [1] * len(tets)) + ["End"]
    path.write_text("\n".join(lines) + "\n")
    named = {str(number): {"name": name} for number, name in names.items()}
    path.with_suffix(".names.json").write_text(json.dumps({"triangles": named}))
