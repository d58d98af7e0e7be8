"""Metrics made, combined and measured.

A metric here is an array of shape (n, 6) in the order "medit", 11 12 22 13 23 33, or (n, 3, 3); in 1/length². Where one of shape (n, 6) goes in,
its `order` is said by name, never guessed. What comes out is (n, 6) in the order "medit"; `geo_adapt.full` makes (n, 3, 3) of it. The
numbers are those of ``geo-adapt metric``, bit for bit, on any number of threads.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _kernel
from .errors import InputError
from .mesh import Mesh
from .model import Model
from .tensors import Floats, packed


def _scalars(field: npt.ArrayLike, what: str) -> npt.NDArray[Any]:
    values = np.ascontiguousarray(field, dtype=np.float64)
    if values.ndim != 1:
        raise InputError(f"{what}: shape {values.shape}; give a value a point, shape (n,), such as a component of a vector")
    return values


def multiscale(
    mesh: Mesh,
    field: npt.ArrayLike | Sequence[npt.ArrayLike],
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
    fixed: npt.ArrayLike | None = None,
    order: str | None = None,
    between: bool = False,
    threads: int | None = None,
) -> Floats:
    """The metric whose mesh has the least interpolation error of a field, in the L^p norm, for its number of points.

    Parameters
    ----------
    mesh : Mesh
        The mesh that has the field.
    field : array_like, shape (n,), or sequence of these
        Values at the points. Several are steps in time of one field, or fields of their own: see `combine`.
    complexity : float
        Of the metric: about half the number of points of the adapted mesh. Or give
    vertices : float
        twice that.
    norm : float
        The p of the norm: 1 or more, `inf` among them.
    hessian : {"fit", "l2", "jumps"}
        How second derivatives are recovered. "jumps" is for shocks.
    gradation : float or None
        Greatest growth of the sizes from an edge to the next; None for no gradation.
    hmin, hmax : float, optional
        Bounds of the sizes, in length.
    aspect_ratio : float, optional
        Greatest ratio of the sizes at a point.
    combine : {"average", "intersect"}
        Whether several fields are steps in time (|H| averaged) or fields of their own (metrics intersected).
    fixed : array_like, shape (n, 3, 3) or (n, 6), optional
        A metric that is intersected at any scale, such as that of the geometry; `order` is its order.
    between : bool
        Measures the complexity by the interpolant, ∫ √det M, as ``geo-adapt adapt --field`` does; else at the points, as
        ``geo-adapt metric multiscale``.
    threads : int, optional
        By default all cores.

    Returns
    -------
    ndarray, shape (n, 6)

    Raises
    ------
    MetricError
        When the field is flat or not finite, or the bounds leave no such metric.

    References
    ----------
    A. Loseille and F. Alauzet, Continuous mesh framework, part I and II, SIAM J. Numer. Anal. 49 (2011). Gradation: F. Alauzet, Size
    gradation control of anisotropic meshes, Finite Elem. Anal. Des. 46 (2010).

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> mesh = geo_adapt.examples.cube(6)
    >>> u = np.tanh(20 * (mesh.points[:, 0] - 0.5))
    >>> m = geo_adapt.metric.multiscale(mesh, u, 500)
    >>> bool(abs(geo_adapt.metric.complexity(mesh, m, order="medit") / 500 - 1) < 0.02)
    True
    """
    wanted = _wanted(complexity, vertices)
    given: list[Any] = list(field) if isinstance(field, (list, tuple)) and np.ndim(field[0]) else [field]
    values = [_scalars(one, "field") for one in given]
    if combine not in ("average", "intersect"):
        raise InputError(f'combine {combine!r}: "average" or "intersect"')
    sensors = [values] if combine == "average" else [[one] for one in values]
    how = {
        "complexity": wanted,
        "norm": norm,
        "hessian": hessian,
        "gradation": gradation,
        "hmin": hmin,
        "hmax": hmax,
        "aspect_ratio": aspect_ratio,
        "between": between,
    }
    other = None if fixed is None else packed(fixed, order)
    return _kernel.multiscale(mesh, sensors, how, other, threads or 0)


def _wanted(complexity: float | None, vertices: float | None) -> float:
    """The complexity, of which one of the two is given."""
    if complexity is not None and vertices is None:
        return float(complexity)
    if vertices is not None and complexity is None:
        return vertices / 2.0
    raise InputError("give a complexity or a number of vertices")


def goal(
    mesh: Mesh,
    terms: Sequence[tuple[npt.ArrayLike, npt.ArrayLike] | tuple[npt.ArrayLike, npt.ArrayLike, Mapping[str, float]]],
    complexity: float | None = None,
    *,
    vertices: float | None = None,
    norm: float = 1.0,
    hessian: str = "fit",
    boundary: str = "inside",
    gradation: float | None = 1.5,
    hmin: float | None = None,
    hmax: float | None = None,
    aspect_ratio: float | None = None,
    fixed: npt.ArrayLike | None = None,
    order: str | None = None,
    between: bool = False,
    threads: int | None = None,
) -> Floats:
    """The metric whose mesh does the least harm to a functional for its number of points: fields weighted by an adjoint.

    Parameters
    ----------
    mesh : Mesh
        The mesh that has the fields.
    terms : sequence of (field, weight) or (field, adjoint, derivatives)
        Arrays of shape (n,). A weight is 0 or more. Of an adjoint λ the weight is Σ abs(c ∂λ) over its derivatives with their coefficients c:
        {"x": 1, "yy": 0.01}, b_x for "x" of an advection b ∂u/∂x, ε for "yy" of a diffusion ε ∂²u/∂y².
    complexity : float
        Of the metric: about half the number of points of the adapted mesh. Or give
    vertices : float
        twice that.
    norm : float
        The p of the exponent -1/(2p + 3).
    boundary : {"inside", "own"}
        What points on the boundary get: second derivatives of the neighbours inside, and weights no greater than theirs; or what is recovered there.
    hessian, gradation, hmin, hmax, aspect_ratio, fixed, order, between, threads : optional
        As of `multiscale`.

    Returns
    -------
    ndarray, shape (n, 6)

    Raises
    ------
    MetricError
        When a value is not finite, a weight is negative, no size follows from the terms, or the bounds leave no such metric.

    References
    ----------
    A. Loseille, A. Dervieux and F. Alauzet, Fully anisotropic goal-oriented mesh adaptation for 3D steady Euler equations, J. Comput. Phys. 229
    (2010). A. Belme, A. Dervieux and F. Alauzet, Time accurate anisotropic goal-oriented mesh adaptation for unsteady flows, J. Comput. Phys.
    231 (2012).

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> mesh = geo_adapt.examples.cube(6)
    >>> x, y, z = mesh.points.T
    >>> u, adjoint = np.sin(3 * x) + np.sin(3 * y), np.exp(-9 * (x**2 + y**2 + z**2))
    >>> m = geo_adapt.metric.goal(mesh, [(u, adjoint, {"x": 1, "y": 1})], 500)
    >>> bool(abs(geo_adapt.metric.complexity(mesh, m, order="medit") / 500 - 1) < 0.02)
    True
    """
    wanted = _wanted(complexity, vertices)
    given = []
    for term in terms:
        if len(term) not in (2, 3):
            raise InputError("terms: give (field, weight), or (field, adjoint, derivatives)")
        derivatives = dict(term[2]) if len(term) == 3 else {}
        if len(term) == 3 and not derivatives:
            raise InputError('terms: an adjoint has no derivatives: give some, as {"x": 1}')
        given.append({"field": _scalars(term[0], "field"), "weight": _scalars(term[1], "weight"), "derivatives": derivatives})
    how = {
        "complexity": wanted,
        "norm": norm,
        "hessian": hessian,
        "boundary": boundary,
        "gradation": gradation,
        "hmin": hmin,
        "hmax": hmax,
        "aspect_ratio": aspect_ratio,
        "between": between,
    }
    other = None if fixed is None else packed(fixed, order)
    return _kernel.goal(mesh, given, how, other, threads or 0)


def hessian(mesh: Mesh, field: npt.ArrayLike, *, recovery: str = "fit", threads: int | None = None) -> Floats:
    """The second derivatives of a field, as the metrics recover them: of an adjoint they tell what its linear interpolation leaves out.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    field : array_like, shape (n,)
        Values at the points.
    recovery : {"fit", "l2", "jumps"}
        A quadratic function fitted to two rings of neighbours; gradients averaged twice; or as the first, for shocks.

    Returns
    -------
    ndarray, shape (n, 6)
        In the order "medit", in the field's unit over length squared.

    Examples
    --------
    >>> import geo_adapt
    >>> mesh = geo_adapt.examples.cube(4)
    >>> x, y, z = mesh.points.T
    >>> geo_adapt.metric.hessian(mesh, x**2 + x * y).round(6)[0] + 0.0
    array([2., 1., 0., 0., 0., 0.])
    """
    return _kernel.hessian(mesh, _scalars(field, "field"), recovery, threads or 0)


def geometry(
    mesh: Mesh,
    model: Model | None = None,
    *,
    segments: float = 2.0,
    cells: float | None = 2.0,
    gradation: float | None = 1.5,
    hmin: float | None = None,
    hmax: float | None = None,
    aspect_ratio: float | None = None,
    tolerance: float | None = None,
    threads: int | None = None,
) -> Floats:
    """The metric that the geometry asks for: fine where it curves, and across thin parts and gaps.

    Parameters
    ----------
    mesh : Mesh
        A mesh on the model.
    model : Model, optional
        The CAD model. Without it curvatures are estimated from the mesh's own triangles.
    segments : float
        Segments for a radian of curvature: the size is 1/(segments κ).
    cells : float or None
        Cells across thin parts and gaps; None leaves these alone.
    gradation : float or None
        Greatest growth of the sizes.
    hmin, hmax : float, optional
        Bounds of the sizes; by default 1e-5 and a tenth of the model's diagonal.
    aspect_ratio, tolerance, threads : optional
        Greatest ratio of sizes at a point; how far a point may be from the model; by default all cores.

    Returns
    -------
    ndarray, shape (n, 6)

    Raises
    ------
    MeshError
        When the mesh does not lie on the model.

    Examples
    --------
    >>> import geo_adapt
    >>> model = geo_adapt.Model(geo_adapt.examples.cylinder())
    >>> mesh = geo_adapt.bootstrap(model, threads=1)
    >>> geo_adapt.metric.geometry(mesh, model).shape == (len(mesh.points), 6)
    True
    """
    how = {
        "segments": segments,
        "cells": cells,
        "gradation": gradation,
        "hmin": hmin,
        "hmax": hmax,
        "aspect_ratio": aspect_ratio,
        "tolerance": tolerance,
    }
    return _kernel.geometry(mesh, None if model is None else model._kernel, how, threads or 0)


def _words(wall: Mapping[str, Any]) -> str:
    return ",".join(f"{key}={'off' if value is None else value}" for key, value in wall.items())


def _surfaces(mesh: Mesh, wall: str | int) -> list[int]:
    if not isinstance(wall, str) or wall in mesh.names:
        return mesh.surface(wall)
    parts = [part.strip() for part in wall.split("+")]
    return [reference for part in parts for reference in mesh.surface(int(part) if part.isdigit() else part)]


def wall(
    mesh: Mesh,
    walls: Mapping[str | int, Mapping[str, Any]],
    model: Model | None = None,
    complexity: float | None = None,
    *,
    hmax: float | None = None,
    segments: float = 2.0,
    norm: float = 2.0,
    exact: bool = False,
    tolerance: float | None = None,
    threads: int | None = None,
) -> Floats:
    """The metric of layers along walls, from the exact distance to the faces of the model.

    Parameters
    ----------
    mesh : Mesh
        A mesh on the model.
    walls : mapping of str or int to mapping
        For each wall, by the name or reference of its surface (of several "3+4+tail"), what its layers are like: ``h``, the first height, or ``yplus``, ``re`` and ``length``;
        ``growth``, ``tangential``, ``chord`` (None leaves that bound out) and ``law``, as ``geo-adapt metric wall --help`` tells.
    model : Model, optional
        The CAD model. Without it the walls are smooth patches through the mesh's own triangles.
    complexity : float, optional
        That is met, by the sizes along the walls and outside, or by Spalding's law.
    hmax : float, optional
        Greatest size; by default a tenth of the model's diagonal.
    segments : float
        Segments for a radian of a wall's curvature.
    norm : float
        With Spalding's law: the p of the norm of the interpolation error of u⁺.
    exact : bool
        Sizes as they are asked for at each point, not graded.
    tolerance, threads : optional
        How far a point may be from the model; by default all cores.

    Returns
    -------
    ndarray, shape (n, 6)

    Raises
    ------
    InputError
        When a wall is not there, or its words are wrong.
    MetricError
        When the complexity cannot be reached.

    References
    ----------
    D. B. Spalding, A single formula for the law of the wall, J. Appl. Mech. 28 (1961).

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> mesh = geo_adapt.examples.cube(4)
    >>> m = geo_adapt.metric.wall(mesh, {"z=0": dict(h=0.01, growth=1.2)}, exact=True)
    >>> on = geo_adapt.examples.cube(4).on("z=0")
    >>> bool(np.allclose(m[on, 5] ** -0.5, 0.01))
    True
    """
    asked = [(str(name), _surfaces(mesh, name), _words(given)) for name, given in walls.items()]
    how = {
        "complexity": complexity,
        "hmax": hmax,
        "segments": segments,
        "norm": norm,
        "exact": exact,
        "tolerance": tolerance,
    }
    return _kernel.wall(mesh, None if model is None else model._kernel, asked, how, threads or 0)


def distance(
    mesh: Mesh,
    faces: str | int | Sequence[str | int],
    model: Model | None = None,
    *,
    tolerance: float | None = None,
    threads: int | None = None,
) -> Floats:
    """The exact distance of the points from some surfaces: from the faces of the model there, or from the mesh's own triangles.

    Parameters
    ----------
    mesh : Mesh
        A mesh on the model.
    faces : str, int, or sequence of these
        The surfaces, by name or reference.
    model : Model, optional
        The CAD model.
    tolerance, threads : optional
        How far a point may be from the model; by default all cores.

    Returns
    -------
    ndarray, shape (n,)
        0 on the surfaces.

    Raises
    ------
    InputError
        When a surface is not there.

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> mesh = geo_adapt.examples.cube(4)
    >>> bool(np.array_equal(geo_adapt.metric.distance(mesh, "z=0"), mesh.points[:, 2]))
    True
    """
    given = [faces] if isinstance(faces, (str, int)) else list(faces)
    references = sorted({reference for name in given for reference in mesh.surface(name)})
    return _kernel.distance(mesh, None if model is None else model._kernel, references, tolerance, threads or 0)


def isotropic(sizes: npt.ArrayLike) -> Floats:
    """The metric of sizes, the same in all directions: h⁻² I.

    Parameters
    ----------
    sizes : array_like, shape (n,)
        Lengths h, positive.

    Returns
    -------
    ndarray, shape (n, 6)

    Raises
    ------
    MetricError
        When a size is not positive.

    Examples
    --------
    >>> import geo_adapt
    >>> geo_adapt.metric.isotropic([0.5]).tolist()
    [[4.0, 0.0, 4.0, 0.0, 0.0, 4.0]]
    """
    return _kernel.isotropic(_scalars(sizes, "sizes"))


def intersect(*metrics: npt.ArrayLike, order: str | None = None, threads: int | None = None) -> Floats:
    """The metric that asks for what each of several asks for: at each point the largest ellipsoid within theirs, nearly.

    Parameters
    ----------
    *metrics : array_like, shape (n, 3, 3) or (n, 6)
        Of the same mesh; their `order`, where they are (n, 6).
    threads : int, optional
        By default all cores.

    Returns
    -------
    ndarray, shape (n, 6)

    Raises
    ------
    MetricError
        When one is not positive definite.

    Examples
    --------
    >>> import geo_adapt
    >>> a, b = geo_adapt.metric.isotropic([0.5, 1.0]), geo_adapt.metric.isotropic([1.0, 0.25])
    >>> geo_adapt.metric.intersect(a, b, order="medit")[:, 0].round(12).tolist()
    [4.0, 16.0]
    """
    if not metrics:
        raise InputError("give one metric at least")
    return _kernel.intersect([packed(metric, order) for metric in metrics], threads or 0)


def grade(
    mesh: Mesh, metric: npt.ArrayLike, ratio: float = 1.5, *, order: str | None = None, threads: int | None = None
) -> Floats:
    """The metric made finer where sizes grow faster than by a ratio from an edge to the next (Alauzet 2010, mixed space).

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    metric : array_like, shape (n, 3, 3) or (n, 6)
        At its points.
    ratio : float
        Above 1.

    Returns
    -------
    ndarray, shape (n, 6)

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> mesh = geo_adapt.examples.cube(4)
    >>> h = np.where(mesh.points[:, 0] == 0, 0.01, 1.0)
    >>> m = geo_adapt.metric.grade(mesh, geo_adapt.metric.isotropic(h), order="medit")
    >>> bool(m[:, 0].min() > 1.5)
    True
    """
    return _kernel.grade(mesh, packed(metric, order), ratio, threads or 0)


def limit(
    metric: npt.ArrayLike,
    *,
    hmin: float | None = None,
    hmax: float | None = None,
    aspect_ratio: float | None = None,
    order: str | None = None,
    threads: int | None = None,
) -> Floats:
    """The metric within bounds of its sizes.

    Parameters
    ----------
    metric : array_like, shape (n, 3, 3) or (n, 6)
        The metric.
    hmin, hmax : float, optional
        Least and greatest size, length.
    aspect_ratio : float, optional
        Greatest ratio of sizes at a point: greater sizes are cut.

    Returns
    -------
    ndarray, shape (n, 6)

    Examples
    --------
    >>> import geo_adapt
    >>> geo_adapt.metric.limit(geo_adapt.metric.isotropic([0.1]), hmin=0.5, order="medit").round(12)[0, 0]
    np.float64(4.0)
    """
    return _kernel.limit(packed(metric, order), hmin, hmax, aspect_ratio, threads or 0)


def scale(
    mesh: Mesh, metric: npt.ArrayLike, complexity: float, *, order: str | None = None, threads: int | None = None
) -> Floats:
    """The metric scaled to a complexity, about half the number of points of its mesh.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    metric : array_like, shape (n, 3, 3) or (n, 6)
        At its points.
    complexity : float
        Positive.

    Returns
    -------
    ndarray, shape (n, 6)

    Examples
    --------
    >>> import geo_adapt
    >>> mesh = geo_adapt.examples.cube(3)
    >>> m = geo_adapt.metric.scale(mesh, geo_adapt.metric.implied(mesh), 100, order="medit")
    >>> round(geo_adapt.metric.complexity(mesh, m, order="medit"), 6)
    100.0
    """
    return _kernel.scale(mesh, packed(metric, order), complexity, threads or 0)


def complexity(
    mesh: Mesh,
    metric: npt.ArrayLike,
    *,
    order: str | None = None,
    between: bool = False,
    threads: int | None = None,
) -> float:
    """The complexity of a metric, its volume ∫ √det M: about half the number of points of its mesh.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    metric : array_like, shape (n, 3, 3) or (n, 6)
        At its points.
    between : bool
        Of the interpolant, as the adapter counts; else summed at the points, as metrics are compared.

    Returns
    -------
    float

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> mesh = geo_adapt.examples.cube(3)
    >>> round(geo_adapt.metric.complexity(mesh, np.tile(np.eye(3) * 100, (len(mesh.points), 1, 1))), 6)
    1000.0
    """
    return _kernel.complexity(mesh, packed(metric, order), between, threads or 0)


def implied(mesh: Mesh, *, threads: int | None = None) -> Floats:
    """The metric of a mesh itself: the one in which its edges have length one, as far as they can.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    ndarray, shape (n, 6)

    Raises
    ------
    MetricError
        When all tetrahedra are flat or inverted.

    Examples
    --------
    >>> import geo_adapt
    >>> mesh = geo_adapt.examples.cube(3)
    >>> geo_adapt.metric.implied(mesh).shape
    (64, 6)
    """
    return _kernel.implied(mesh, threads or 0)


def from_points(
    mesh: Mesh, points: npt.ArrayLike, neighbours: int = 12, *, threads: int | None = None
) -> Floats:
    """The metric of a cloud of points: the ellipsoid about each point of the mesh that holds its nearest points.

    Parameters
    ----------
    mesh : Mesh
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
    MetricError
        When there are fewer different points.

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> mesh = geo_adapt.examples.cube(2)
    >>> cloud = np.random.default_rng(1).random((200, 3))
    >>> geo_adapt.metric.from_points(mesh, cloud).shape
    (27, 6)
    """
    cloud = np.ascontiguousarray(points, dtype=np.float64)
    if cloud.ndim != 2 or cloud.shape[1] != 3:
        raise InputError(f"points: shape {cloud.shape}; give (m, 3)")
    return _kernel.from_points(mesh.points, cloud, neighbours, threads or 0)
