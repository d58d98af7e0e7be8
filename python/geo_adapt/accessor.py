"""``grid.geo_adapt`` for pyvista's grids: pyvista imports this module by its entry point when the name is first used."""

from __future__ import annotations

from typing import Any

import pyvista

from .adapting import adapt
from .mesh import Mesh
from .views import from_pyvista, to_pyvista


@pyvista.register_dataset_accessor("geo_adapt", pyvista.UnstructuredGrid)
class Accessor:
    """``grid.geo_adapt`` of pyvista's grids: adapts them as they are.

    Examples
    --------
    >>> import numpy as np, pyvista, geo_adapt.accessor
    >>> grid = geo_adapt.examples.cube(3).to_pyvista()
    >>> grid.geo_adapt.adapt(np.tile(np.eye(3) * 40, (grid.n_points, 1, 1))).n_points > 64
    True
    """

    def __init__(self, grid: pyvista.UnstructuredGrid) -> None:
        self._grid = grid

    @property
    def mesh(self) -> Mesh:
        """The grid as a `Mesh`."""
        return from_pyvista(self._grid)

    def adapt(self, metric: Any, **options: Any) -> pyvista.UnstructuredGrid:
        """The grid adapted to a metric at its points, with its point data brought along; options are those of `geo_adapt.adapt`."""
        mesh = self.mesh
        result = adapt(mesh, metric, **options)
        result.mesh.fields = {name: result.parents.interpolate(values) for name, values in mesh.fields.items()}
        return to_pyvista(result.mesh)
