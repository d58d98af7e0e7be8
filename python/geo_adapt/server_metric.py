"""Metrics made and measured on a service, as `geo_adapt.metric` does it here."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .errors import InputError
from .jobs import File
from .metric import _scalars
from .tensors import Floats

if TYPE_CHECKING:
    from .inputs import Source
    from .server import MeshSource, Server


class ServerMetric:
    """Metrics on a service: ``server.metric``. Each function is that of `geo_adapt.metric`, which lists the parameters; what comes out is an
    array of shape (n, 6) in the order "medit", 11 12 22 13 23 33, in 1/length².

    Meshes may be paths or files on the service too, and metrics and fields paths of .sol or .solb files or files there.
    """

    def __init__(self, server: Server) -> None:
        self._server = server

    def _made(self, command: str, options: dict[str, Any], given: Mapping[str, tuple[Any, str] | None]) -> Floats:
        from .server import _made

        job = self._server._call(f"metric {command}", {**options, "output": "out.solb"}, given)
        return _made(job, "out.solb").fields()[0]

    def multiscale(
        self,
        mesh: MeshSource,
        field: npt.ArrayLike | Sequence[npt.ArrayLike] | str | os.PathLike[str] | File,
        complexity: float | None = None,
        *,
        vertices: float | None = None,
        norm: float = 2.0,
        hessian: str = "fit",
        gradation: float | None = 1.5,
        hmin: float | None = None,
        hmax: float | None = None,
        aspect_ratio: float | None = None,
        combine: str = "average",
    ) -> Floats:
        """The metric whose mesh has the least interpolation error of a field: as `metric.multiscale`.

        Parameters
        ----------
        mesh : Mesh, path or File
            The mesh that has the field.
        field : array_like, shape (n,), or sequence of these; or path or File
            Values at the points.
        complexity, vertices, norm, hessian, gradation, hmin, hmax, aspect_ratio, combine : optional
            As there. What it has beyond these (`fixed`, `between`) no command of the program has.

        Returns
        -------
        ndarray, shape (n, 6)

        Raises
        ------
        ProgramError
            When the field is flat or not finite, or the bounds leave no such metric.

        Examples
        --------
        >>> import numpy as np, geo_adapt
        >>> mesh = geo_adapt.examples.cube(5)
        >>> u = np.tanh(20 * (mesh.points[:, 0] - 0.5))
        >>> with geo_adapt.examples.service() as url:
        ...     m = geo_adapt.connect(url).metric.multiscale(mesh, u, complexity=300)
        >>> bool((m == geo_adapt.metric.multiscale(mesh, u, complexity=300)).all())
        True
        """
        from .server import _Several

        if (complexity is None) == (vertices is None):
            raise InputError("give a complexity or a number of vertices")
        fields: list[Any]
        if isinstance(field, (str, os.PathLike, File)):
            fields = [field]
        else:
            several: list[Any] = list(field) if isinstance(field, (list, tuple)) and np.ndim(field[0]) else [field]
            fields = [_scalars(one, "field") for one in several]
        options = {
            "complexity": complexity,
            "vertices": vertices,
            "norm": norm,
            "hessian": hessian,
            "gradation": "off" if gradation is None else gradation,
            "hmin": hmin,
            "hmax": hmax,
            "aspect-ratio": aspect_ratio,
            "combine": combine if len(fields) > 1 else None,
        }
        return self._made("multiscale", options, {"mesh": (mesh, "mesh.meshb"), "fields": (_Several(fields), "field.solb")})

    def geometry(
        self,
        mesh: MeshSource,
        model: Source | None = None,
        *,
        segments: float = 2.0,
        cells: float | None = 2.0,
        gradation: float | None = 1.5,
        hmin: float | None = None,
        hmax: float | None = None,
        aspect_ratio: float | None = None,
        tolerance: float | None = None,
    ) -> Floats:
        """The metric that the geometry asks for: as `metric.geometry`.

        Parameters
        ----------
        mesh : Mesh, path or File
            A mesh on the model.
        model : Model, path, bytes or File, optional
            The CAD model.
        segments, cells, gradation, hmin, hmax, aspect_ratio, tolerance : optional
            As there.

        Returns
        -------
        ndarray, shape (n, 6)

        Raises
        ------
        ProgramError
            When the mesh does not lie on the model.
        """
        options = {
            "segments": segments,
            "feature-cells": "off" if cells is None else cells,
            "gradation": "off" if gradation is None else gradation,
            "hmin": hmin,
            "hmax": hmax,
            "aspect-ratio": aspect_ratio,
            "tolerance": tolerance,
        }
        given = {"mesh": (mesh, "mesh.meshb"), "cad": None if model is None else (model, "model.brep")}
        return self._made("geometry", options, given)

    def intersect(self, *metrics: npt.ArrayLike | File, order: str | None = None) -> Floats:
        """The metric that asks for what each of several asks for: as `metric.intersect`.

        Parameters
        ----------
        *metrics : array_like, shape (n, 3, 3) or (n, 6); or File
            Of the same mesh; their `order`, where they are (n, 6).

        Returns
        -------
        ndarray, shape (n, 6)

        Raises
        ------
        ProgramError
            When one is not positive definite.
        """
        from .server import _Several, _tensors

        if len(metrics) < 2:
            raise InputError("give two metrics at least")
        return self._made("intersect", {}, {"files": (_Several(_tensors(one, order) for one in metrics), "metric.solb")})

    def grade(
        self, mesh: MeshSource, metric: npt.ArrayLike | File, ratio: float = 1.5, *, order: str | None = None
    ) -> Floats:
        """The metric made finer where sizes grow faster than by a ratio from an edge to the next: as `metric.grade`.

        Parameters
        ----------
        mesh : Mesh, path or File
            The mesh.
        metric : array_like, shape (n, 3, 3) or (n, 6); or File
            At its points.
        ratio : float
            Above 1.

        Returns
        -------
        ndarray, shape (n, 6)
        """
        return self._made("grade", {"ratio": ratio}, self._with(mesh, metric, order))

    def limit(
        self,
        metric: npt.ArrayLike | File,
        *,
        hmin: float | None = None,
        hmax: float | None = None,
        aspect_ratio: float | None = None,
        order: str | None = None,
    ) -> Floats:
        """The metric within bounds of its sizes: as `metric.limit`.

        Parameters
        ----------
        metric : array_like, shape (n, 3, 3) or (n, 6); or File
            The metric.
        hmin, hmax : float, optional
            Least and greatest size, length.
        aspect_ratio : float, optional
            Greatest ratio of sizes at a point.

        Returns
        -------
        ndarray, shape (n, 6)
        """
        from .server import _tensors

        options = {"hmin": hmin, "hmax": hmax, "aspect-ratio": aspect_ratio}
        return self._made("limit", options, {"metric": (_tensors(metric, order), "metric.solb")})

    def scale(
        self, mesh: MeshSource, metric: npt.ArrayLike | File, complexity: float, *, order: str | None = None
    ) -> Floats:
        """The metric scaled to a complexity, about half the number of points of its mesh: as `metric.scale`.

        Parameters
        ----------
        mesh : Mesh, path or File
            The mesh.
        metric : array_like, shape (n, 3, 3) or (n, 6); or File
            At its points.
        complexity : float
            Positive.

        Returns
        -------
        ndarray, shape (n, 6)
        """
        return self._made("scale", {"complexity": complexity}, self._with(mesh, metric, order))

    def complexity(
        self, mesh: MeshSource, metric: npt.ArrayLike | File, *, order: str | None = None, between: bool = False
    ) -> float:
        """The complexity of a metric, about half the number of points of its mesh: as `metric.complexity`.

        Parameters
        ----------
        mesh : Mesh, path or File
            The mesh.
        metric : array_like, shape (n, 3, 3) or (n, 6); or File
            At its points.
        between : bool
            Of the interpolant, as the adapter counts; else summed at the points, as metrics are compared.

        Returns
        -------
        float
        """
        found = self.show(mesh, metric, order=order)
        return float(found["complexity_between" if between else "complexity"])

    def show(self, mesh: MeshSource, metric: npt.ArrayLike | File, *, order: str | None = None) -> dict[str, Any]:
        """The figures of ``geo-adapt metric show --json``: complexity, sizes, aspect ratios, how fast sizes grow.

        Parameters
        ----------
        mesh : Mesh, path or File
            The mesh.
        metric : array_like, shape (n, 3, 3) or (n, 6); or File
            At its points.

        Returns
        -------
        dict
        """
        from .server import _made

        job = self._server._call("metric show", {"report": "report.json"}, self._with(mesh, metric, order))
        found: dict[str, Any] = _made(job, "report.json").json()
        return found

    def implied(self, mesh: MeshSource) -> Floats:
        """The metric of a mesh itself: as `metric.implied`.

        Parameters
        ----------
        mesh : Mesh, path or File
            The mesh.

        Returns
        -------
        ndarray, shape (n, 6)

        Raises
        ------
        ProgramError
            When all tetrahedra are flat or inverted.
        """
        return self._made("implied", {}, {"mesh": (mesh, "mesh.meshb")})

    def from_points(self, mesh: MeshSource, points: npt.ArrayLike, neighbours: int = 12) -> Floats:
        """The metric of a cloud of points: as `metric.from_points`.

        Parameters
        ----------
        mesh : Mesh, path or File
            The mesh.
        points : array_like, shape (m, 3)
            The cloud.
        neighbours : int
            How many of the nearest the ellipsoid holds: 4 or more.

        Returns
        -------
        ndarray, shape (n, 6)

        Raises
        ------
        ProgramError
            When there are fewer different points.
        """
        cloud = np.ascontiguousarray(points, dtype=np.float64)
        if cloud.ndim != 2 or cloud.shape[1] != 3:
            raise InputError(f"points: shape {cloud.shape}; give (m, 3)")
        text = io.StringIO()
        # So many digits are all that a number has.
        np.savetxt(text, cloud, fmt="%.17g")
        given = {"mesh": (mesh, "mesh.meshb"), "points": (text.getvalue().encode(), "points.txt")}
        return self._made("from-points", {"neighbours": neighbours}, given)

    @staticmethod
    def _with(mesh: Any, metric: Any, order: str | None) -> dict[str, tuple[Any, str] | None]:
        from .server import _tensors

        return {"mesh": (mesh, "mesh.meshb"), "metric": (_tensors(metric, order), "metric.solb")}


__all__ = ["ServerMetric"]
