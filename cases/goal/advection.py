"""Advection and diffusion in the unit cube: a layer off the path of the goal.

-ε Δu + b·∇u = f, whose solution is smooth but for a layer tanh((y - 0.1 x - 0.75)/δ) along the flow b. J is a mean of u about a point; what reaches it came
along the flow, half of the cube away from the layer. The fluxes of the exact solution are given where the flow comes in, its derivatives elsewhere, so that
the adjoint has no layers of its own.
"""

import numpy as np
from numpy.polynomial.legendre import leggauss
from skfem import BilinearForm, ElementTetP1, FacetBasis, LinearForm
from skfem.helpers import dot, grad

import fem

EPSILON, FLOW = 0.005, np.array([1.0, 0.1, 0.0])
# The smooth field 1 + HEIGHT sin(2x + y) cos(z).
HEIGHT = 0.1
# The layer, along the flow: its place at x = 0, half of its thickness.
LAYER, DELTA = 0.75, 0.02
# The goal: a point and the width of the mean about it.
POINT, MEAN = np.array([0.75, 0.25, 0.5]), 0.1
ORDER = 6


def exact(x):
    """u, ∇u and f at points (3, ...)."""
    wave, z = 2 * x[0] + x[1], x[2]
    along, across = HEIGHT * np.cos(wave) * np.cos(z), HEIGHT * np.sin(wave) * np.sin(z)
    smooth = HEIGHT * np.sin(wave) * np.cos(z)
    t = np.tanh((x[1] - FLOW[1] * x[0] - LAYER) / DELTA)
    rise = 0.5 * (1 - t**2) / DELTA
    slope = np.stack([2 * along - FLOW[1] * rise, along + rise, -across])
    laplacian = -6 * smooth - 2 * (1 + FLOW[1] ** 2) * t * rise / DELTA
    return 1 + smooth + 0.5 * (1 + t), slope, -EPSILON * laplacian + np.einsum("i,i...->...", FLOW, slope)


def weight(x):
    """The weight of the mean; its integral over all of space is 1."""
    square = ((x.T - POINT).T ** 2).sum(0)
    return np.exp(-square / (2 * MEAN**2)) / (2 * np.pi * MEAN**2) ** 1.5


def truth(points=160):
    """J of the exact solution, by Gauss's rule, right to 12 digits."""
    s, w = leggauss(points)
    s, w = (s + 1) / 2, w / 2
    total = 0.0
    for x, wx in zip(s, w):
        y, z = np.meshgrid(s, s, indexing="ij")
        at = np.stack([np.full_like(y, x), y, z])
        total += wx * (np.outer(w, w) * weight(at) * exact(at)[0]).sum()
    return total


@BilinearForm
def volume(u, v, w):
    return EPSILON * dot(grad(u), grad(v)) + np.einsum("i,i...->...", FLOW, grad(u)) * v


@BilinearForm
def inflow(u, v, w):
    return np.maximum(-np.einsum("i,i...->...", FLOW, w.n), 0) * u * v


@LinearForm
def flux(v, w):
    """Given derivatives, and where the flow comes in the flux that it brings."""
    value, slope, _ = exact(w.x)
    into = np.maximum(-np.einsum("i,i...->...", FLOW, w.n), 0)
    return (EPSILON * dot(slope, w.n) + into * value) * v


def solve(mesh):
    """Fields at the vertices, and the functionals."""
    linear, quadratic = fem.bases(mesh, ORDER)
    sides = FacetBasis(mesh, ElementTetP1(), intorder=ORDER)
    sides2 = FacetBasis(mesh, quadratic.elem, intorder=ORDER)
    matrix = volume.assemble(linear) + inflow.assemble(sides)
    source = LinearForm(lambda v, w: exact(w.x)[2] * v)
    goal = LinearForm(lambda v, w: weight(w.x) * v).assemble(linear)
    system = fem.System(matrix)
    u = system.solve(source.assemble(linear) + flux.assemble(sides))
    adjoint = system.solve(goal, transposed=True)
    inside = LinearForm(
        lambda v, w: exact(w.x)[2] * v - EPSILON * dot(w.u.grad, grad(v)) - np.einsum("i,i...->...", FLOW, w.u.grad) * v
    )
    taken = LinearForm(lambda v, w: np.maximum(-np.einsum("i,i...->...", FLOW, w.n), 0) * w.u * v)
    residual = inside.assemble(quadratic, u=linear.interpolate(u))
    residual += flux.assemble(sides2) - taken.assemble(sides2, u=sides.interpolate(u))
    estimate = residual @ fem.bubbles(mesh, quadratic, adjoint)
    return {"u": u, "lambda": adjoint}, {"J": float(goal @ u), "J estimate": float(estimate)}
