"""Reads and writes libMeshb's .mesh/.meshb and reads/writes .sol/.solb, with numpy alone.

Written against libMeshb's documentation, not against the Rust reader: the two check each other.
"""

import struct
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

# keyword code: (name, integers a row before the reals, reals a row, integers after them).
# A vertex has its coordinates first; the dimension is known to be 3.
ENTITIES = {
    4: ("Vertices", 0, 3, 1),
    5: ("Edges", 3, 0, 0),
    6: ("Triangles", 4, 0, 0),
    8: ("Tetrahedra", 5, 0, 0),
    13: ("Corners", 1, 0, 0),
    14: ("Ridges", 1, 0, 0),
    15: ("RequiredVertices", 1, 0, 0),
    16: ("RequiredEdges", 1, 0, 0),
    17: ("RequiredTriangles", 1, 0, 0),
    40: ("VerticesOnGeometricVertices", 2, 0, 0),
    41: ("VerticesOnGeometricEdges", 2, 2, 0),
    42: ("VerticesOnGeometricTriangles", 2, 3, 0),
}
CODES = {name.lower(): code for code, (name, *_) in ENTITIES.items()}
DIMENSION, END, SOL_AT_VERTICES = 3, 54, 62
VALUES_OF_KIND = {1: 1, 2: 3, 3: 6}


class FileError(Exception):
    """A file that cannot be read; the message names it."""


@dataclass
class Mesh:
    """Arrays of a mesh; node indices count from 0, references and CAD ids are as in the file."""

    points: np.ndarray
    point_refs: np.ndarray
    edges: np.ndarray
    edge_refs: np.ndarray
    triangles: np.ndarray
    triangle_refs: np.ndarray
    tets: np.ndarray
    tet_refs: np.ndarray
    corners: np.ndarray
    # vertex → CAD vertex / edge / face: columns (vertex from 0, id)
    on_vertices: np.ndarray
    on_edges: np.ndarray
    on_faces: np.ndarray
    parameters_on_edges: np.ndarray
    parameters_on_faces: np.ndarray
    skipped: list = field(default_factory=list)


def read_mesh(path):
    """Reads .mesh or .meshb, told apart by the first bytes."""
    rows, skipped = _read(path)

    def table(code):
        name, before, reals, after = ENTITIES[code]
        ints, values = rows.get(code, (np.zeros((0, before + after), np.int64), np.zeros((0, reals))))
        return ints, values

    def cells(code):
        ints, _ = table(code)
        return ints[:, :-1] - 1, ints[:, -1]

    def pairs(code):
        ints, values = table(code)
        return ints - [1, 0], values

    refs, points = table(4)
    if len(points) == 0:
        raise FileError(f"{path}: no vertices")
    edges, triangles, tets = cells(5), cells(6), cells(8)
    corners = table(13)[0][:, 0] - 1
    on_vertices, on_edges, on_faces = pairs(40), pairs(41), pairs(42)
    for name, index in [("Edges", edges[0]), ("Triangles", triangles[0]), ("Tetrahedra", tets[0]), ("Corners", corners),
                        ("VerticesOnGeometricVertices", on_vertices[0][:, 0]), ("VerticesOnGeometricEdges", on_edges[0][:, 0]),
                        ("VerticesOnGeometricTriangles", on_faces[0][:, 0])]:
        if index.size and (index.min() < 0 or index.max() >= len(points)):
            raise FileError(f"{path}: {name}: a vertex index out of 1..{len(points)}")
    if not np.isfinite(points).all():
        raise FileError(f"{path}: Vertices: a coordinate is not finite")
    return Mesh(points, refs[:, 0], *edges, *triangles, *tets, corners, on_vertices[0], on_edges[0], on_faces[0],
                on_edges[1], on_faces[1], skipped)


def read_fields(path):
    """Reads a solution; returns the kinds of its fields (1 scalar, 2 vector, 3 symmetric tensor) and all values, shape (n, sum)."""
    raw = Path(path).read_bytes()
    if raw[:4] in (b"\1\0\0\0", b"\0\0\0\1"):
        return _binary_solution(path, raw)
    return _ascii_solution(path, raw)


def read_metric(path):
    """Reads a solution with one symmetric tensor a vertex; returns matrices, shape (n, 3, 3)."""
    kinds, values = read_fields(path)
    if kinds != [3]:
        raise FileError(f"{path}: expected one symmetric tensor a vertex (type 3), found types {kinds}")
    # order of the file: 11 12 22 13 23 33
    return values[:, [0, 1, 3, 1, 2, 4, 3, 4, 5]].reshape(-1, 3, 3)


def _read(path):
    raw = Path(path).read_bytes()
    if raw[:4] in (b"\1\0\0\0", b"\0\0\0\1"):
        return _binary_mesh(path, raw)
    return _ascii_mesh(path, raw)


class _Binary:
    """Keywords of a binary file: version and byte order from the head, then a chain of (code, next) blocks."""

    def __init__(self, path, raw):
        self.path, self.raw = path, raw
        self.order = "<" if raw[:4] == b"\1\0\0\0" else ">"
        self.version = self.unpack("i", 4)[0]
        if self.version not in (1, 2, 3, 4):
            raise FileError(f"{path}: libMeshb version {self.version}, expected 1 to 4")
        self.position = "q" if self.version >= 3 else "i"
        self.integer = "i8" if self.version == 4 else "i4"
        self.real = "f4" if self.version == 1 else "f8"

    def unpack(self, kinds, at):
        form = self.order + kinds
        if at + struct.calcsize(form) > len(self.raw):
            raise FileError(f"{self.path}: cut at byte {at}")
        return struct.unpack_from(form, self.raw, at)

    def blocks(self):
        """Yields (code, offset of the content)."""
        at, size = 8, struct.calcsize("<" + self.position)
        while at < len(self.raw):
            code = self.unpack("i", at)[0]
            if code == END:
                return
            follow = self.unpack(self.position, at + 4)[0]
            yield code, at + 4 + size
            if follow <= at:
                return
            at = follow

    def count(self, at):
        kind = "q" if self.version == 4 else "i"
        return self.unpack(kind, at)[0], at + struct.calcsize("<" + kind)

    def rows(self, dtype, count, at):
        kind = np.dtype(dtype)
        if count < 0 or at + count * kind.itemsize > len(self.raw):
            raise FileError(f"{self.path}: {count} rows at byte {at} do not fit into the file")
        return np.frombuffer(self.raw, kind, count, at)


def _binary_mesh(path, raw):
    file, rows, skipped = _Binary(path, raw), {}, []
    for code, at in file.blocks():
        if code == DIMENSION:
            if file.unpack("i", at)[0] != 3:
                raise FileError(f"{path}: not of dimension 3")
        elif code not in ENTITIES:
            skipped.append(code)
        else:
            _, before, reals, after = ENTITIES[code]
            count, at = file.count(at)
            columns = [("a", file.order + file.integer, before), ("x", file.order + file.real, reals),
                       ("b", file.order + file.integer, after)]
            table = file.rows([(n, k, (w,)) for n, k, w in columns if w], count, at)
            ints = [table[n].astype(np.int64) for n, _, w in columns if w and n != "x"]
            values = table["x"].astype(float) if reals else np.zeros((count, 0))
            rows[code] = (np.hstack(ints), values)
    return rows, skipped


def _ascii_mesh(path, raw):
    lines = (line.split("#")[0] for line in raw.decode("ascii", "replace").splitlines())
    words = " ".join(lines).split()
    rows, skipped, at = {}, [], 0
    while at < len(words):
        word = words[at].lower()
        at += 1
        if word == "end":
            break
        if word in ("meshversionformatted", "dimension"):
            at += 1
        elif word in CODES:
            code = CODES[word]
            _, before, reals, after = ENTITIES[code]
            count, width = int(words[at]), before + reals + after
            text = words[at + 1 : at + 1 + count * width]
            if len(text) != count * width:
                raise FileError(f"{path}: {word}: {count} rows promised, the file ends before")
            table = np.array(text).reshape(count, width)
            ints = np.hstack([table[:, :before], table[:, before + reals :]]).astype(np.int64)
            rows[code] = (ints, table[:, before : before + reals].astype(float))
            at += 1 + count * width
        elif not _is_number(word):
            skipped.append(word)
    return rows, skipped


def _is_number(word):
    try:
        float(word)
    except ValueError:
        return False
    return True


def _binary_solution(path, raw):
    file = _Binary(path, raw)
    for code, at in file.blocks():
        if code == SOL_AT_VERTICES:
            count, at = file.count(at)
            number = file.unpack("i", at)[0]
            kinds = list(file.unpack(f"{number}i", at + 4))
            width = sum(VALUES_OF_KIND[kind] for kind in kinds)
            table = file.rows([("x", file.order + file.real, (width,))], count, at + 4 + 4 * number)
            return kinds, table["x"].astype(float)
    raise FileError(f"{path}: no SolAtVertices")


def _ascii_solution(path, raw):
    words = raw.decode("ascii", "replace").split()
    lower = [word.lower() for word in words[:40]]
    if "solatvertices" not in lower:
        raise FileError(f"{path}: no SolAtVertices")
    at = lower.index("solatvertices") + 1
    count, number = int(words[at]), int(words[at + 1])
    kinds = [int(word) for word in words[at + 2 : at + 2 + number]]
    width = sum(VALUES_OF_KIND[kind] for kind in kinds)
    values = words[at + 2 + number : at + 2 + number + count * width]
    if len(values) != count * width:
        raise FileError(f"{path}: {count} rows of {width} values promised, the file ends before")
    return kinds, np.array(values, float).reshape(count, width)


def write_mesh(path, mesh):
    """Writes .meshb, version 2, little-endian."""
    blocks = [
        (4, [(mesh.points, "<f8"), (mesh.point_refs[:, None], "<i4")]),
        (5, [(mesh.edges + 1, "<i4"), (mesh.edge_refs[:, None], "<i4")]),
        (6, [(mesh.triangles + 1, "<i4"), (mesh.triangle_refs[:, None], "<i4")]),
        (8, [(mesh.tets + 1, "<i4"), (mesh.tet_refs[:, None], "<i4")]),
        (13, [(mesh.corners[:, None] + 1, "<i4")]),
    ]
    _write_blocks(path, [(code, struct.pack("<i", len(parts[0][0])) + _pack(parts)) for code, parts in blocks])


def write_metric(path, matrices):
    """Writes .solb, version 2, little-endian, one symmetric tensor a vertex."""
    values = matrices.reshape(-1, 9)[:, [0, 1, 4, 2, 5, 8]]
    head = struct.pack("<iii", len(values), 1, 3)
    _write_blocks(path, [(SOL_AT_VERTICES, head + _pack([(values, "<f8")]))])


def write_scalars(path, values):
    """Writes .solb, version 2, little-endian, `values` of shape (n, k) as k scalars a vertex."""
    head = struct.pack(f"<ii{values.shape[1]}i", len(values), values.shape[1], *[1] * values.shape[1])
    _write_blocks(path, [(SOL_AT_VERTICES, head + _pack([(values, "<f8")]))])


def _pack(parts):
    """Rows of several arrays side by side, as bytes."""
    columns = [np.ascontiguousarray(values).astype(kind) for values, kind in parts]
    count = len(columns[0])
    return np.hstack([column.view(np.uint8).reshape(count, -1) for column in columns]).tobytes() if count else b""


def _write_blocks(path, blocks):
    out = bytearray(struct.pack("<iiiii", 1, 2, DIMENSION, 20, 3))
    for code, content in blocks:
        out += struct.pack("<ii", code, len(out) + 8 + len(content)) + content
    out += struct.pack("<ii", END, 0)
    Path(path).write_bytes(out)
