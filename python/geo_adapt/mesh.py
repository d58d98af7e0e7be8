"""Tetrahedral meshes as arrays."""

from __future__ import annotations

import json
import os
import tempfile
import warnings
import webbrowser
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _kernel, program
from .errors import InputError

if TYPE_CHECKING:
    import meshio
    import pyvista

    from .model import Model
    from .tensors import Floats

Ints = npt.NDArray[np.int32]
Nodes = npt.NDArray[np.uint32]


def _nodes(what: str, given: npt.ArrayLike | None, width: int | None, most: int) -> Nodes:
    """Node numbers as uint32: those of int32 and uint32 as they are, others converted, which is a copy."""
    if given is None:
        return np.empty((0, width) if width else 0, np.uint32)
    array = np.asarray(given)
    if array.size == 0:
        return np.empty((0, width) if width else 0, np.uint32)
    if array.dtype.kind not in "iu":
        raise InputError(f"{what}: numbers of type {array.dtype}; give integers, counting from 0")
    if array.ndim != (2 if width else 1) or (width and array.shape[1] != width):
        raise InputError(f"{what}: shape {array.shape}; give (n, {width})" if width else f"{what}: give shape (n,)")
    if array.min() < 0 or array.max() >= most:
        at = int(np.argmax((array < 0) | (array >= most)) // (width or 1))
        raise InputError(f"{what} {at} refers to what is not there: numbers count from 0 and there are {most}")
    contiguous = np.ascontiguousarray(array)
    # The same bits, now that they are known not to be negative.
    return contiguous.view(np.uint32) if array.dtype == np.int32 else contiguous.astype(np.uint32, copy=False)


def _references(what: str, given: npt.ArrayLike | None, count: int, usual: int) -> Ints:
    if given is None:
        return np.full(count, usual, np.int32)
    array = np.asarray(given)
    if array.size != count or array.ndim != 1:
        raise InputError(f"{what}: shape {array.shape}, but ({count},) is wanted: give one each")
    if array.size and array.dtype.kind not in "iu":
        raise InputError(f"{what}: numbers of type {array.dtype}; give integers")
    return np.ascontiguousarray(array, dtype=np.int32)


def _warn(notices: Sequence[str]) -> None:
    """Warns the caller of the function that calls this."""
    for notice in notices:
        warnings.warn(notice, stacklevel=3)


class Mesh:
    """A tetrahedral mesh with its triangles, references and names.

    Contiguous arrays of float64 (points), int32 or uint32 (nodes) and int32 (references) are taken as they are, without a copy: the
    mesh has them in common with the caller. Nodes of int64 are converted, since the kernel counts with 32 bits.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Coordinates, in the model's units.
    tets : array_like of int, shape (t, 4)
        Nodes of the tetrahedra, from 0; node 3 on the side that the right-hand normal of nodes 0, 1, 2 points to.
    triangles : array_like of int, shape (m, 3), optional
        Triangles on the boundary and between regions. `adapt` adds those that are missing.
    references : array_like of int, shape (m,), optional
        The surface that each triangle is of; on a CAD model its face, from 1. By default 0.
    names : mapping of str to sequence of int, optional
        Names of surfaces: ``{"inlet": [3]}`` calls the triangles of reference 3 so.
    tet_references : array_like of int, shape (t,), optional
        The region of each tetrahedron. By default 1.
    edges, edge_references : array_like of int, shapes (k, 2) and (k,), optional
        Edges that are ridges, with their references.
    point_references : array_like of int, shape (n,), optional
        References of the points. By default 0.
    corners, required_points, required_edges, required_triangles : array_like of int, optional
        Points that are corners, and what must stay: indices into `points`, `edges`, `triangles`.
    fields : mapping of str to array_like, optional
        Values at the points: (n,) scalars, (n, 3) vectors, (n, 6) symmetric tensors in the order "medit", (n, 3, 3) tensors.

    Attributes
    ----------
    points, tets, triangles, edges, point_references, tet_references, triangle_references, edge_references : ndarray
        As they were given: of float64 the points, of 32 bits the nodes and references.
    corners, required_points, required_edges, required_triangles : ndarray
        As they were given.
    fields : dict of str to ndarray
        Values at the points. Put others in as you like: `write` writes them, `view` colours by them.
    domain : Model or None
        The model of the domain that `bootstrap` meshed, where it is not the one that was given: a far field, a healed model.

    Raises
    ------
    InputError
        When arrays are of other shapes or types, or refer to what is not there.

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> mesh = geo_adapt.Mesh(points, np.array([[0, 1, 2, 3]]))
    >>> mesh.points is points, mesh.volume
    (True, 0.16666666666666666)
    """

    def __init__(
        self,
        points: npt.ArrayLike,
        tets: npt.ArrayLike,
        triangles: npt.ArrayLike | None = None,
        references: npt.ArrayLike | None = None,
        names: Mapping[str, Sequence[int]] | None = None,
        *,
        tet_references: npt.ArrayLike | None = None,
        edges: npt.ArrayLike | None = None,
        edge_references: npt.ArrayLike | None = None,
        point_references: npt.ArrayLike | None = None,
        corners: npt.ArrayLike | None = None,
        required_points: npt.ArrayLike | None = None,
        required_edges: npt.ArrayLike | None = None,
        required_triangles: npt.ArrayLike | None = None,
        fields: Mapping[str, npt.ArrayLike] | None = None,
    ) -> None:
        given = np.asarray(points)
        if given.ndim != 2 or given.shape[1] != 3 or given.dtype.kind not in "fiu":
            raise InputError(f"points: shape {given.shape} of {given.dtype}; give numbers of shape (n, 3)")
        self.points: Floats = np.ascontiguousarray(given, dtype=np.float64)
        count = len(self.points)
        self.tets = _nodes("tetrahedron", tets, 4, count)
        self.triangles = _nodes("triangle", triangles, 3, count)
        self.edges = _nodes("edge", edges, 2, count)
        self.point_references = _references("point_references", point_references, count, 0)
        self.tet_references = _references("tet_references", tet_references, len(self.tets), 1)
        self.triangle_references = _references("references", references, len(self.triangles), 0)
        self.edge_references = _references("edge_references", edge_references, len(self.edges), 0)
        self.corners = _nodes("corner", corners, None, count)
        self.required_points = _nodes("required point", required_points, None, count)
        self.required_edges = _nodes("required edge", required_edges, None, len(self.edges))
        self.required_triangles = _nodes("required triangle", required_triangles, None, len(self.triangles))
        self.fields: dict[str, Floats] = {}
        for name, values in (fields or {}).items():
            self.fields[name] = np.asarray(values, dtype=np.float64)
        # As the names file has them: {"triangles": {"3": {"name": "inlet"}}, …}.
        self._labels: dict[str, dict[str, dict[str, str]]] = {}
        for name, numbers in (names or {}).items():
            for number in numbers:
                self._labels.setdefault("triangles", {})[str(int(number))] = {"name": str(name)}
        self._association: _kernel.Associated | None = None
        self.domain: Model | None = None

    @property
    def references(self) -> Ints:
        """The surface of each triangle, shape (m,): `triangle_references`."""
        return self.triangle_references

    @property
    def names(self) -> dict[str, list[int]]:
        """Names of surfaces, with the references that are called so."""
        return self._called("triangles")

    @property
    def region_names(self) -> dict[str, list[int]]:
        """Names of regions, with the references of tetrahedra that are called so."""
        return self._called("tetrahedra")

    def _called(self, kind: str) -> dict[str, list[int]]:
        called: dict[str, list[int]] = {}
        for number, label in self._labels.get(kind, {}).items():
            if label.get("name"):
                called.setdefault(label["name"], []).append(int(number))
        return called

    def on(self, name: str | int) -> Nodes:
        """Points on a surface, ascending, by name or reference.

        Parameters
        ----------
        name : str or int
            A name of `names`, or a reference.

        Returns
        -------
        ndarray of uint32, shape (k,)

        Raises
        ------
        InputError
            When nothing is called so.

        Examples
        --------
        >>> import geo_adapt
        >>> geo_adapt.examples.cube(2).on("x=0").size
        9
        """
        return np.unique(self.triangles[np.isin(self.triangle_references, self.surface(name))])

    def surface(self, name: str | int) -> list[int]:
        """The references of surfaces that a name stands for, or the reference itself."""
        if not isinstance(name, str):
            return [int(name)]
        found = self.names.get(name)
        if found is None:
            known = ", ".join(self.names) or "none"
            raise InputError(f"no surface is called {name!r}; there are: {known}")
        return found

    @property
    def volume(self) -> float:
        """The volume of the tetrahedra, in length³."""
        a, b, c, d = (self.points[self.tets[:, k]] for k in range(4))
        return float(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a).sum() / 6.0)

    @classmethod
    def _of(cls, arrays: dict[str, Any], labels: str) -> Mesh:
        """Of the kernel's arrays, which are good as they are."""
        mesh = cls.__new__(cls)
        mesh._association = arrays.pop("association", None)
        mesh.__dict__.update(arrays)
        mesh.fields = {}
        mesh._labels = json.loads(labels)
        mesh.domain = None
        return mesh

    @classmethod
    def read(cls, path: str | os.PathLike[str], threads: int | None = None) -> Mesh:
        """Reads a mesh of any format that the program knows, with its names and the fields in the same file.

        Parameters
        ----------
        path : path
            .mesh, .meshb, .su2, .vtu, .vtk, .msh, .ugrid, .inp, .nas, .stl, …; or a case of OpenFOAM.
        threads : int, optional
            By default all cores.

        Returns
        -------
        Mesh

        Raises
        ------
        FileError
            When it cannot be read; the message names the place.

        Warns
        -----
        UserWarning
            Of what was left out or mended on the way.
        """
        arrays, labels, fields, notices = _kernel.read_mesh(os.fspath(path), threads or 0)
        mesh = cls._of(arrays, labels)
        for name, values in fields:
            mesh.fields[name] = _shaped(values)
        _warn(notices)
        return mesh

    def write(self, path: str | os.PathLike[str], threads: int | None = None) -> None:
        """Writes the mesh with its names and fields, in the format that the ending tells.

        Parameters
        ----------
        path : path
            As in `read`. Beside .mesh and .meshb come NAME.names.json and, where there are fields, NAME.solb.
        threads : int, optional
            By default all cores.

        Raises
        ------
        FileError
            When it cannot be written.

        Warns
        -----
        UserWarning
            Of what the format cannot carry.
        """
        count = len(self.points)
        fields = [(name, np.ascontiguousarray(values.reshape(count, -1))) for name, values in self.fields.items()]
        lost = _kernel.write_mesh(os.fspath(path), self, json.dumps(self._labels), fields, threads or 0)
        _warn(lost)

    @classmethod
    def from_meshio(cls, mesh: meshio.Mesh) -> Mesh:
        """Of meshio's mesh: its blocks "tetra", "triangle" and "line", references of "medit:ref" or "gmsh:physical", and point data."""
        from . import views

        return views.from_meshio(mesh)

    def to_meshio(self) -> meshio.Mesh:
        """As meshio's mesh, with references as "medit:ref"."""
        from . import views

        return views.to_meshio(self)

    @classmethod
    def from_pyvista(cls, grid: pyvista.DataSet) -> Mesh:
        """Of pyvista's grid: its tetrahedra and triangles, references of the cell data "reference", and point data."""
        from . import views

        return views.from_pyvista(grid)

    def to_pyvista(self, triangles: bool = False) -> pyvista.UnstructuredGrid:
        """As pyvista's grid of the tetrahedra, with the fields as point data and the cell data "reference"; with triangles behind them if asked for."""
        from . import views

        return views.to_pyvista(self, triangles)

    def view(self, field: str | None = None, **options: object) -> Any:
        """Shows the mesh: in a notebook as a page within it, elsewhere in the browser.

        Parameters
        ----------
        field : str, optional
            The field to be coloured by.
        **options
            Those of ``geo-adapt view``, as in `write_page`.

        Returns
        -------
        IPython.display.HTML or Path
            In a notebook what shows the page; else the file of the page.
        """
        return _shown(lambda page: self.write_page(page, field, **options))

    def write_page(self, path: str | os.PathLike[str], field: str | None = None, **options: object) -> None:
        """Writes a page for the browser (.html), or a picture (.png): those of ``geo-adapt view``.

        Parameters
        ----------
        path : path
            The file.
        field : str, optional
            The field to be coloured by.
        **options
            Those of ``geo-adapt view``, such as ``cut="z=0.5"``, ``hide="farfield"``, ``no_wire=True``; of a picture also
            ``size="760x520"``, ``view="215,25"`` (azimuth and elevation, degrees), ``zoom=2``.

        Raises
        ------
        ProgramError
            When it cannot be written, or an option is not known.

        Examples
        --------
        >>> import geo_adapt, pathlib, tempfile
        >>> path = pathlib.Path(tempfile.mkdtemp(), "cube.png")
        >>> geo_adapt.examples.cube(3).write_page(path, size="320x240", cut="x=0.5")
        >>> path.read_bytes()[1:4]
        b'PNG'
        """
        with program.folder() as place:
            file = Path(place) / "mesh.vtu"
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                self.write(file)
            is_picture = Path(path).suffix.lower() == ".png"
            target = ["--png" if is_picture else "-o", path]
            chosen = {"title": Path(path).stem, "color": field, **options}
            program.run(["view", file, *target, *program.options(**chosen)])

    def __repr__(self) -> str:
        called = f", {len(self.names)} named surfaces" if self.names else ""
        return f"<geo_adapt.Mesh: {len(self.points)} points, {len(self.tets)} tetrahedra, {len(self.triangles)} triangles{called}>"

    def _repr_html_(self) -> str:
        from html import escape

        least, most = self.points.min(axis=0, initial=np.inf), self.points.max(axis=0, initial=-np.inf)
        box = " × ".join(f"{a:.4g} … {b:.4g}" for a, b in zip(least, most, strict=True)) if len(self.points) else "empty"
        called = ", ".join(f"{escape(name)} ({', '.join(map(str, of))})" for name, of in self.names.items()) or "none"
        fields = ", ".join(f"{escape(name)} {values.shape[1:] or ''}" for name, values in self.fields.items()) or "none"
        rows = {
            "points": len(self.points),
            "tetrahedra": len(self.tets),
            "triangles": len(self.triangles),
            "box": box,
            "surfaces": called,
            "fields": fields,
        }
        cells = "".join(f"<tr><th>{name}</th><td>{value}</td></tr>" for name, value in rows.items())
        return f"<table>{cells}</table>"


def _shown(write: Callable[[Path], None]) -> Any:
    """Shows the page that is written: in a notebook as a page within it, elsewhere in the browser."""
    page = Path(tempfile.mkdtemp(prefix="geo-adapt-view-")) / "mesh.html"
    write(page)
    try:
        shell = __import__("IPython").get_ipython()
    except ImportError:
        shell = None
    if shell is not None and hasattr(shell, "kernel"):
        from html import escape

        text = escape(page.read_text(encoding="utf-8"), quote=True)
        html = f'<iframe srcdoc="{text}" width="100%" height="600" style="border:0"></iframe>'
        return __import__("IPython.display", fromlist=["HTML"]).HTML(html)
    webbrowser.open(page.as_uri())
    return page


def _shaped(values: Floats) -> Floats:
    """Fields as users have them: (n,) scalars, (n, 3, 3) tensors, others as they are."""
    if values.shape[1] == 1:
        return values[:, 0]
    return values.reshape(-1, 3, 3) if values.shape[1] == 9 else values


def read_sol(path: str | os.PathLike[str], threads: int | None = None) -> list[Floats]:
    """Reads the fields of a .sol or .solb file.

    Parameters
    ----------
    path : path
        The file.
    threads : int, optional
        By default all cores.

    Returns
    -------
    list of ndarray
        In the order of the file: (n,) scalars, (n, 3) vectors, (n, 6) symmetric tensors in the order "medit" (a metric: 1/length²),
        (n, 3, 3) tensors.

    Raises
    ------
    FileError
        When it cannot be read.

    Examples
    --------
    >>> import numpy as np, geo_adapt, tempfile, os
    >>> path = os.path.join(tempfile.mkdtemp(), "u.solb")
    >>> geo_adapt.write_sol(path, [1.0, 2.0], np.eye(3)[:2])
    >>> [field.shape for field in geo_adapt.read_sol(path)]
    [(2,), (2, 3)]
    """
    fields, notices = _kernel.read_sol(os.fspath(path), threads or 0)
    _warn(notices)
    return [_shaped(field) for field in fields]


def write_sol(path: str | os.PathLike[str], *fields: npt.ArrayLike, threads: int | None = None) -> None:
    """Writes fields as .sol (text) or .solb.

    Parameters
    ----------
    path : path
        The file.
    *fields : array_like
        (n,) scalars, (n, 3) vectors, (n, 6) symmetric tensors in the order "medit", (n, 3, 3) tensors of nine terms.
    threads : int, optional
        By default all cores.

    Raises
    ------
    FileError
        When it cannot be written.
    InputError
        When fields have other shapes, or different numbers of rows.
    """
    rows = [np.asarray(field, dtype=np.float64) for field in fields]
    if any(row.ndim == 0 for row in rows):
        raise InputError("fields: give arrays with a row a point")
    _kernel.write_sol(os.fspath(path), [np.ascontiguousarray(row.reshape(len(row), -1)) for row in rows], threads or 0)
