"""Advection and diffusion in the unit cube: a layer off the path of the goal.

-ε Δu + b·∇u = f, whose solution is a plume and a layer of height 1, both along the flow b. J is a mean of u about a point of the plume; what reaches it came
along the flow, half of the cube away from the layer. The fluxes of the exact solution are given where the flow comes in, its derivatives elsewhere, so that
the adjoint has no layers of its own.
"""

import numpy as np
from numpy.polynomial.legendre import leggauss
from skfem import BilinearForm, ElementTetP1, FacetBasis, LinearForm
from skfem.helpers import dot, grad

import fem

EPSILON, FLOW = 0.01, np.array([1.0, 0.1, 0.0])
# The plume HEIGHT (1 + sin(WAVES x)/2) exp(-(y² + z²)/(2 WIDTH²)), y and z from its middle, which is MIDDLE at x = 0 and goes along the flow.
HEIGHT, WAVES, WIDTH, MIDDLE = 0.02, 3.0, 0.3, (0.125, 0.5)
# The layer, from 0 to 1: its place at x = 0, half of its thickness. It goes along the flow too.
LAYER, DELTA = 0.85, 0.02
# The goal: a point in the plume and the width of the mean about it.
POINT, MEAN = np.array([0.5, 0.175, 0.5]), 0.1
ORDER = 6


def exact(x):
    """u, ∇u and f at points (3, ...)."""
    drift = FLOW[1] / FLOW[0]
    y, z = x[1] - drift * x[0] - MIDDLE[0], x[2] - MIDDLE[1]
    plume = HEIGHT * np.exp(-(y**2 + z**2) / (2 * WIDTH**2))
    wave, rising = 1 + 0.5 * np.sin(WAVES * x[0]), 0.5 * WAVES * np.cos(WAVES * x[0])
    by_y, by_z = -y / WIDTH**2 * plume, -z / WIDTH**2 * plume
    by_yy, by_zz = (y**2 / WIDTH**2 - 1) / WIDTH**2 * plume, (z**2 / WIDTH**2 - 1) / WIDTH**2 * plume
    t = np.tanh((x[1] - drift * x[0] - LAYER) / DELTA)
    rise = 0.5 * (1 - t**2) / DELTA
    slope = np.stack([rising * plume - drift * (wave * by_y + rise), wave * by_y + rise, wave * by_z])
    laplacian = (1 - wave) * WAVES**2 * plume - 2 * drift * rising * by_y + (1 + drift**2) * (wave * by_yy - 2 * t * rise / DELTA) + wave * by_zz
    return wave * plume + 0.5 * (1 + t), slope, -EPSILON * laplacian + np.einsum("i,i...->...", FLOW, slope)


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
