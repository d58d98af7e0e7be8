"""Linear elasticity of a bracket, by scikit-fem: the holes of its foot are held, its bore is pulled.

    python solve.py MESH.vtu SOLUTION.vtu      # result.json with the functionals goes beside the solution
"""

import json
import sys
from pathlib import Path

import meshio
import numpy as np
from skfem import Basis, BilinearForm, ElementTetP1, ElementVector, FacetBasis, LinearForm, MeshTet, condense, solve
from skfem.helpers import ddot, eye, sym_grad, trace
from skfem.models.elasticity import lame_parameters

HELD = [15, 16]
PULLED = 12
PULL = np.array([1.0, 0.0, 0.0])
LAMBDA, MU = lame_parameters(1e3, 0.3)


def stress(strain):
    """Hooke's law."""
    return 2 * MU * strain + LAMBDA * eye(trace(strain), 3)


@BilinearForm
def stiffness(u, v, w):
    return ddot(stress(sym_grad(u)), sym_grad(v))


@LinearForm
def load(v, w):
    return sum(PULL[k] * v[k] for k in range(3))


def read(path):
    """The mesh with its faces of the model as boundaries."""
    found = meshio.read(path)
    tets = np.concatenate([block.data for block in found.cells if block.type == "tetra"])
    references = found.cell_data["reference"]
    triangles = [(block.data, np.ravel(of)) for block, of in zip(found.cells, references) if block.type == "triangle"]
    corners, faces = (np.concatenate(part) for part in zip(*triangles))
    mesh = MeshTet(np.ascontiguousarray(found.points.T), np.ascontiguousarray(tets.T.astype(np.int64)))
    numbers = {tuple(facet): number for number, facet in enumerate(np.sort(mesh.facets, axis=0).T)}
    of_face = {
        face: np.array([numbers[tuple(nodes)] for nodes in np.sort(corners[faces == face], axis=1)]) for face in np.unique(faces)
    }
    return found, tets, mesh, of_face


def von_mises(mesh, basis, u):
    """At the vertices: the mean of the tetrahedra about each, by their volumes."""
    strain = sym_grad(basis.interpolate(u))
    s = stress(strain).mean(axis=-1)
    deviator = s - np.trace(s) / 3 * np.eye(3)[:, :, None]
    of_tets = np.sqrt(1.5 * (deviator**2).sum(axis=(0, 1)))
    volumes = basis.dx.sum(axis=1)
    sums, weights = np.zeros(mesh.p.shape[1]), np.zeros(mesh.p.shape[1])
    for corner in mesh.t:
        np.add.at(sums, corner, volumes * of_tets)
        np.add.at(weights, corner, volumes)
    return sums / weights


def main():
    found, tets, mesh, of_face = read(sys.argv[1])
    basis = Basis(mesh, ElementVector(ElementTetP1()))
    force = load.assemble(FacetBasis(mesh, basis.elem, facets=of_face[PULLED]))
    held = basis.get_dofs(np.concatenate([of_face[face] for face in HELD]))
    u = solve(*condense(stiffness.assemble(basis), force, D=held))
    mises = von_mises(mesh, basis, u)
    target = Path(sys.argv[2])
    data = {"mises": mises, "displacement": u.reshape(-1, 3)}
    meshio.Mesh(found.points, [("tetra", tets)], point_data=data).write(target)
    functionals = {"work": float(force @ u), "greatest stress": float(mises.max())}
    target.with_name("result.json").write_text(json.dumps(functionals))
    print(f"{len(mises)} vertices, work of the load {functionals['work']:.6g}, greatest stress {functionals['greatest stress']:.4g}")


if __name__ == "__main__":
    main()
