"""The figures of the flat plate: its slab, the law of the wall, and the friction along it."""

import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import numpy as np

CASES = Path(__file__).resolve().parents[2] / "cases"
sys.path[:0] = [str(CASES), str(CASES / "flat-plate")]
import plate  # noqa: E402
from judging import meshfile, metric, validity  # noqa: E402


class Plate(unittest.TestCase):
    def test_the_slab_is_a_mesh_with_its_surfaces(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.mesh"
            plate.coarse(path)
            mesh = meshfile.read_mesh(path)
        self.assertEqual(validity.findings(mesh), [])
        self.assertAlmostEqual(metric.volumes(mesh.points, mesh.tets).sum(), (plate.END - plate.FRONT) * plate.HEIGHT * plate.WIDTH)
        self.assertEqual(set(mesh.triangle_refs), set(plate.NAMES))
        wall = mesh.points[np.unique(mesh.triangles[mesh.triangle_refs == 1])]
        self.assertTrue((wall[:, 1] == 0).all() and wall[:, 0].min() == 0 and wall[:, 0].max() == plate.END)

    def test_the_law_of_the_wall(self):
        # Near the wall u⁺ = y⁺; far from it ln(y⁺)/κ + B.
        self.assertAlmostEqual(float(plate.spalding(0.5)), 0.5, places=3)
        self.assertAlmostEqual(float(plate.spalding(1e3)), np.log(1e3) / plate.KAPPA + plate.B, places=1)

    def test_friction_and_profile_of_a_known_flow(self):
        x = np.linspace(0, 2, 201)
        points = np.concatenate([np.stack([x, 0 * x, 0 * x], axis=1), np.stack([0.97 + 0 * x, np.linspace(1e-6, 1e-3, 201), 0 * x], axis=1)])
        mesh = SimpleNamespace(points=points, triangles=np.arange(201).reshape(-1, 3), triangle_refs=np.ones(67, int))
        c_f = 0.0027
        shear = plate.MACH * np.sqrt(plate.GAMMA) * np.sqrt(c_f / 2)
        velocity = shear * plate.spalding(points[:, 1] * plate.REYNOLDS * np.sqrt(c_f / 2))
        zero = np.zeros((len(points), 3))
        friction, momentum = zero.copy(), zero.copy()
        friction[:, 0], momentum[:, 0] = c_f + 1e-4 * (points[:, 0] - 0.97), velocity
        fields = {"Skin_Friction_Coefficient": friction, "Momentum": momentum, "Density": np.ones(len(points))}
        self.assertAlmostEqual(plate.friction(mesh, fields, 0.97)[2], c_f)
        y_plus, u_plus = plate.profile(mesh, fields, 0.97, c_f, 0.01)
        self.assertTrue(np.allclose(u_plus, plate.spalding(y_plus)))


if __name__ == "__main__":
    unittest.main()
