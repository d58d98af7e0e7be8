"""pyvista and meshio: meshes to and from theirs. pyvista finds `read` and `write` by its entry points once the package is installed.

>>> import geo_adapt, geo_adapt.views
>>> mesh = geo_adapt.examples.cube(2)
>>> again = geo_adapt.Mesh.from_meshio(mesh.to_meshio())
>>> (again.tets == mesh.tets).all() and (again.references == mesh.references).all()
np.True_
"""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError
from .mesh import Mesh, read_sol

if TYPE_CHECKING:
    import meshio
    import pyvista

#: What the cell data with references is called: here, in meshio's .mesh files, in those of gmsh.
_REFERENCES = ("reference", "medit:ref", "gmsh:physical")


def _references(data: Any) -> Any:
    return next((data[name] for name in _REFERENCES if name in data), None)


def _joined(parts: list[Any], references: list[Any]) -> tuple[Any, Any]:
    """Blocks of one kind as one, with references where all have them."""
    if not parts:
        return None, None
    known = all(one is not None for one in references)
    return np.concatenate(parts), np.concatenate(references).astype(np.int32) if known else None


def _made(points: Any, cells: dict[str, tuple[Any, Any]], fields: dict[str, Any]) -> Mesh:
    tets, tet_references = cells["tetra"]
    triangles, references = cells["triangle"]
    edges, edge_references = cells["line"]
    if tets is None and triangles is None:
        raise InputError("there are neither tetrahedra nor triangles")
    return Mesh(
        points,
        np.empty((0, 4), np.uint32) if tets is None else tets,
        triangles,
        references,
        tet_references=tet_references,
        edges=edges,
        edge_references=edge_references,
        fields=fields,
    )


def from_meshio(given: meshio.Mesh) -> Mesh:
    """Of meshio's mesh: see `Mesh.from_meshio`."""
    cells: dict[str, tuple[Any, Any]] = {}
    data = {name: given.cell_data[name] for name in _REFERENCES if name in given.cell_data}
    for kind in ("tetra", "triangle", "line"):
        chosen = [number for number, block in enumerate(given.cells) if block.type == kind]
        blocks = [given.cells[number].data for number in chosen]
        cells[kind] = _joined(blocks, [_references({k: v[number] for k, v in data.items()}) for number in chosen])
    others = {block.type for block in given.cells} - {"tetra", "triangle", "line", "vertex"}
    if others:
        raise InputError(f"cells of other kinds: {', '.join(sorted(others))}; give tetrahedra")
    points = np.asarray(given.points, dtype=np.float64)
    fields = {name: values for name, values in given.point_data.items() if name not in _REFERENCES}
    return _made(points, cells, fields)


def to_meshio(mesh: Mesh) -> meshio.Mesh:
    """As meshio's mesh: see `Mesh.to_meshio`."""
    import meshio

    blocks: list[tuple[str, Any]] = [("tetra", mesh.tets)]
    references: list[Any] = [mesh.tet_references]
    for kind, nodes, marks in (
        ("triangle", mesh.triangles, mesh.triangle_references),
        ("line", mesh.edges, mesh.edge_references),
    ):
        if len(nodes):
            blocks.append((kind, nodes))
            references.append(marks)
    return meshio.Mesh(mesh.points, blocks, point_data=dict(mesh.fields), cell_data={"medit:ref": references})


def from_pyvista(grid: pyvista.DataSet) -> Mesh:
    """Of pyvista's grid: see `Mesh.from_pyvista`."""
    unstructured = grid.cast_to_unstructured_grid()
    marks = _references(unstructured.cell_data)
    kinds = {"tetra": 10, "triangle": 5, "line": 3}
    others = set(np.unique(unstructured.celltypes).tolist()) - {*kinds.values(), 1}
    if others:
        raise InputError(f"cells of other kinds: VTK's types {sorted(others)}; give tetrahedra")
    cells: dict[str, tuple[Any, Any]] = {}
    by_type: dict[int, Any] = {int(kind): nodes for kind, nodes in unstructured.cells_dict.items()}
    for kind, number in kinds.items():
        if number not in by_type:
            cells[kind] = (None, None)
            continue
        here = None if marks is None else np.asarray(marks)[unstructured.celltypes == number].astype(np.int32)
        cells[kind] = (by_type[number], here)
    fields = {name: np.asarray(unstructured.point_data[name]) for name in unstructured.point_data}
    return _made(np.asarray(unstructured.points, dtype=np.float64), cells, fields)


def to_pyvista(mesh: Mesh, triangles: bool = False) -> pyvista.UnstructuredGrid:
    """As pyvista's grid: see `Mesh.to_pyvista`."""
    import pyvista

    cells: dict[Any, Any] = {pyvista.CellType.TETRA: mesh.tets} if len(mesh.tets) else {}
    marks = [mesh.tet_references] if len(mesh.tets) else []
    if triangles or not len(mesh.tets):
        cells[pyvista.CellType.TRIANGLE] = mesh.triangles
        marks.append(mesh.triangle_references)
    grid = pyvista.UnstructuredGrid({kind: nodes.astype(np.int64) for kind, nodes in cells.items()}, mesh.points)
    grid.cell_data["reference"] = np.concatenate(marks)
    for name, values in mesh.fields.items():
        grid.point_data[name] = values.reshape(len(values), -1) if values.ndim > 1 else values
    return grid


def read(path: str, **_: Any) -> pyvista.UnstructuredGrid:
    """What `pyvista.read` calls for .mesh and .meshb: the grid, with the fields of a .solb or .sol beside it."""
    mesh = Mesh.read(path)
    stem = os.path.splitext(path)[0]
    for beside in (f"{stem}.solb", f"{stem}.sol"):
        if os.path.isfile(beside):
            found = read_sol(beside)
            if all(len(field) == len(mesh.points) for field in found):
                mesh.fields.update({f"field{number}": field for number, field in enumerate(found)})
            else:
                warnings.warn(f"{beside}: of another number of points, left out", stacklevel=2)
            break
    return to_pyvista(mesh)


def write(dataset: pyvista.DataSet, path: str, **_: Any) -> None:
    """What `dataset.save("a.meshb")` of pyvista calls."""
    from_pyvista(dataset).write(path)
