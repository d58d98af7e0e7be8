"""Laplace's equation about the edge of an extruded L: u = r^(2/3) sin(2θ/3), and J a mean of u beside the edge.

On a uniform mesh both u and the adjoint converge as h^(2/3) in their gradients, so that J does as h^(4/3), N^(-4/9). The two faces at the edge have u = 0;
the others have the derivative of the exact solution.
"""

import numpy as np
from numpy.polynomial.legendre import leggauss
from skfem import BilinearForm, ElementTetP1, FacetBasis, LinearForm
from skfem.helpers import dot, grad

import fem

POINT, MEAN = np.array([-0.5, 0.5]), 0.2
ORDER = 4
# Cells along a side of a square.
CELLS = 4


def polar(x):
    """Radius, and the angle from the face y = 0, 0 to 3π/2."""
    return np.hypot(x[0], x[1]), np.mod(np.arctan2(x[1], x[0]), 2 * np.pi)


def exact(x):
    """u at points (3, ...) or (2, ...)."""
    r, angle = polar(x)
    return r ** (2 / 3) * np.sin(2 * np.minimum(angle, 1.75 * np.pi) / 3)


def slope(x):
    """Its gradient; not at the edge."""
    r, angle = polar(x)
    size = 2 / 3 * r ** (-1 / 3)
    return np.stack([-size * np.sin(angle / 3), size * np.cos(angle / 3), 0 * r])


def weight(x):
    """The weight of the mean, the same at all heights."""
    square = (x[0] - POINT[0]) ** 2 + (x[1] - POINT[1]) ** 2
    return np.exp(-square / (2 * MEAN**2)) / (2 * np.pi * MEAN**2)


def truth(points=120):
    """J of the exact solution: Gauss's rule on each square, its points drawn to the edge."""
    s, w = leggauss(points)
    s, w = (s + 1) / 2, w / 2
    t, wt = s**3, 3 * s**2 * w
    total = 0.0
    for sx, sy in [(1, 1), (-1, 1), (-1, -1)]:
        at = np.stack(np.meshgrid(sx * t, sy * t, indexing="ij"))
        total += (np.outer(wt, wt) * exact(at) * weight(at)).sum()
    return total


def start():
    """Points (n, 3), tetrahedra, triangles of the surface and their references of the first mesh: cubes of six tetrahedra each."""
    at = {}
    cells = [(i, j, k) for i in range(-CELLS, CELLS) for j in range(-CELLS, CELLS) for k in range(CELLS) if i < 0 or j >= 0]
    number = lambda p: at.setdefault(p, len(at))  # noqa: E731
    paths = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    tets = []
    for cell in cells:
        for path in paths:
            p, corners = list(cell), [number(cell)]
            for axis in path:
                p[axis] += 1
                corners.append(number(tuple(p)))
            tets.append(corners)
    points = np.array(list(at)) / CELLS
    tets = np.array(tets)
    a, b, c, d = points[tets].transpose(1, 0, 2)
    turned = np.einsum("ni,ni->n", np.cross(b - a, c - a), d - a) < 0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    faces = tets[:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]].reshape(-1, 3)
    _, index, count = np.unique(np.sort(faces, 1), axis=0, return_index=True, return_counts=True)
    faces = faces[index[count == 1]]
    sides = [(0, -1), (0, 0), (0, 1), (1, -1), (1, 0), (1, 1), (2, 0), (2, 1)]
    refs = np.zeros(len(faces), int)
    for ref, (axis, value) in enumerate(sides, 1):
        refs[(points[faces][:, :, axis] == value).all(1)] = ref
    return points, tets, faces, refs


def solve(mesh):
    """Fields at the vertices, and the functionals."""
    linear, quadratic = fem.bases(mesh, ORDER)
    near = 1e-9
    points = mesh.p
    grounded = ((np.abs(points[1]) < near) & (points[0] > -near)) | ((np.abs(points[0]) < near) & (points[1] < near))
    middle = points[:, mesh.facets].mean(1)
    outside = mesh.boundary_facets()
    on_ground = ((np.abs(middle[1]) < near) & (middle[0] > 0)) | ((np.abs(middle[0]) < near) & (middle[1] < 0))
    others = outside[~on_ground[outside]]
    sides, sides2 = (FacetBasis(mesh, element, facets=others, intorder=ORDER + 2) for element in (ElementTetP1(), quadratic.elem))
    given = LinearForm(lambda v, w: dot(slope(w.x), w.n) * v)
    matrix = BilinearForm(lambda u, v, w: dot(grad(u), grad(v))).assemble(linear)
    goal = LinearForm(lambda v, w: weight(w.x) * v).assemble(linear)
    system = fem.System(matrix, np.flatnonzero(grounded))
    u, adjoint = system.solve(given.assemble(sides)), system.solve(goal)
    inside = LinearForm(lambda v, w: -dot(w.u.grad, grad(v)))
    residual = inside.assemble(quadratic, u=linear.interpolate(u)) + given.assemble(sides2)
    beyond = fem.bubbles(mesh, quadratic, adjoint)
    # The adjoint vanishes where u is given.
    beyond[quadratic.get_dofs(outside[on_ground[outside]]).flatten()] = 0
    return {"u": u, "lambda": adjoint}, {"J": float(goal @ u), "J estimate": float(residual @ beyond)}
