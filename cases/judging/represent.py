"""Is everything of the model in the mesh: faces, edges, corners, regions, names; and does the mesh lie on it."""

import json

import numpy as np

# Over the diagonal of the model's box; or the model's own tolerance where that is more.
ON_MODEL = 1e-7

# Balls touch a groove along curves that are no edges of the model: finer or coarser, triangles of the two cross there, which is told.
# So many pairs of them may.
CROSSINGS = {"rolling.step": 20}


def flaws(inspected, name):
    """A line for each kind of flaw of a mesh that is not valid; `name` is its model's file."""
    allowed = {"crossing-triangles": CROSSINGS.get(name, 0)}
    return [f"not valid: {flaw['count']} {flaw['kind']}" for flaw in inspected["flaws"] if flaw["count"] > allowed.get(flaw["kind"], 0)]


def wanted(model):
    """Numbers of the faces, edges and vertices that a mesh must have; `model` as `geo-adapt model --json` lists it, from 1.

    Seams and degenerate edges are no ridges; a vertex is a corner where an edge ends that does not close there.
    """
    edges = {i: edge for i, edge in enumerate(model["edges"], 1) if not edge["degenerate"] and not edge["seam"]}
    corners = {end for edge in edges.values() for end in set(edge["vertices"]) if len(set(edge["vertices"])) == 2}
    return {"face": set(range(1, len(model["faces"]) + 1)), "edge": set(edges), "vertex": corners}


def missing(mesh, model):
    """One line for each kind of entity of which some are not in the mesh."""
    there = {"face": mesh.triangle_refs, "edge": mesh.edge_refs, "vertex": mesh.on_vertices[:, 1]}
    found = []
    for kind, numbers in wanted(model).items():
        lost = sorted(numbers - set(np.unique(there[kind]).tolist()))
        if lost:
            found.append(f"{len(lost)} of {len(numbers)} {kind} numbers not there: {' '.join(map(str, lost[:8]))}")
    regions = len(np.unique(mesh.tet_refs))
    if regions != model["solids"]:
        found.append(f"{regions} regions, the model has {model['solids']} solids")
    return found


def names(path):
    """{(kind, name)} of the file of names beside a mesh; empty where there is none."""
    beside = path.with_suffix(".names.json")
    if not beside.is_file():
        return set()
    content = json.loads(beside.read_text())
    return {(kind, label.get("name")) for kind, labels in content.items() for label in labels.values()}


def off_model(inspected, model):
    """The farthest vertex from its entity over the diagonal, and a line if that is too far; `inspected` by `geo-adapt inspect --cad --json`."""
    distance = inspected["cad"]["from_entity"]["distance"]
    allowed = max(ON_MODEL * model["diagonal"], model["tolerance"])
    far = [f"a vertex {distance:.3g} off its entity, allowed {allowed:.3g}"] if distance > allowed else []
    return distance / model["diagonal"], far
