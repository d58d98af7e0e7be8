"""Adapting: the work is done by a thread of its own, while this one looks at signals and tells the progress."""

from __future__ import annotations

import json
import operator
import warnings
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _kernel
from .errors import InputError, MeshError
from .mesh import Mesh, Nodes
from .model import Model
from .tensors import Floats, packed, rows


class Progress(NamedTuple):
    """What the adapter is at.

    Attributes
    ----------
    pass_ : int
        Number of the pass, from 1.
    operation : str
        "insertion", "collapse", "reconnection", "smoothing", "projection" or "repair".
    done, items : int
        How many of its items are done.
    points : int
        Points of the mesh by now, nearly.
    """

    pass_: int
    operation: str
    done: int
    items: int
    points: int


class Parents:
    """Where each new point lies in the mesh that went in.

    Attributes
    ----------
    tets : ndarray of uint32, shape (n,)
        The old tetrahedron that holds it, or the nearest one.
    weights : ndarray, shape (n, 4)
        Barycentric coordinates there: at least 0, of sum 1.
    outside : int
        New points outside the old mesh (on a curved boundary).
    farthest : float
        Greatest distance of one of these from it, length.
    """

    def __init__(self, old: Mesh, tets: Nodes, weights: Floats, outside: int, farthest: float) -> None:
        self._old = old
        self.tets = tets
        self.weights = weights
        self.outside = outside
        self.farthest = farthest

    def interpolate(self, values: npt.ArrayLike) -> Floats:
        """Values at the new points, linear in the old tetrahedra.

        Parameters
        ----------
        values : array_like, shape (old points, ...)
            At the points of the mesh that went in.

        Returns
        -------
        ndarray, shape (n, ...)

        Raises
        ------
        InputError
            When there is not a row for each old point.
        """
        table, shape = rows(values, len(self._old.points), "values")
        found: Floats = np.einsum("nk,nkc->nc", self.weights, table[self._old.tets[self.tets]])
        shaped: Floats = found.reshape(len(found), *shape)
        return shaped


class Result:
    """What came of an adaptation.

    Attributes
    ----------
    mesh : Mesh
        The adapted mesh, with the references and names of the one that went in.
    metric : ndarray, shape (n, 6)
        The metric at its points, in the order "medit": 11 12 22 13 23 33, in 1/length².
    parents : Parents
        Where its points were in the old mesh.
    report : dict
        The figures of ``geo-adapt adapt --json``: counts, edge lengths and mean ratios in the metric, the distance from the model, and in
        ``["forecast"]`` the vertices, seconds and bytes that were expected before the work began. Empty where none was asked for, or the
        work was stopped.
    complexity : float or None
        That the metric was scaled to.
    complete : bool
        Whether it came to its end: False where `progress` stopped it. The mesh is valid in any case.
    growth_end : {None, "not-accounted-for", "max-vertices", "memory"}
        Why the mesh stopped growing before its metric was met: it has far more points than the metric accounts for; as many as it may
        have; there is no memory for more. None where the metric was met. The mesh is valid in any case.
    overgrown : bool
        Whether there is such a reason.
    off_model, held, doubled : ndarray of uint32
        Points of the boundary that found no room on the model; that had to stay; and points of the old mesh that were taken apart.
    chords : tuple of float, int, float; or None
        What was cut of sizes along curved walls: the share of √(8 h R) that they were cut to, at how many points, and by what factor at most.
        None where all were left.
    deviating, crossings : int
        Triangles beyond the bounds of the surface; pairs of triangles in which the boundary crosses itself.
    """

    def __init__(self, old: Mesh, given: dict[str, Any], adapter: Adapter) -> None:
        labels = old._labels or json.loads(given["names"])
        self.mesh = Mesh._of(given["mesh"], json.dumps(labels))
        self.metric: Floats = given["metric"]
        self.parents = Parents(
            old, given["parent_tets"], given["parent_weights"], given["outside"], given["farthest"]
        )
        self.report: dict[str, Any] = json.loads(given["report"]) if given["report"] else {}
        self.complexity: float | None = given["complexity"]
        self.complete: bool = not given["stopped"]
        self.growth_end: str | None = given["growth_end"]
        self.overgrown: bool = self.growth_end is not None
        self.off_model: Nodes = given["off_model"]
        self.held: Nodes = given["held"]
        self.doubled: Nodes = given["doubled"]
        self.chords: tuple[float, int, float] | None = given["chords"]
        self.deviating: int = given["deviating"]
        self.crossings: int = given["crossings"]
        self._place: _kernel.Place = given["place"]
        self._adapter = adapter

    def __repr__(self) -> str:
        how = "" if self.complete else ", stopped"
        return f"<geo_adapt.Result: {len(self.mesh.points)} points, {len(self.mesh.tets)} tetrahedra{how}>"


class Adapter:
    """An adapter that keeps its model and its threads, for loops.

    Parameters
    ----------
    model : Model, optional
        What the boundary lies on. Without it, and without a `surface`, it is the surface of the mesh that comes.
    surface : Mesh, optional
        A mesh whose surface stays the model of all that come.
    threads : int, optional
        By default all cores. The mesh is the same, to the last bit, on any number.
    ridge_angle : float, optional
        Without a model: the angle between triangles, degrees, beyond which their edge is a ridge. By default 45.
    smooth : bool
        Without a model: smooth patches go through the points of the surface; else its triangles are taken as flat.

    Raises
    ------
    MeshError
        When the surface is no closed surface.

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> mesh = geo_adapt.examples.cube(4)
    >>> adapter = geo_adapt.Adapter(threads=1)
    >>> first = adapter.adapt(mesh, geo_adapt.metric.isotropic(np.full(len(mesh.points), 0.15)), order="medit")
    >>> first.report["statistics"]["edge_lengths"]["max"] < 2.5
    True
    >>> second = adapter.adapt(first, first.metric, order="medit")   # its place on the surface is known
    >>> len(second.mesh.points) > 100
    True
    """

    def __init__(
        self,
        model: Model | None = None,
        *,
        surface: Mesh | None = None,
        threads: int | None = None,
        ridge_angle: float | None = None,
        smooth: bool = True,
    ) -> None:
        if model is not None and surface is not None:
            raise InputError("give a model or a surface, not both")
        self.model = model
        kernel = model._kernel if model is not None else None
        self._kernel = _kernel.Adapter(kernel, surface, threads or 0, ridge_angle, smooth)

    def adapt(
        self,
        mesh: Mesh | Result,
        metric: npt.ArrayLike,
        *,
        order: str | None = None,
        complexity: float | None = None,
        vertices: float | None = None,
        max_vertices: int | None = None,
        freeze: Sequence[str | int] = (),
        limit_chords: float | str | None = None,
        tolerance: float | None = None,
        normal_deviation: float | None = None,
        hausdorff: float | None = None,
        report: bool = True,
        progress: Callable[[Progress], bool | None] | None = None,
    ) -> Result:
        """Adapts a mesh to a metric: as `geo_adapt.adapt`, which lists the parameters.

        A `Result` of this adapter may stand for the mesh: where it lies on the model is known then, and a surface without a CAD model
        stays the one of the first mesh, however often it is adapted.
        """
        place = None
        if isinstance(mesh, Result):
            place = mesh._place if mesh._adapter is self else None
            mesh = mesh.mesh
        if complexity is not None and vertices is not None:
            raise InputError("give a complexity or a number of vertices, not both")
        if vertices is not None and not (vertices > 0 and np.isfinite(vertices)):
            raise InputError(f"vertices {vertices}: give a positive number")
        if max_vertices is not None and not 0 < operator.index(max_vertices) < 2**32:
            raise InputError(f"max_vertices {max_vertices}: give a number from 1 to {2**32 - 1}")
        surfaces, regions = _frozen(mesh, freeze)
        options = {
            "complexity": complexity,
            "vertices": vertices,
            "max_vertices": max_vertices,
            "limit_chords": _chords(limit_chords),
            "tolerance": tolerance,
            "normal_deviation": normal_deviation,
            "hausdorff": hausdorff,
            "surfaces": surfaces,
            "regions": regions,
            "report": report,
        }
        told = progress

        def tell(number: int, operation: str, done: int, items: int, points: int) -> bool:
            return told is None or told(Progress(number + 1, operation, done, items, points)) is not False

        given, stopped_by = self._kernel.adapt(
            mesh, packed(metric, order), place, options, None if told is None else tell
        )
        result = Result(mesh, given, self)
        if stopped_by is not None:
            stopped_by.partial = result  # type: ignore[attr-defined]
            raise stopped_by
        if limit_chords is None and result.chords is not None:
            warnings.warn(
                "the metric's sizes along curved walls are too long for a mesh to follow them, and were cut; limit_chords='off' leaves them, "
                "a share says how far they are cut",
                stacklevel=2,
            )
        return result


def _chords(limit: float | str | None) -> float | None:
    """For the kernel: a share, 0 for "off"."""
    if limit is None:
        return None
    if limit == "off":
        return 0.0
    if isinstance(limit, str) or not 0 < limit <= 1:
        raise InputError(f"limit_chords {limit!r}: give a share above 0, and no more than 1, of √(8 h R); or 'off'")
    return float(limit)


def _frozen(mesh: Mesh, freeze: Sequence[str | int]) -> tuple[list[int], list[int]]:
    """References of surfaces and regions that stay: 3, "inlet", "region:2", "region:fluid"."""
    if isinstance(freeze, str):
        freeze = [freeze]
    surfaces: list[int] = []
    regions: list[int] = []
    for part in freeze:
        if isinstance(part, str) and part.startswith("region:"):
            name = part.removeprefix("region:")
            found = [int(name)] if name.lstrip("-").isdigit() else mesh.region_names.get(name, [])
            if not found or not np.isin(found, mesh.tet_references).all():
                raise InputError(f"freeze: there is no {part}")
            regions += found
            continue
        found = mesh.surface(part)
        if not np.isin(found, mesh.triangle_references).all():
            raise InputError(f"freeze: there is no triangle of surface {part}")
        surfaces += found
    return surfaces, regions


def adapt(
    mesh: Mesh,
    metric: npt.ArrayLike,
    model: Model | None = None,
    complexity: float | None = None,
    vertices: float | None = None,
    freeze: Sequence[str | int] = (),
    threads: int | None = None,
    progress: Callable[[Progress], bool | None] | None = None,
    *,
    order: str | None = None,
    max_vertices: int | None = None,
    limit_chords: float | str | None = None,
    tolerance: float | None = None,
    normal_deviation: float | None = None,
    hausdorff: float | None = None,
    report: bool = True,
) -> Result:
    """Adapts a mesh to a metric: its edges then have about length one in it, and its boundary lies on the model.

    The mesh is that of ``geo-adapt adapt MESH --metric METRIC``, bit for bit, on any number of threads.

    Parameters
    ----------
    mesh : Mesh
        The mesh. The kernel works on a copy of its own; the arrays stay as they are. They must not be changed by another thread
        meanwhile.
    metric : array_like, shape (n, 3, 3) or (n, 6)
        At its points, symmetric and positive definite, in 1/length².
    model : Model, optional
        The CAD model that the boundary lies on. By default the mesh's own surface.
    complexity : float, optional
        Scales the metric to this complexity, about half the number of points.
    vertices : float, optional
        Scales the metric so that about so many points come, to 10 %.
    freeze : sequence of str or int
        Surfaces and regions that stay as they are: references or names of surfaces, "region:2".
    threads : int, optional
        By default all cores.
    progress : callable, optional
        Is called with a `Progress` about every 50 ms; it returns False to stop.
    order : {"medit", "voigt"}, optional
        Of a metric of shape (n, 6): "medit" is 11 12 22 13 23 33, "voigt" is xx yy zz yz xz xy.
    max_vertices : int, optional
        A mesh that has so many points gets no more: it is finished as it is, and ``growth_end`` says so. By default what there is memory
        for.
    limit_chords : float or "off", optional
        On a model: sizes along its curved walls are cut to this share of √(8 h R), h the size across the wall and R its radius. By default to 0.5
        where edges of the metric's length would dive through more than four layers of cells, which no mesh can follow; "off" leaves them.
    tolerance : float, optional
        How far a boundary point may be from the model, in its units. By default 1e-6 of its diagonal.
    normal_deviation, hausdorff : float, optional
        Greatest angle (degrees) and distance (length) of boundary triangles from the model; those beyond are split.
    report : bool
        Whether the result is measured.

    Returns
    -------
    Result

    Raises
    ------
    InputError, MeshError, MetricError
        By what is wrong with the input.
    KeyboardInterrupt
        After Ctrl-C, with the mesh so far, which is valid, in ``.partial``; so does any exception of `progress`.

    References
    ----------
    docs/METHOD.md of the project has the formulas, each with its source.

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> mesh = geo_adapt.examples.cube(4)
    >>> h = 0.05 + 0.3 * mesh.points[:, 0]
    >>> result = geo_adapt.adapt(mesh, geo_adapt.metric.isotropic(h), order="medit")
    >>> result.complete, bool(abs(result.mesh.volume - 1) < 1e-12)
    (True, True)
    >>> result.parents.interpolate(mesh.points).shape == result.mesh.points.shape
    True
    >>> small = geo_adapt.adapt(mesh, geo_adapt.metric.isotropic(h), order="medit", max_vertices=200)
    >>> small.growth_end, len(small.mesh.points) <= 200
    ('max-vertices', True)
    """
    return Adapter(model, threads=threads).adapt(
        mesh,
        metric,
        order=order,
        complexity=complexity,
        vertices=vertices,
        max_vertices=max_vertices,
        freeze=freeze,
        limit_chords=limit_chords,
        tolerance=tolerance,
        normal_deviation=normal_deviation,
        hausdorff=hausdorff,
        report=report,
        progress=progress,
    )


__all__ = ["Adapter", "MeshError", "Parents", "Progress", "Result", "adapt"]
