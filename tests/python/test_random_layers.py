"""The random layers: what a seed draws, and that their metrics have the sizes they name."""

import sys
import unittest
from pathlib import Path

import numpy as np

CASES = Path(__file__).resolve().parents[2] / "cases"
sys.path[:0] = [str(CASES), str(CASES / "random-layers")]
import layers  # noqa: E402

MODELS = {name: {"bounds": [[0, 0, 0], [1, 2, 3]], "diagonal": 14**0.5, "faces": [{}] * 6} for name in ("b", "a")}


def size(metrics, direction):
    """Sizes along a direction."""
    return np.einsum("i,nij,j->n", direction, metrics, direction) ** -0.5


class Drawn(unittest.TestCase):
    def test_a_seed_draws_the_same_job_and_others_other_ones(self):
        told = [layers.drawn(seed, MODELS).told() for seed in range(50)]
        self.assertEqual(told, [layers.drawn(seed, MODELS).told() for seed in range(50)])
        self.assertEqual(len(set(told)), 50)

    def test_all_kinds_and_models_come_within_their_ranges(self):
        jobs = [layers.drawn(seed, MODELS) for seed in range(100)]
        self.assertEqual({job.model for job in jobs}, {"a", "b"})
        drawn = [layer for job in jobs for layer in job.layers]
        self.assertEqual({layer.kind for layer in drawn}, set(layers.KINDS))
        for layer in drawn:
            self.assertTrue(1e-5 <= layer.across / 14**0.5 <= 1e-2)
            self.assertGreater(layer.along, layer.across)
            if layer.kind in ("sphere", "cylinder"):
                self.assertLessEqual(layer.along**2 / (8 * layer.radius), layer.across * (1 + 1e-12))
            self.assertTrue(1 <= layer.face <= 6)
            self.assertAlmostEqual(np.linalg.norm(layer.direction), 1)


class Fields(unittest.TestCase):
    AXIS = np.array([0.0, 0.0, 1.0])

    def layer(self, kind):
        return layers.Layer(kind, across=1e-3, along=0.2, growth=0.5, middle=np.zeros(3), direction=self.AXIS, radius=0.4, face=1)

    def test_sizes_across_grow_from_the_layer_up_to_those_along_it(self):
        at = {"plane": [0.0, 0.0, 0.02], "sphere": [0.0, 0.0, 0.42], "cylinder": [0.42, 0.0, 5.0]}
        for kind, point in at.items():
            with self.subTest(kind):
                normal = np.array([1.0, 0.0, 0.0]) if kind == "cylinder" else self.AXIS
                field = self.layer(kind).metric(np.array([point, np.array(point) - 0.02 * normal, np.array(point) + 9 * normal]))
                np.testing.assert_allclose(size(field, normal), [1e-3 + 0.5 * 0.02, 1e-3, 0.2])
                np.testing.assert_allclose(size(field, np.array([0.0, 1.0, 0.0])), 0.2)

    def test_a_job_has_the_lesser_sizes_of_its_layers(self):
        across = layers.Layer("plane", 1e-2, 0.1, 0.5, np.zeros(3), np.array([1.0, 0.0, 0.0]), 0.4, 1)
        wall = layers.Layer("wall", 1e-4, 0.1, 0.5, np.zeros(3), self.AXIS, 0.4, 3)
        job = layers.Job("a", [self.layer("plane"), across, wall], 1e4, 1)
        field = job.metric(np.zeros((1, 3)), lambda layer: np.diag([100.0, 100.0, layer.across**-2])[None])
        np.testing.assert_allclose([size(field, np.eye(3)[axis])[0] for axis in range(3)], [1e-2, 0.1, 1e-4])


if __name__ == "__main__":
    unittest.main()
