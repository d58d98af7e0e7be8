"""The case of the NACA 0012: its profile as one curve, its slab, the ideal flow about it, and what is taken from a flow."""

import re
import sys
import tempfile
import unittest
from collections import Counter
from math import comb
from pathlib import Path
from types import SimpleNamespace

import numpy as np

CASES = Path(__file__).resolve().parents[2] / "cases"
sys.path[:0] = [str(CASES), str(CASES / "naca0012")]
import airfoil  # noqa: E402
import figures  # noqa: E402
import model  # noqa: E402
from judging import meshfile, metric, validity, walls  # noqa: E402


class Naca0012(unittest.TestCase):
    def test_one_curve_is_the_whole_upper_side(self):
        s, poles = np.linspace(0, 1, 101)[:, None], airfoil.poles()
        curve = sum(comb(8, i) * s**i * (1 - s) ** (8 - i) * poles[i] for i in range(9))
        self.assertLess(np.abs(curve[:, 1] - airfoil.half(curve[:, 0])).max(), 1e-15)
        # The blunt profile of 12 %, stretched along the chord alone until it ends sharp, is a little thinner.
        self.assertTrue(0.1185 < 2 * airfoil.half(0.3) < 0.12)

    def test_the_slab_is_a_mesh_with_its_surfaces(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.mesh"
            airfoil.coarse(path)
            mesh = meshfile.read_mesh(path)
        self.assertEqual(validity.findings(mesh), [])
        self.assertEqual(set(mesh.triangle_refs), set(airfoil.NAMES))
        wall = mesh.points[np.unique(mesh.triangles[np.isin(mesh.triangle_refs, figures.WALL)])]
        self.assertLess(np.abs(np.abs(wall[:, 2]) - airfoil.half(wall[:, 0])).max(), 1e-15)
        inside = metric.volumes(mesh.points, mesh.tets).sum() / airfoil.WIDTH
        self.assertTrue(0.08 < 4 * airfoil.FAR**2 - inside < 0.0822)

    def test_every_edge_of_the_model_has_a_face_on_either_side(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.step"
            model.write(path)
            text = path.read_text()
        used = re.findall(r"ORIENTED_EDGE\('',\*,\*,(#\d+),\.([TF])\.\)", text)
        self.assertEqual(set(Counter(used).values()), {1})
        self.assertEqual(set(Counter(edge for edge, _ in used).values()), {2})
        self.assertEqual(re.findall(r"ADVANCED_FACE\('(\w+)'", text), list(airfoil.NAMES.values()))

    def test_the_ideal_flow_has_the_lift_of_potential_theory(self):
        # Thin profiles have 2 π sin α; 12 % of thickness add some 9 %.
        for angle in (2, 10):
            lift = figures.ideal(angle)[2]
            self.assertTrue(1.07 < lift / (2 * np.pi * np.sin(np.radians(angle))) < 1.11, lift)
        _, pressure, lift = figures.ideal(0)
        self.assertAlmostEqual(lift, 0)
        self.assertTrue(0.98 < pressure.max() < 1, "the nose is a stagnation point")

    def test_profile_and_heights_of_a_known_flow(self):
        at, friction = 0.5, 0.003
        slope = (airfoil.half(at + 1e-6) - airfoil.half(at - 1e-6)) / 2e-6
        along = np.array([1, 0, slope]) / np.hypot(1, slope)
        height = np.geomspace(1e-6, 1e-3, 99)
        points = np.array([at, 0, airfoil.half(at)]) + height[:, None] * np.array([-along[2], 0, along[0]])
        wanted = walls.spalding(height * figures.REYNOLDS * np.sqrt(friction / 2))
        momentum = figures.SPEED * np.sqrt(friction / 2) * wanted[:, None] * along
        mesh = SimpleNamespace(points=points)
        _, found = figures.profile(mesh, {"Momentum": momentum, "Density": np.ones(99)}, at, friction)
        self.assertLess(np.abs(found / wanted - 1).max(), 1e-3)
        corners = np.array([[0.5, 0, 0], [0.6, 0, 0], [0.5, 0.1, 0], [0.5, 0, 1e-3]])
        one = SimpleNamespace(points=corners, tets=np.array([[0, 1, 2, 3]]), triangles=np.array([[0, 1, 2]]), triangle_refs=np.array([1]))
        height, ratio = figures.heights(one)
        self.assertAlmostEqual(float(height[0]), 1e-3)
        self.assertAlmostEqual(float(ratio[0]), np.sqrt(0.02) / 1e-3)


if __name__ == "__main__":
    unittest.main()
