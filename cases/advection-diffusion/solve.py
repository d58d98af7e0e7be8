"""Advection and diffusion about a cylinder with suction, by scikit-fem: linear tetrahedra, streamline stabilisation.

    python solve.py MESH SOLUTION          # files of meshio, such as .vtu; result.json with the functionals goes beside the solution

On the unit cube without the cylinder of radius R about the z axis, the flow b = -e_r / r goes into the cylinder (div b = 0) and
-ε Δu + b·∇u = 0 with u = 1 there. The exact solution (r/R)^(-1/ε) is a layer of thickness ε R on the curved wall; on the other
sides it has no flux through planes of symmetry (x = 0, y = 0, z = 0, z = 1) and is given where the flow comes in (x = 1, y = 1).
The content ∫ u of the domain is that of the layer, π/2 R² / (1/ε - 2), to rounding.
"""

import json
import sys
from pathlib import Path

import meshio
import numpy as np
from scipy.sparse.linalg import LinearOperator, bicgstab, spilu
from skfem import Basis, BilinearForm, ElementTetP1, Functional, MeshTet, condense
from skfem.helpers import dot, grad

RADIUS = 0.5
EPSILON = 0.01
# Degree of the quadrature of the error: the layer within a tetrahedron is no polynomial.
DEGREE = 8
# On the sides that are planes.
NEAR = 1e-9
TOLERANCE = 1e-10
CONTENT = np.pi / 2 * RADIUS**2 / (1 / EPSILON - 2)


def exact(x):
    """u at points (3, ...)."""
    return (np.hypot(x[0], x[1]) / RADIUS) ** (-1 / EPSILON)


def flow(x):
    """b at points (3, ...)."""
    square = x[0] ** 2 + x[1] ** 2
    return np.stack([-x[0] / square, -x[1] / square, 0 * x[2]])


@BilinearForm
def transport(u, v, w):
    """Galerkin's method with SUPG (Brooks and Hughes 1982); the second derivatives of linear functions vanish.

    τ for stretched elements: |b| / (twice the length of b in the metric of the element), limited by diffusion across it.
    """
    b = flow(w.x)
    along = dot(b, grad(u))
    return EPSILON * dot(grad(u), grad(v)) + along * v + w.tau * along * dot(b, grad(v))


def stabilisation(mesh, basis):
    """τ at the points of the quadrature, (elements, points): h_b / (2 |b|) · min(1, Pe / 3), h_b the element's extent along b."""
    b = flow(basis.global_coordinates().value)
    gradients = np.stack([basis.basis[i][0].grad for i in range(4)])
    # Σ |b·∇φ_i| is 2 |b| / h_b.
    along = np.abs(np.einsum("k...,ik...->i...", b, gradients)).sum(0)
    speed = np.sqrt((b**2).sum(0))
    extent = 2 * speed / along
    peclet = speed * extent / (2 * EPSILON)
    return extent / (2 * speed) * np.minimum(1, peclet / 3)


def solve(mesh):
    """u at the vertices, (n,), and the functionals."""
    basis = Basis(mesh, ElementTetP1(), intorder=3)
    matrix = transport.assemble(basis, tau=stabilisation(mesh, basis))
    points = mesh.p
    wall = np.abs(np.hypot(points[0], points[1]) - RADIUS) < 1e-6
    fixed = np.flatnonzero(wall | (points[0] > 1 - NEAR) | (points[1] > 1 - NEAR))
    u = np.where(wall, 1.0, exact(points))
    inner, right, _, free = condense(matrix, np.zeros(len(u)), x=u, D=fixed)
    inner = inner.tocsc()
    incomplete = spilu(inner, drop_tol=1e-4, fill_factor=12)
    u[free], failed = bicgstab(inner, right, x0=incomplete.solve(right), M=LinearOperator(inner.shape, incomplete.solve), rtol=TOLERANCE, maxiter=500)
    if failed:
        sys.exit(f"the linear system was not solved (bicgstab: {failed})")
    fine = Basis(mesh, ElementTetP1(), intorder=DEGREE)
    error = np.sqrt(Functional(lambda w: (w.u - exact(w.x)) ** 2).assemble(fine, u=fine.interpolate(u)))
    content = Functional(lambda w: w.u).assemble(fine, u=fine.interpolate(u))
    return u, {"error": float(error), "content": float(content)}


def main():
    found, target = meshio.read(sys.argv[1]), Path(sys.argv[2])
    tets = np.concatenate([block.data for block in found.cells if block.type == "tetra"])
    u, functionals = solve(MeshTet(np.ascontiguousarray(found.points.T), np.ascontiguousarray(tets.T.astype(np.int64))))
    meshio.Mesh(found.points, [("tetra", tets)], point_data={"u": u}).write(target)
    target.with_name("result.json").write_text(json.dumps(functionals))
    print(f"{len(u)} vertices, error {functionals['error']:.4g}, content {functionals['content']:.6f} (exact {CONTENT:.6f})")


if __name__ == "__main__":
    main()
