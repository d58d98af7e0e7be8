"""The study of the interpolation error measures what it says: rules, the error, the scalars, the fit, what is held."""

import itertools
import math
import sys
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cases"))
from comparing.uniform import uniform_cube  # noqa: E402
from convergence_study import command, quadrature, scalars, study  # noqa: E402


def error(count, function):
    mesh = uniform_cube(count)
    return quadrature.interpolation_error(mesh.points, mesh.tets, function)


class Rules(unittest.TestCase):
    def test_both_rules_are_of_degree_five_and_no_more(self):
        for weights, places in (quadrature.FIRST, quadrature.SECOND):
            def off(power):
                # ∫ λ^a over a tetrahedron of volume 1
                exact = 6 * math.prod(map(math.factorial, power)) / math.factorial(sum(power) + 3)
                return abs((weights * (places ** np.array(power)).prod(1)).sum() / exact - 1)
            powers = list(itertools.product(range(7), repeat=4))
            self.assertLess(max(off(power) for power in powers if sum(power) <= 5), 1e-13)
            self.assertGreater(max(off(power) for power in powers if sum(power) == 6), 1e-3)

    def test_the_halves_of_a_tetrahedron_are_eighths_of_it(self):
        self.assertTrue(np.allclose(np.abs(np.linalg.det(quadrature.HALVES)), 1 / 8))
        # points within are in one of them: barycentric coordinates in the halves
        inside = np.random.default_rng(1).dirichlet(np.ones(4), 500)
        within = [(np.linalg.solve(half.T, inside.T) > 0).all(0) for half in quadrature.HALVES]
        self.assertTrue((np.sum(within, axis=0) == 1).all())


class Errors(unittest.TestCase):
    def test_of_a_square_it_is_known(self):
        # (x - a)(a + h - x) in each layer: the norm is h²/√30
        for count in (2, 5, 9):
            found, doubt = error(count, lambda points: points[:, 0] ** 2)
            self.assertAlmostEqual(found * (count - 1) ** 2 * math.sqrt(30), 1, places=12)
            self.assertLess(doubt, 1e-12)

    def test_of_a_linear_function_there_is_none(self):
        self.assertLess(error(4, lambda points: points @ [1.0, -2.0, 0.5] + 3)[0], 1e-14)

    def test_of_a_jump_within_tetrahedra_it_is_right_to_its_doubt(self):
        # one cell, interpolant x: ∫_0^s x² + ∫_s^1 (1 - x)²
        for place in (0.3, 0.47, 0.81):
            found, doubt = error(2, lambda points: (points[:, 0] > place) * 1.0)
            exact = math.sqrt((place**3 + (1 - place) ** 3) / 3)
            self.assertLess(abs(found / exact - 1), max(doubt, 1e-3))
            self.assertLess(doubt, quadrature.TOLERANCE)

    def test_of_a_thin_layer_it_is_right_to_its_doubt(self):
        # tanh(x/ε) is 1 but in the layer: ∫ (1 - x)² = 1/3 less about 2ε(1 - …), from one cell whose interpolant is x
        def layer(points):
            return np.tanh(points[:, 0] / 1e-3)
        x = (np.arange(2_000_000) + 0.5) / 2_000_000
        exact = math.sqrt(((np.tanh(x / 1e-3) - x) ** 2).mean())
        found, doubt = error(2, layer)
        self.assertLess(abs(found / exact - 1), max(doubt, 1e-3))


class Scalars(unittest.TestCase):
    def test_values(self):
        points = np.array([[0.5, 0.9, 0.7], [0.1, 0.9, 1.0], [1.0, 1.0, 1.0]])
        s = (points - 0.4).prod(1)
        self.assertTrue((s[1] < -np.pi / 50) and (s[2] > 2 * np.pi / 50) and abs(s[0]) < np.pi / 50)
        self.assertTrue(np.allclose(scalars.sinfun3(points), np.sin(50 * s) * [1, 0.1, 0.1]))
        self.assertAlmostEqual(scalars.tanh3(np.array([[0.2, 0.5, 0.5]]))[0], math.tanh(1.5**20 * 0.2**9 * 0.5))
        self.assertAlmostEqual(scalars.sinatan3(np.array([[0.2, 0.5, 0.5]]))[0], 0.1 * math.sin(5) + math.atan(0.1 / (math.sin(2.5) - 0.2)))


class Study(unittest.TestCase):
    def test_order_of_a_power_of_the_vertices(self):
        vertices = np.array([16e3, 30e3, 61e3])
        self.assertAlmostEqual(study.fitted_order(vertices, 7 * vertices ** (-2 / 3)), 2 / 3, places=12)

    def test_uniform_meshes_reach_second_order_where_the_scalar_is_smooth(self):
        steps = [study.uniform_error(lambda points: np.sin(3 * points).sum(1), vertices) for vertices in (1000, 4000, 16000)]
        self.assertLess(abs(study.fitted_order(*zip(*[((round(count ** (1 / 3)) - 1) ** 3, off) for count, off in steps])) - 2 / 3), 0.01)

    def test_complexities_are_doubled_up_to_the_last(self):
        self.assertEqual(study.complexities(64_000), [1000, 2000, 4000, 8000, 16_000, 32_000, 64_000])
        self.assertEqual(study.complexities(3000), [750, 1500, 3000])
        self.assertEqual(study.complexities(200), [200])

    def test_complexities_beyond_the_last_end_at_the_finest(self):
        self.assertEqual(study.beyond(64_000, 256_000), [128_000, 256_000])
        self.assertEqual(study.beyond(1000, 3000), [2000, 3000])

    def test_what_is_not_reached_is_said(self):
        def result(order, times, complexity=64_000.0, doubt=0.01):
            last = {"complexity": complexity, "error": 1.0, "uniform_error": times, "finest_error": None}
            return {"order": order, "finest_order": None, "doubt": doubt, "steps": [last]}
        order, times, finest_order, finest_times = (bound.floor for bound in command.BOUNDS["sinatan3"])
        self.assertEqual(command.hold("sinatan3", result(order, times))[1], [])
        self.assertEqual(len(command.hold("sinatan3", result(order - 0.01, times - 0.1))[1]), 2)
        self.assertEqual(command.hold("sinatan3", result(order - 0.01, times - 0.1, 32_000.0)), ([], []), "held from 64 000 on")
        self.assertEqual(len(command.hold("tanh3", result(1.0, 2.0, doubt=0.03))[1]), 1)
        measured = result(order, times) | {"finest_order": finest_order}
        measured["steps"][0] |= {"finest_error": 2.0, "uniform_finest_error": 2.0 * finest_times}
        told, lost = command.hold("sinatan3", measured)
        self.assertEqual((len(told), lost), (4, []), "against the finest mesh too")
        self.assertEqual(len(command.hold("sinatan3", measured | {"finest_order": finest_order - 0.01})[1]), 1)
        self.assertIn("not reached", command.hold("sinatan3", result(order, 0.9 * 20))[0][1])


if __name__ == "__main__":
    unittest.main()
