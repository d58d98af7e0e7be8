"""A plate with a hole is pulled: from the part in build123d to a converged stress. A quarter of it, in mm, N, MPa."""
import numpy as np
from build123d import Align, Box, Cylinder
from skfem import Basis, ElementTetP1, ElementTetP2, ElementVector, FacetBasis, LinearForm, MeshTet, condense, solve
from skfem.helpers import sym_grad
from skfem.models.elasticity import lame_parameters, linear_elasticity, linear_stress

import geo_adapt

low = (Align.CENTER, Align.CENTER, Align.MIN)
part = Box(50, 20, 2.5, align=(Align.MIN,) * 3) - Cylinder(8, 2.5, align=low)
model = geo_adapt.Model(part)
pulled = max(model.faces, key=lambda face: face.center[0])
model.name({"pulled": [pulled.number]})
steel = lame_parameters(210_000.0, 0.3)


def stress(mesh):
    """The stress along the pull at the points: displacements are quadratic, and symmetric about x = 0, y = 0, z = 0."""
    grid = MeshTet(mesh.points.T.copy(), mesh.tets.T.astype(np.int64, "C"))
    basis = Basis(grid, ElementVector(ElementTetP2()))
    end = grid.facets_satisfying(lambda x: np.isclose(x[0], 50.0), boundaries_only=True)
    load = LinearForm(lambda v, w: 100.0 * v[0]).assemble(FacetBasis(grid, basis.elem, facets=end))
    held = [basis.get_dofs(grid.facets_satisfying(lambda x, k=k: np.isclose(x[k], 0.0), True)).all(f"u^{k + 1}") for k in range(3)]
    u = solve(*condense(linear_elasticity(*steel).assemble(basis), load, D=np.concatenate(held)))
    values = linear_stress(*steel)(sym_grad(basis.interpolate(u)))[0, 0]
    return basis.with_element(ElementTetP1()).project(values)


mesh = geo_adapt.bootstrap(model)
for step, complexity in enumerate((500, 1000, 2000, None), 1):
    mesh.fields["sxx"] = sxx = stress(mesh)
    print(f"{len(mesh.points)} points, greatest stress {sxx.max():.1f} MPa")
    mesh.write_page(f"stress-{step}.png", "sxx", size="760x420", view="290,50")
    if complexity:
        metric = geo_adapt.metric.multiscale(mesh, sxx, complexity, fixed=geo_adapt.metric.geometry(mesh, model), order="medit")
        mesh = geo_adapt.adapt(mesh, metric, model, order="medit").mesh
mesh.write_page("stress.html", "sxx")
