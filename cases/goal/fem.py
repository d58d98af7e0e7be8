"""What the three solvers share: linear tetrahedra by scikit-fem, the discrete adjoint, and the estimate of the error in a functional.

With linear equations a(u, v) = l(v) and the adjoint a(w, λ) = J'(w) the error of J is the residual r(λ - λ_h), r(v) = l(v) - a(u_h, v). The residual of
a linear function vanishes, so of λ only what is not linear in a tetrahedron counts. It is recovered: a quadratic function is fitted about each vertex,
and λ* at the middle of an edge is the mean of those of its ends there, less the mean of λ_h (Becker and Rannacher 2001, section 5; Venditti and Darmofal 2002).
"""

import meshio
import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, bicgstab, spilu
from skfem import Basis, ElementTetP1, ElementTetP2, MeshTet

TOLERANCE = 1e-11
# Vertices that are fitted at once.
CHUNK = 2000


def read(path):
    """The tetrahedra of a file of meshio, as scikit-fem has them."""
    found = meshio.read(path)
    tets = np.concatenate([block.data for block in found.cells if block.type == "tetra"])
    return MeshTet(np.ascontiguousarray(found.points.T), np.ascontiguousarray(tets.T.astype(np.int64)))


def write(path, mesh, fields):
    """The mesh with fields at its vertices, each (n,)."""
    meshio.Mesh(mesh.p.T, [("tetra", mesh.t.T)], point_data=fields).write(path)


def bases(mesh, order):
    """Linear functions, and quadratic ones on the same points of quadrature."""
    return Basis(mesh, ElementTetP1(), intorder=order), Basis(mesh, ElementTetP2(), intorder=order)


class System:
    """A matrix with its incomplete factors, which solve it and its transpose; unknowns in `fixed` stay zero."""

    def __init__(self, matrix, fixed=()):
        self.size = matrix.shape[0]
        self.free = np.setdiff1d(np.arange(self.size), fixed)
        self.inner = matrix.tocsr()[self.free][:, self.free].tocsc()
        self.factors = spilu(self.inner, drop_tol=1e-4, fill_factor=12)

    def solve(self, right, transposed=False):
        """x of A x = b, or Aᵀ x = b, (n,)."""
        kind = "T" if transposed else "N"
        matrix = self.inner.T if transposed else self.inner
        inverse = LinearOperator(matrix.shape, lambda b: self.factors.solve(np.ravel(b), kind))
        right = np.asarray(right)[self.free]
        found, failed = bicgstab(matrix, right, x0=inverse.matvec(right), M=inverse, rtol=TOLERANCE, maxiter=1000)
        if failed:
            raise SystemExit(f"the linear system was not solved (bicgstab: {failed})")
        whole = np.zeros(self.size)
        whole[self.free] = found
        return whole


def derivatives(mesh, values):
    """Gradients (n, 3) and second derivatives (n, 3, 3) at the vertices of a field (n,): weighted least squares over two rings, in coordinates in which their points have
    the identity for second moments, so that a stretched mesh is fitted as any other."""
    points, count = mesh.p.T, mesh.p.shape[1]
    ends = mesh.edges
    ones = np.ones(ends.shape[1])
    ring = sp.coo_matrix((ones, (ends[0], ends[1])), (count, count)).tocsr()
    ring = ring + ring.T
    rings = (ring @ ring + ring).tocoo()
    others = rings.row != rings.col
    rings = sp.coo_matrix((rings.data[others], (rings.row[others], rings.col[others])), (count, count)).tocsr()
    slopes, bends = np.empty((count, 3)), np.empty((count, 3, 3))
    for start in range(0, count, CHUNK):
        stop = min(start + CHUNK, count)
        first, last = rings.indptr[start], rings.indptr[stop]
        near = rings.indices[first:last]
        sizes = np.diff(rings.indptr[start : stop + 1])
        owner = np.repeat(np.arange(stop - start), sizes)
        begins = rings.indptr[start:stop] - first
        sums = lambda rows: np.add.reduceat(rows, begins, axis=0)  # noqa: E731
        steps = points[near] - points[start + owner]
        rise = values[near] - values[start + owner]
        inverse = np.linalg.inv(np.linalg.cholesky(sums(steps[:, :, None] * steps[:, None, :])))
        y = np.einsum("nij,nj->ni", inverse[owner], steps)
        square = (y**2).sum(1)
        weight = 1 / (square + (0.25 * sums(square) / sizes)[owner])
        a, b, c = y.T
        terms = np.stack([a, b, c, a * a / 2, a * b, b * b / 2, a * c, b * c, c * c / 2], 1) * weight[:, None]
        normal = sums(terms[:, :, None] * terms[:, None, :])
        # Where the points do not tell a term, it is small rather than any.
        normal += 1e-9 * np.einsum("nii->n", normal)[:, None, None] * np.eye(9)
        fitted = np.linalg.solve(normal, sums(terms * (weight * rise)[:, None])[:, :, None])[:, :, 0]
        own = fitted[:, [3, 4, 6, 4, 5, 7, 6, 7, 8]].reshape(-1, 3, 3)
        slopes[start:stop] = np.einsum("nki,nk->ni", inverse, fitted[:, :3])
        bends[start:stop] = np.einsum("nki,nkl,nlj->nij", inverse, own, inverse)
    return slopes, bends


def bubbles(mesh, quadratic, values, moved=None):
    """What a recovered field has beyond its linear interpolation, as a vector of the quadratic basis. `moved`, (3, edges), is how far the middles of
    the edges of quadratic tetrahedra lie from those of straight ones."""
    slopes, bends = derivatives(mesh, values)
    middles = mesh.p[:, mesh.edges].mean(1) + (0 if moved is None else moved)
    over = 0
    for end in mesh.edges:
        step = (middles - mesh.p[:, end]).T
        over += 0.5 * (np.einsum("ei,ei->e", slopes[end], step) + 0.5 * np.einsum("ei,eij,ej->e", step, bends[end], step))
    beyond = np.zeros(quadratic.N)
    beyond[quadratic.edge_dofs[0]] = over
    return beyond


def recovered(mesh, quadratic, values, moved=None):
    """All of it: a vector of the quadratic basis."""
    whole = bubbles(mesh, quadratic, values, moved)
    whole[quadratic.nodal_dofs[0]] = values
    whole[quadratic.edge_dofs[0]] += values[mesh.edges].mean(0)
    return whole
