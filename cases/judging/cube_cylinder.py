"""The exact cube-cylinder, and how a mesh of it sits on it: distances, references, nothing lost.

The faces are known in closed form, so no CAD kernel is asked. Which reference means which face is found
from the mesh (each reference must fit one face, each face one reference) and compared with the start mesh.
"""

import numpy as np

from .metric import volumes

VOLUME = 1 - np.pi / 16
RADIUS = 0.5
# name: axis and value of a plane; the wall is the cylinder.
PLANES = {"x=0": (0, 0.0), "x=1": (0, 1.0), "y=0": (1, 0.0), "y=1": (1, 1.0), "z=0": (2, 0.0), "z=1": (2, 1.0)}
FACES = [*PLANES, "wall"]
EDGES = [("x=0", "wall"), ("y=0", "wall"), ("x=0", "y=1"), ("x=1", "y=1"), ("x=1", "y=0")] + [
    (side, end) for end in ("z=0", "z=1") for side in ("x=0", "x=1", "y=0", "y=1", "wall")
]
CORNERS = np.array([(x, y, z) for z in (0, 1) for x, y in ((0, 0.5), (0.5, 0), (0, 1), (1, 0), (1, 1))], float)
TOLERANCE = 1e-9


def distance_to_face(name, points):
    """How far the points are from the *trimmed* face: the worse of the distance to its surface and of the overhang."""
    outside = np.maximum(np.maximum(-points, points - 1), 0).max(axis=1)
    radius = np.hypot(points[:, 0], points[:, 1])
    if name == "wall":
        return np.maximum(np.abs(radius - RADIUS), outside)
    axis, value = PLANES[name]
    hole = np.maximum(RADIUS - radius, 0)
    return np.maximum(np.abs(points[:, axis] - value), np.maximum(outside, hole))


def distance_to_edge(pair, points):
    """The worse of the distances to its two faces (they meet at right angles)."""
    return np.maximum(distance_to_face(pair[0], points), distance_to_face(pair[1], points))


def normals(name, points):
    """Outward unit normals of a face at points on it."""
    if name == "wall":
        out = np.stack([-points[:, 0], -points[:, 1], np.zeros(len(points))], axis=1)
        return out / np.linalg.norm(out, axis=1)[:, None]
    axis, value = PLANES[name]
    out = np.zeros((len(points), 3))
    out[:, axis] = 1 if value == 1 else -1
    return out


def _match(refs, nodes, points, entities, distance):
    """For each reference the entity it fits best and the largest distance to it."""
    fits = {}
    for ref in np.unique(refs):
        on = points[np.unique(nodes[refs == ref])]
        worst = [float(distance(entity, on).max()) for entity in entities]
        best = int(np.argmin(worst))
        fits[int(ref)] = (entities[best], worst[best])
    return fits


def fit(mesh):
    """{reference: (entity, distance)} of triangles, of edges, and of the ids in the association."""
    groups = {
        "triangles": (mesh.triangle_refs, mesh.triangles, FACES, distance_to_face),
        "edges": (mesh.edge_refs, mesh.edges, EDGES, distance_to_edge),
        "VerticesOnGeometricTriangles": (mesh.on_faces[:, 1], mesh.on_faces[:, :1], FACES, distance_to_face),
        "VerticesOnGeometricEdges": (mesh.on_edges[:, 1], mesh.on_edges[:, :1], EDGES, distance_to_edge),
    }
    return {name: _match(refs, nodes, mesh.points, *how) for name, (refs, nodes, *how) in groups.items()}


def judge(mesh, start=None):
    """Figures and findings of a mesh of the cube-cylinder; `start` is the mesh it came from."""
    fits, found = fit(mesh), []
    wanted = {"triangles": 7, "edges": 15, "VerticesOnGeometricTriangles": 7, "VerticesOnGeometricEdges": 15}
    for name, entities in fits.items():
        if not entities and name.startswith("Vertices"):
            continue
        distinct = {entity for entity, _ in entities.values()}
        if len(entities) != wanted[name] or len(distinct) != wanted[name]:
            found.append(f"{name}: {len(entities)} references on {len(distinct)} entities of the model, expected {wanted[name]}")
    farthest = max((d for entities in fits.values() for _, d in entities.values()), default=0.0)
    gap = np.linalg.norm(mesh.points[:, None] - CORNERS[None], axis=2) if len(mesh.points) else np.full((1, 10), np.inf)
    corner_distance = float(gap.min(axis=0).max())
    if max(farthest, corner_distance) > TOLERANCE:
        found.append(f"a boundary vertex lies {max(farthest, corner_distance):.3g} off its own entity, more than {TOLERANCE}")
    found += _corners(mesh, gap) + (_lost(mesh, start, fits) if start is not None else [])
    least, bent = _normals(mesh, fits["triangles"])
    if least <= 0:
        found.append(f"{bent} boundary triangles are turned against the outward normal of their face")
    volume = float(volumes(mesh.points, mesh.tets).sum())
    figures = {"farthest_from_entity": max(farthest, corner_distance), "volume": volume,
               "volume_error": volume - VOLUME, "least_normal_cosine": least}
    return figures, found


def _corners(mesh, gap):
    """The ten corners are marked, as Corners or by the association, and nothing else is."""
    nearest = set(gap.argmin(axis=0).tolist())
    found = []
    for name, marked in [("Corners", mesh.corners), ("VerticesOnGeometricVertices", mesh.on_vertices[:, 0])]:
        if len(marked) and set(marked.tolist()) != nearest:
            found.append(f"{name} marks {len(set(marked.tolist()))} vertices, not the ten corners of the model")
    if not len(mesh.corners) and not len(mesh.on_vertices):
        found.append("no corner is marked (neither Corners nor VerticesOnGeometricVertices)")
    return found


def _lost(mesh, start, fits):
    """References of the start mesh that are gone or mean another entity now."""
    found, before = [], fit(start)
    for name in ("triangles", "edges"):
        was = {ref: entity for ref, (entity, _) in before[name].items()}
        now = {ref: entity for ref, (entity, _) in fits[name].items()}
        if was and was != now:
            changed = sorted(ref for ref in was.keys() | now.keys() if was.get(ref) != now.get(ref))
            found.append(f"{name}: references lost or moved to another entity: {changed}")
    if set(np.unique(start.tet_refs)) != set(np.unique(mesh.tet_refs)):
        found.append(f"regions {np.unique(start.tet_refs).tolist()} became {np.unique(mesh.tet_refs).tolist()}")
    return found


def _normals(mesh, fits):
    """Least cosine between a triangle's outward normal and its face's at the centroid, and how many are turned over."""
    a, b, c = (mesh.points[mesh.triangles[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    centroid = (a + b + c) / 3
    cosine = np.ones(len(normal))
    for ref, (name, _) in fits.items():
        on = mesh.triangle_refs == ref
        cosine[on] = np.einsum("ij,ij->i", normal[on], normals(name, centroid[on])) / np.maximum(size[on], 1e-300)
    if len(cosine) and (cosine < 0).mean() > 0.5:
        cosine = -cosine  # some writers order triangles towards the inside
    return float(cosine.min(initial=1.0)), int((cosine <= 0).sum())
