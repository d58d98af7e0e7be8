"""The uniform mesh of the unit cube: a structured grid, each cell cut into Kuhn's six tetrahedra.

    python cases/comparing/uniform.py 124 -o uniform.meshb        # 124³ = 1 906 624 vertices, some seconds

References are the numbers of faces, edges and vertices in geometry/cube.step. Every tetrahedron has the same shape
(mean ratio 0.756), every interior vertex 24 of them: a little more than a mesher's mesh has.
"""

import argparse
import itertools
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from judging import meshfile  # noqa: E402

# Face 2·axis + side + 1 of geometry/cube.step is where the axis' coordinate is `side`; its edges in the order of the file.
EDGE_FACES = [(1, 3), (1, 5), (1, 4), (1, 6), (2, 3), (2, 5), (2, 4), (2, 6), (3, 5), (3, 6), (4, 5), (4, 6)]


def uniform_cube(count):
    """The mesh with `count` vertices along each edge, z fastest; a meshfile.Mesh."""
    if count < 2:
        raise ValueError(f"{count} vertices an edge: at least 2 are needed")
    index = np.arange(count**3, dtype=np.int32).reshape(count, count, count)
    along = np.linspace(0, 1, count)
    points = np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3)
    triangles, triangle_refs = _triangles(index)
    edges, edge_refs = _edges(index)
    tets = _tets(index)
    corners = index[:: count - 1, :: count - 1, :: count - 1].ravel()
    none = np.zeros((0, 2), np.int64)
    return meshfile.Mesh(points, np.zeros(len(points), np.int32), edges, edge_refs, triangles, triangle_refs,
                         tets, np.zeros(len(tets), np.int32), corners, none, none, none, np.zeros((0, 2)), np.zeros((0, 3)))


def _tets(index):
    """Along each of the six ways from a cell's low to its high corner, one step an axis, lies one tetrahedron."""
    cells = []
    for way in itertools.permutations(range(3)):
        at, nodes = [0, 0, 0], []
        nodes.append(_shifted(index, at))
        for axis in way:
            at[axis] = 1
            nodes.append(_shifted(index, at))
        odd = way not in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        if odd:  # mirrored: exchange two vertices
            nodes[1], nodes[2] = nodes[2], nodes[1]
        cells.append(np.stack([node.ravel() for node in nodes], axis=-1))
    # the tetrahedra of a cell follow each other
    return np.stack(cells, axis=1).reshape(-1, 4)


def _shifted(index, by):
    """The vertex of each cell at the corner `by`."""
    return index[tuple(slice(step, len(index) - 1 + step) for step in by)]


def _triangles(index):
    """The six sides, two triangles a square, cut along the diagonal that the tetrahedra have, outward; references 1..6."""
    triangles, refs = [], []
    for axis, side in itertools.product(range(3), range(2)):
        grid = np.take(index, -side, axis=axis)
        low, high = grid[:-1, :-1].ravel(), grid[1:, 1:].ravel()
        first, second = grid[1:, :-1].ravel(), grid[:-1, 1:].ravel()
        # (first axis, second axis, normal) is right-handed for x and z, left-handed for y
        if (side == 1) == (axis != 1):
            pair = [(low, first, high), (low, high, second)]
        else:
            pair = [(low, high, first), (low, second, high)]
        triangles.append(np.stack([np.stack(nodes, axis=-1) for nodes in pair], axis=1).reshape(-1, 3))
        refs.append(np.full(len(triangles[-1]), 2 * axis + side + 1, np.int32))
    return np.concatenate(triangles), np.concatenate(refs)


def _edges(index):
    """The twelve edges, references 1..12."""
    edges, refs = [], []
    for number, faces in enumerate(EDGE_FACES, start=1):
        where = [slice(None)] * 3
        for face in faces:
            where[(face - 1) // 2] = -((face - 1) % 2)
        line = index[tuple(where)]
        edges.append(np.stack([line[:-1], line[1:]], axis=-1))
        refs.append(np.full(len(line) - 1, number, np.int32))
    return np.concatenate(edges), np.concatenate(refs)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int, help="vertices along each edge")
    parser.add_argument("-o", "--output", required=True, help=".meshb to write")
    options = parser.parse_args()
    mesh = uniform_cube(options.count)
    meshfile.write_mesh(options.output, mesh)
    print(f"wrote {options.output}: {len(mesh.points)} vertices, {len(mesh.tets)} tetrahedra")


if __name__ == "__main__":
    main()
