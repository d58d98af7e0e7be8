"""First meshes, meshes put on a model, fields brought from mesh to mesh, meshes judged."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy.typing as npt

from . import _kernel, program
from .errors import InputError
from .mesh import Mesh, _shaped
from .model import Model
from .tensors import Floats, packed, rows


def bootstrap(
    model: Model | str | os.PathLike[str],
    size: float | None = None,
    *,
    segments: float | None = None,
    feature_cells: float | None = None,
    complexity: float | None = None,
    far_field: str | None = None,
    symmetry: str | None = None,
    heal: float | bool | None = None,
    mesher: str | None = None,
    time_limit: float | None = None,
    threads: int | None = None,
) -> Mesh:
    """Makes the first mesh of a CAD model: that of ``geo-adapt bootstrap``, bit for bit.

    Parameters
    ----------
    model : Model, or path
        A CAD model; or the file of a closed surface of triangles (.stl, .obj, .ply, …).
    size : float, optional
        Greatest size, in the model's units. By default a tenth of its diagonal.
    segments : float, optional
        Segments for a radian of curvature. By default 2.
    feature_cells : float, optional
        Cells across thin parts and gaps. By default 2.
    complexity : float, optional
        Greatest complexity, about half the number of points. By default 100000.
    far_field : str, optional
        Meshes the space around the solids: "box:10", "sphere:20", …, as the program's option. The domain's model is
        ``mesh.domain`` then: adapt on it.
    symmetry : {"x", "y", "z"}, optional
        Cuts the far field there.
    heal : float or True, optional
        Heals the model first: shorter edges are collapsed. The healed model is ``mesh.domain`` then.
    mesher : {"auto", "own", "gmsh", "netgen"}, optional
        Who makes the mesh. gmsh and netgen are programs of their own, started where they are installed.
    time_limit : float, optional
        Seconds for all attempts. By default 120.
    threads : int, optional
        By default all cores.

    Returns
    -------
    Mesh
        With the numbers of the model's faces as references, its names, and the metric it was made for as the field "metric".

    Raises
    ------
    ProgramError
        When the model cannot be meshed; the message says where.

    Examples
    --------
    >>> import geo_adapt
    >>> mesh = geo_adapt.bootstrap(geo_adapt.Model(geo_adapt.examples.cylinder()), size=0.8)
    >>> sorted(set(mesh.references.tolist()))
    [1, 2, 3]
    """
    with program.folder() as name:
        place = Path(name)
        file = model._file(place) if isinstance(model, Model) else Path(model)
        out = place / "mesh.meshb"
        options = program.options(
            size=size,
            segments=segments,
            feature_cells=feature_cells,
            complexity=complexity,
            far_field=far_field,
            symmetry=symmetry,
            heal=heal,
            mesher=mesher,
            time_limit=time_limit,
            threads=threads,
        )
        program.run(["bootstrap", file, "-o", out, *options])
        mesh = Mesh.read(out, threads)
        metric = out.with_suffix(".solb")
        if metric.is_file():
            mesh.fields["metric"] = _shaped(_kernel.read_sol(os.fspath(metric), threads or 0)[0][0])
        made = out.with_suffix(".brep")
        if made.is_file():
            labels = json.loads(Path(f"{made}.names.json").read_text()) if Path(f"{made}.names.json").is_file() else {}
            if not labels and made.with_suffix(".names.json").is_file():
                labels = json.loads(made.with_suffix(".names.json").read_text())
            mesh.domain = Model(made.read_bytes())
            mesh.domain._labels = {k: v for k, v in labels.items() if k in ("triangles", "edges", "tetrahedra")}
            mesh.domain._load()
        return mesh


def classify(mesh: Mesh, model: Model, *, tolerance: float | None = None) -> Mesh:
    """Puts the boundary of a mesh on the entities of a CAD model.

    Parameters
    ----------
    mesh : Mesh
        A mesh whose boundary points lie on the model.
    model : Model
        The model.
    tolerance : float, optional
        How far a point may be from it, in its units.

    Returns
    -------
    Mesh
        The same mesh, with the numbers of faces as references of its triangles, the model's names, and its place on the model, which
        `write` keeps in .mesh and .meshb.

    Raises
    ------
    ProgramError
        When the mesh does not fit the model; the message says where.

    Examples
    --------
    >>> import geo_adapt
    >>> model = geo_adapt.Model(geo_adapt.examples.cylinder())
    >>> mesh = geo_adapt.bootstrap(model, threads=1)
    >>> plain = geo_adapt.Mesh(mesh.points, mesh.tets)
    >>> sorted(set(geo_adapt.classify(plain, model).references.tolist()))
    [1, 2, 3]
    """
    with program.folder() as name:
        place = Path(name)
        given, out = place / "in.meshb", place / "out.meshb"
        bare = mesh.fields
        try:
            mesh.fields = {}
            mesh.write(given)
        finally:
            mesh.fields = bare
        program.run(["classify", given, "--cad", model._file(place), "-o", out, *program.options(tolerance=tolerance)])
        found = Mesh.read(out)
    found.fields = dict(bare)
    return found


def transfer(
    old: Mesh,
    values: npt.ArrayLike,
    new: Mesh,
    *,
    conservative: bool | str = False,
    metric: bool = False,
    order: str | None = None,
    threads: int | None = None,
) -> Floats:
    """Brings values from the points of one mesh to those of another: as ``geo-adapt transfer``, bit for bit.

    Parameters
    ----------
    old, new : Mesh
        The mesh that has the values, and the one that gets them.
    values : array_like, shape (n, ...)
        At the points of the old mesh.
    conservative : bool or {"mean", "mass"}
        Keeps the integral of each value, with no new extremum; where the volumes differ "mean" (also True) keeps the integral by the
        volume, "mass" the integral.
    metric : bool
        The values are a metric, and interpolated as one (METHOD.md, 1.2): shape (n, 3, 3), or (n, 6) with its order. The result is (m, 6) in
        the order "medit".
    order : {"medit", "voigt"}, optional
        Of such a metric.
    threads : int, optional
        By default all cores.

    Returns
    -------
    ndarray, shape (m, ...)
        A point outside the old mesh has its nearest values.

    Raises
    ------
    InputError
        When there is not a row for each point.
    MetricError
        When a tetrahedron is inverted, or a metric not positive definite.

    References
    ----------
    F. Alauzet, A parallel matrix-free conservative solution interpolation on unstructured tetrahedral meshes, CMAME 299 (2016).

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> old, new = geo_adapt.examples.cube(2), geo_adapt.examples.cube(3)
    >>> u = geo_adapt.transfer(old, old.points, new)
    >>> bool(abs(u - new.points).max() < 1e-12)
    True
    """
    if metric:
        if conservative:
            raise InputError("a metric is not transferred conservatively: give one of the two")
        return _kernel.transfer(old, packed(values, order), new, "metric", threads or 0)
    table, shape = rows(values, len(old.points), "values")
    found = _kernel.transfer(old, table, new, _method(conservative), threads or 0)
    return found.reshape(len(found), *shape)


def _method(conservative: bool | str) -> str:
    """How values are brought along: "linear", "mean" or "mass"."""
    method = "linear" if conservative is False else "mean" if conservative is True else conservative
    if method not in ("linear", "mean", "mass"):
        raise InputError(f'conservative {conservative!r}: True, "mean" or "mass"')
    return method


def inspect(
    mesh: Mesh,
    metric: npt.ArrayLike | None = None,
    model: Model | None = None,
    *,
    order: str | None = None,
    threads: int | None = None,
) -> dict[str, Any]:
    """Is it a good mesh: the figures of ``geo-adapt inspect --json``.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    metric : array_like, shape (n, 3, 3) or (n, 6), optional
        In which edges and shapes are measured; by default in space.
    model : Model, optional
        The CAD model that it should lie on.
    order : {"medit", "voigt"}, optional
        Of a metric of shape (n, 6).
    threads : int, optional
        By default all cores.

    Returns
    -------
    dict
        "valid": whether it is a valid mesh, and fits the model; "flaws": what is wrong; edge lengths, mean ratios, volume, counts;
        "worst_tet"; "cad": distances from the model. As in the program's report what has a number counts from 1.

    Examples
    --------
    >>> import geo_adapt
    >>> found = geo_adapt.inspect(geo_adapt.examples.cube(2))
    >>> found["valid"], found["flaws"]
    (True, [])
    """
    given = None if metric is None else packed(metric, order)
    text = _kernel.inspect(mesh, given, None if model is None else model._kernel, threads or 0)
    found: dict[str, Any] = json.loads(text)
    return found


__all__: Sequence[str] = ["bootstrap", "classify", "inspect", "transfer"]
