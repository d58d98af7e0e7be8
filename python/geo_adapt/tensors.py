"""Metrics as arrays: (n, 3, 3), or (n, 6) with its order said by name."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import InputError

Floats = npt.NDArray[np.float64]

#: Where each of our six terms (11 12 22 13 23 33) stands in the order of a name.
ORDERS = {
    "medit": (0, 1, 2, 3, 4, 5),
    "voigt": (0, 5, 1, 4, 3, 2),
}

_ROWS = (0, 0, 1, 0, 1, 2)
_COLUMNS = (0, 1, 1, 2, 2, 2)


def packed(metric: npt.ArrayLike, order: str | None = None) -> Floats:
    """A metric as (n, 6) in the order of .sol files, "medit": 11 12 22 13 23 33.

    Parameters
    ----------
    metric : array_like, shape (n, 3, 3) or (n, 6)
        Symmetric tensors, in 1/length².
    order : {"medit", "voigt"}, optional
        Of the shape (n, 6), where it must be given: "medit" is 11 12 22 13 23 33, "voigt" is xx yy zz yz xz xy.

    Returns
    -------
    ndarray, shape (n, 6), float64
        The array itself where it is that already: contiguous, of float64, of the order "medit".

    Raises
    ------
    InputError
        When the shape is another, the order is missing, or a tensor is not symmetric.

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> geo_adapt.packed(np.array([[[4, 0, 1], [0, 5, 0], [1, 0, 6]]]))
    array([[4., 0., 5., 1., 0., 6.]])
    >>> geo_adapt.packed(np.array([[4, 5, 6, 0, 1, 0]]), order="voigt")
    array([[4., 0., 5., 1., 0., 6.]])
    """
    given = np.asarray(metric)
    if given.ndim == 2 and given.shape[1] == 6:
        if order is None:
            raise InputError('metric: an array of shape (n, 6) needs its order: order="medit" (11 12 22 13 23 33) or order="voigt" (xx yy zz yz xz xy)')
        if order not in ORDERS:
            raise InputError(f'order {order!r}: "medit" or "voigt"')
        if order == "medit":
            return np.ascontiguousarray(given, dtype=np.float64)
        return np.ascontiguousarray(given[:, ORDERS[order]], dtype=np.float64)
    if given.ndim == 3 and given.shape[1:] == (3, 3):
        full = given.astype(np.float64, copy=False)
        skew = np.abs(full - full.transpose(0, 2, 1))
        if not (skew <= 1e-12 * np.abs(full).max(axis=(1, 2), initial=0.0)[:, None, None]).all():
            raise InputError("metric: give symmetric tensors, of finite numbers")
        return np.ascontiguousarray(full[:, _ROWS, _COLUMNS])
    raise InputError(f"metric: shape {given.shape}, but (n, 3, 3) or (n, 6) is wanted")


def full(metric: npt.ArrayLike, order: str = "medit") -> Floats:
    """A metric of shape (n, 6) as (n, 3, 3).

    Parameters
    ----------
    metric : array_like, shape (n, 6)
        Terms in the order of the name.
    order : {"medit", "voigt"}
        "medit" is 11 12 22 13 23 33, "voigt" is xx yy zz yz xz xy.

    Returns
    -------
    ndarray, shape (n, 3, 3)

    Examples
    --------
    >>> import geo_adapt
    >>> geo_adapt.full([[4, 0, 5, 1, 0, 6]]).tolist()
    [[[4.0, 0.0, 1.0], [0.0, 5.0, 0.0], [1.0, 0.0, 6.0]]]
    """
    terms = packed(metric, order)
    tensors = np.empty((len(terms), 3, 3))
    tensors[:, _ROWS, _COLUMNS] = terms
    tensors[:, _COLUMNS, _ROWS] = terms
    return tensors


def rows(values: npt.ArrayLike, count: int, what: str) -> tuple[Floats, tuple[Any, ...]]:
    """Values at points as (n, k), with the shape of one: (), (k,) or (3, 3)."""
    given = np.asarray(values, dtype=np.float64)
    if given.ndim == 0 or len(given) != count:
        raise InputError(f"{what}: shape {given.shape}, but the mesh has {count} points: give a row each")
    return np.ascontiguousarray(given.reshape(count, -1)), given.shape[1:]
