"""The exact unit cube, and how a mesh of it sits on it: each reference on one side, nothing lost, the volume."""

import numpy as np

from .metric import volumes

TOLERANCE = 1e-9
SIDES = [(axis, value) for axis in range(3) for value in (0.0, 1.0)]


def judge(mesh, start=None):
    """Figures and findings of a mesh of the unit cube; `start` is the mesh it came from."""
    sides, farthest = _sides(mesh)
    found = []
    if farthest > TOLERANCE:
        found.append(f"a boundary vertex lies {farthest:.3g} off the side that its triangles' reference stands for")
    if sorted(sides.values()) != SIDES:
        found.append(f"triangles: references {sorted(sides)} on {len(set(sides.values()))} sides of the cube, expected six on six")
    if start is not None and _sides(start)[0] != sides:
        found.append("triangles: references lost or moved to another side")
    volume = float(volumes(mesh.points, mesh.tets).sum())
    if abs(volume - 1) > TOLERANCE:
        found.append(f"the volume is {volume:.12f}, not 1")
    return {"farthest_from_entity": farthest, "volume": volume, "volume_error": volume - 1}, found


def _sides(mesh):
    """{reference: the side (axis, value) it fits best} and the greatest distance from it."""
    sides, farthest = {}, 0.0
    for ref in np.unique(mesh.triangle_refs):
        on = mesh.points[np.unique(mesh.triangles[mesh.triangle_refs == ref])]
        distance = [float(np.abs(on[:, axis] - value).max()) for axis, value in SIDES]
        best = int(np.argmin(distance))
        sides[int(ref)], farthest = SIDES[best], max(farthest, distance[best])
    return sides, farthest
