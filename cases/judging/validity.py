"""Is a mesh a mesh: positive volumes, conforming, closed, nothing unused or doubled. Shares no code with the program."""

from fractions import Fraction

import numpy as np

from .metric import row_keys, volumes


def findings(mesh):
    """Everything that is wrong, one line each; an empty list for a valid mesh."""
    found = _indices_twice(mesh)
    inverted = int((~_positive(mesh)).sum())
    if inverted:
        found.append(f"{inverted} tetrahedra are inverted or flat")
    unused = len(mesh.points) - len(np.unique(mesh.tets))
    if unused:
        found.append(f"{unused} vertices belong to no tetrahedron")
    faces, owner, even = tet_faces(mesh.tets)
    triangles = np.sort(mesh.triangles, axis=1)
    keys = row_keys(np.concatenate([faces, triangles]), len(mesh.points))
    unique, first, inverse, count = np.unique(keys[: len(faces)], return_index=True, return_inverse=True, return_counts=True)
    found += _faces(mesh, unique, inverse, count, owner, even, keys[len(faces) :])
    return found + _edges(mesh, faces[first[count == 1]], triangles)


def _indices_twice(mesh):
    found = []
    for name, cells in [("edges", mesh.edges), ("triangles", mesh.triangles), ("tetrahedra", mesh.tets)]:
        ordered = np.sort(cells, axis=1)
        collapsed = int((np.diff(ordered, axis=1) == 0).any(axis=1).sum())
        if collapsed:
            found.append(f"{collapsed} {name} name a vertex twice")
        doubled = len(ordered) - len(np.unique(row_keys(ordered, len(mesh.points))))
        if doubled:
            found.append(f"{doubled} {name} are there twice")
    return found


def _positive(mesh):
    """Positive volume; where rounding could decide it, in exact rational arithmetic."""
    size = volumes(mesh.points, mesh.tets)
    corner = mesh.points[mesh.tets]
    spread = np.abs(corner).max(axis=(1, 2)) ** 3
    doubtful = np.flatnonzero(np.abs(size) < 1e-13 * spread)
    positive = size > 0
    for tet in doubtful:
        a, b, c, d = ([Fraction(float(x)) for x in point] for point in corner[tet])
        u, v, w = ([q - p for p, q in zip(a, end)] for end in (b, c, d))
        cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        positive[tet] = sum(p * q for p, q in zip(cross, w)) > 0
    return positive


# The faces of a positive tetrahedron, seen counter-clockwise from outside.
OUTWARD = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]


def tet_faces(tets):
    """All faces of all tets: sorted vertices (4n, 3), the tet of each, and whether the outward order is an even one."""
    faces = np.concatenate([tets[:, face] for face in OUTWARD])
    owner = np.tile(np.arange(len(tets)), 4)
    a, b, c = faces.T
    even = ((a < b) & (b < c)) | ((b < c) & (c < a)) | ((c < a) & (a < b))
    return np.sort(faces, axis=1), owner, even


def _faces(mesh, unique, inverse, count, owner, even, triangles):
    """Faces between two tets on opposite sides; triangles where the boundary or a region's border is. Faces by their keys."""
    found = []
    if (count > 2).any():
        found.append(f"{int((count > 2).sum())} faces belong to more than two tetrahedra")
    evens = np.bincount(inverse, weights=even, minlength=len(unique))
    same_side = int(((count == 2) & (evens != 1)).sum())
    if same_side:
        found.append(f"{same_side} faces have both tetrahedra on the same side")
    regions = [np.full(len(unique), limit) for limit in (np.iinfo(np.int64).max, np.iinfo(np.int64).min)]
    np.minimum.at(regions[0], inverse, mesh.tet_refs[owner])
    np.maximum.at(regions[1], inverse, mesh.tet_refs[owner])
    needs_triangle = (count == 1) | (regions[0] != regions[1])
    at = np.minimum(np.searchsorted(unique, triangles), len(unique) - 1)
    there = unique[at] == triangles
    if not there.all():
        found.append(f"{int((~there).sum())} triangles are no face of a tetrahedron")
    covered = np.zeros(len(unique), bool)
    covered[at[there]] = True
    bare = int((needs_triangle & ~covered).sum())
    if bare:
        found.append(f"{bare} faces on the boundary or between regions have no triangle")
    return found


def _sides(triangles):
    """The sides of triangles whose vertices are sorted, sorted too, shape (3n, 2)."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]])


def _edges(mesh, outer, triangles):
    """The outer boundary is closed and manifold; tagged edges are edges of triangles."""
    limit, found = len(mesh.points), []
    _, shared = np.unique(row_keys(_sides(outer), limit), return_counts=True)
    if (shared != 2).any():
        found.append(f"{int((shared != 2).sum())} edges of the boundary do not lie between exactly two triangles")
    tagged = row_keys(np.sort(mesh.edges, axis=1), limit)
    loose = int((~np.isin(tagged, row_keys(_sides(triangles), limit))).sum())
    if loose:
        found.append(f"{loose} tagged edges are no edge of a triangle")
    return found
