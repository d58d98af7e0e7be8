"""Potential flow about a sphere: the force of the pressure on its front half, -q π R²/8.

φ = x + R³ x / (2 r³) with unit speed; on the sphere the pressure is q (1 - |∇φ|²), so that F/q = πR² + ∫ |∇φ|² min(n_x, 0), of the derivatives along the sphere. On
the box around it φ + ∂φ/∂n is given.

The estimate is J(u*) + r(u*; λ*) - J(u_h), both recovered (Pierce and Giles 2000).
"""

from functools import partial

import numpy as np
from skfem import BilinearForm, ElementTetP1, FacetBasis, Functional, LinearForm, MeshTet2
from skfem.helpers import dot, grad

import fem

CENTRE, RADIUS = np.array([0.9, 0.8, 0.6]), 0.3
# Between the sphere and the box.
BETWEEN = 0.45
ORDER = 5


def truth():
    """F/q, in units of length squared."""
    return -np.pi * RADIUS**2 / 8


def exact(x):
    """φ and ∇φ at points (3, ...)."""
    d = (x.T - CENTRE).T
    r = np.sqrt((d**2).sum(0))
    cube = RADIUS**3 / (2 * r**3)
    slope = -3 * cube * d[0] / r**2 * d
    slope[0] += 1 + cube
    return d[0] * (1 + cube), slope


def product(a, b, w):
    """∇a·∇b min(n_x, 0) along the sphere, from gradients (3, ...) near it."""
    normal = (w.x.T - CENTRE).T
    normal = normal / np.sqrt((normal**2).sum(0))
    return (dot(a, b) - dot(a, normal) * dot(b, normal)) * np.minimum(normal[0], 0)


def curved(mesh):
    """The mesh with quadratic tetrahedra, its faces on sphere and box, and how far the middles of the edges moved: the middles of edges on the sphere are on it too. Flat faces have a gap of h²/8R, and the force is the small
    difference of two larger numbers."""
    outside = mesh.boundary_facets()
    middle = np.linalg.norm(mesh.p[:, mesh.facets].mean(1).T - CENTRE, axis=1)
    wall, box = outside[middle[outside] < BETWEEN], outside[middle[outside] > BETWEEN]
    edges = np.unique(mesh.f2e[:, wall])
    bent = MeshTet2.from_mesh(mesh)
    places = bent.doflocs.copy()
    at = fem.Basis(mesh, fem.ElementTetP2()).edge_dofs[0, edges]
    steps = (places[:, at].T - CENTRE).T
    places[:, at] = (CENTRE + RADIUS * (steps / np.linalg.norm(steps, axis=0)).T).T
    moved = places[:, fem.Basis(mesh, fem.ElementTetP2()).edge_dofs[0]] - mesh.p[:, mesh.edges].mean(1)
    return MeshTet2(places, bent.t), wall, box, moved


def inverse(mesh, mapping, x, tind=None):
    """Where points (3, tetrahedra, points) of quadratic tetrahedra are in the reference one: Newton's method from where they would be in straight
    tetrahedra. (scikit-fem's own begins outside, and does not come to an end in some.)"""
    corners = mesh.doflocs[:, mesh.t[:, tind]]
    sides = (corners[:, 1:] - corners[:, :1]).transpose(2, 0, 1)
    steps = (x - corners[:, 0, :, None]).transpose(1, 0, 2)
    found = np.linalg.solve(sides, steps).transpose(1, 0, 2)
    for _ in range(20):
        off = np.einsum("ijkl,jkl->ikl", mapping.invDF(found, tind), x - mapping.F(found, tind))
        found = found + off
        if np.abs(off).max() < 1e-10:
            return found
    raise SystemExit("a tetrahedron at the sphere is bent too much")


def solve(mesh):
    """Fields at the vertices, and the functionals."""
    flat, (mesh, wall, box, moved) = mesh, curved(mesh)
    linear, quadratic = fem.bases(mesh, ORDER)
    mapping = mesh.mapping()
    mapping.invF = partial(inverse, mesh, mapping)
    on = [FacetBasis(mesh, basis.elem, mapping, ORDER, facets=faces) for basis in (linear, quadratic) for faces in (wall, box)]
    walls, sides, walls2, sides2 = on

    def given(v, w):
        value, slope = exact(w.x)
        return (value + dot(slope, w.n)) * v

    given = LinearForm(given)
    matrix = BilinearForm(lambda u, v, w: dot(grad(u), grad(v))).assemble(linear)
    matrix += BilinearForm(lambda u, v, w: u * v).assemble(sides)
    system = fem.System(matrix)
    u = system.solve(given.assemble(sides))
    at = walls.interpolate(u)
    force = Functional(lambda w: product(w.u.grad, w.u.grad, w)).assemble(walls, u=at)
    adjoint = system.solve(LinearForm(lambda v, w: 2 * product(w.u.grad, grad(v), w)).assemble(walls, u=at))
    # J is quadratic: of both the recovered ones are taken, so that what is left is of the order of the product of their errors.
    better, better_adjoint = (fem.recovered(flat, quadratic, values, moved) for values in (u, adjoint))
    inside = LinearForm(lambda v, w: -dot(w.u.grad, grad(v))).assemble(quadratic, u=quadratic.interpolate(better))
    taken = LinearForm(lambda v, w: w.u * v).assemble(sides2, u=sides2.interpolate(better))
    residual = inside + given.assemble(sides2) - taken
    better_force = Functional(lambda w: product(w.u.grad, w.u.grad, w)).assemble(walls2, u=walls2.interpolate(better))
    estimate = better_force - force + residual @ better_adjoint
    return {"u": u, "lambda": adjoint}, {"J": float(np.pi * RADIUS**2 + force), "J estimate": float(estimate)}
