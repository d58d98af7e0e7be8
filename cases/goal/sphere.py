"""Potential flow about a sphere: the force of the pressure on its front half, -q π R²/8.

φ = x + R³ x / (2 r³) with unit speed; on the sphere the pressure is q (1 - |∇φ|²). The force is taken in the fluid: T = ∇φ⊗∇φ - |∇φ|²/2 has no divergence,
so that with a field v that is min(n_x, 0) n on the sphere and vanishes on the box F/q = πR² + 2 ∫ T : ∇v (Giles, Larson, Levenstam and Süli 1997:
functionals of boundaries converge faster so). On the box φ + ∂φ/∂n is given.
"""

import numpy as np
from skfem import BilinearForm, ElementTetP1, FacetBasis, Functional, LinearForm, MeshTet2
from skfem.helpers import dot, grad

import fem

CENTRE, RADIUS = np.array([0.9, 0.8, 0.6]), 0.3
# v ends here; the box is farther.
REACH = 0.55
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


def extension(x):
    """∂_j v_i at points (3, ...), shape (3, 3, ...)."""
    d = (x.T - CENTRE).T
    r = np.sqrt((d**2).sum(0))
    e = d / r
    part = np.clip((r - RADIUS) / (REACH - RADIUS), 0, 1)
    fade, slope = np.cos(np.pi / 2 * part) ** 2, -np.pi / 2 * np.sin(np.pi * part) / (REACH - RADIUS)
    front, is_front = np.minimum(e[0], 0), (e[0] < 0).astype(float)
    unit = np.eye(3).reshape(3, 3, *[1] * (x.ndim - 1))
    radial = e[:, None] * e[None, :]
    across = (unit - radial) / r
    return front * slope * radial + fade * (is_front * e[:, None] * across[0][None, :] + front * across)


def tension(a, b, w):
    """The symmetric form whose value at ∇φ, ∇φ is 2 T : ∇v."""
    gradient = extension(w.x)
    both = np.einsum("i...,ij...,j...->...", a, gradient, b) + np.einsum("i...,ij...,j...->...", b, gradient, a)
    return both - dot(a, b) * np.einsum("ii...->...", gradient)


def curved(mesh):
    """The mesh with quadratic tetrahedra, its faces on the box, and how far the middles of the edges moved: the middles of edges on the sphere are on it too. Flat faces have a gap of h²/8R, and the force is the small
    difference of two larger numbers."""
    outside = mesh.boundary_facets()
    middle = np.linalg.norm(mesh.p[:, mesh.facets].mean(1).T - CENTRE, axis=1)
    wall, box = outside[middle[outside] < REACH], outside[middle[outside] > REACH]
    edges = np.unique(mesh.f2e[:, wall])
    bent = MeshTet2.from_mesh(mesh)
    places = bent.doflocs.copy()
    at = fem.Basis(mesh, fem.ElementTetP2()).edge_dofs[0, edges]
    steps = (places[:, at].T - CENTRE).T
    places[:, at] = (CENTRE + RADIUS * (steps / np.linalg.norm(steps, axis=0)).T).T
    moved = places[:, fem.Basis(mesh, fem.ElementTetP2()).edge_dofs[0]] - mesh.p[:, mesh.edges].mean(1)
    return MeshTet2(places, bent.t), box, moved


def solve(mesh):
    """Fields at the vertices, and the functionals."""
    flat, (mesh, box, moved) = mesh, curved(mesh)
    linear, quadratic = fem.bases(mesh, ORDER)
    sides, sides2 = (FacetBasis(mesh, element, facets=box, intorder=ORDER) for element in (ElementTetP1(), quadratic.elem))

    def given(v, w):
        value, slope = exact(w.x)
        return (value + dot(slope, w.n)) * v

    given = LinearForm(given)
    matrix = BilinearForm(lambda u, v, w: dot(grad(u), grad(v))).assemble(linear)
    matrix += BilinearForm(lambda u, v, w: u * v).assemble(sides)
    system = fem.System(matrix)
    u = system.solve(given.assemble(sides))
    at = linear.interpolate(u)
    force = Functional(lambda w: tension(w.u.grad, w.u.grad, w)).assemble(linear, u=at)
    goal = LinearForm(lambda v, w: 2 * tension(w.u.grad, grad(v), w))
    adjoint = system.solve(goal.assemble(linear, u=at))
    inside = LinearForm(lambda v, w: -dot(w.u.grad, grad(v)))
    taken = LinearForm(lambda v, w: w.u * v)
    residual = inside.assemble(quadratic, u=at) + given.assemble(sides2) - taken.assemble(sides2, u=sides.interpolate(u))
    # J is quadratic: half of its second derivative is left.
    beyond = quadratic.interpolate(fem.bubbles(flat, quadratic, u, moved))
    rest = Functional(lambda w: tension(w.e.grad, w.e.grad, w)).assemble(quadratic, e=beyond)
    estimate = residual @ fem.bubbles(flat, quadratic, adjoint, moved) + rest
    return {"u": u, "lambda": adjoint}, {"J": float(np.pi * RADIUS**2 + force), "J estimate": float(estimate)}
