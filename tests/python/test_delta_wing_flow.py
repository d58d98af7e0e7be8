"""The planes that the delta wing's case draws: they are covered once, with the values of the linear interpolant."""

import sys
import types
import unittest
from pathlib import Path

import numpy as np

CASES = Path(__file__).resolve().parents[2] / "cases"
sys.path[:0] = [str(CASES), str(CASES / "delta-wing-flow")]
import pictures  # noqa: E402


def cube():
    """The unit cube as six tetrahedra, sheared along x so that planes cut them in triangles and quadrilaterals."""
    points = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], float)
    points[:, 0] += 0.3 * points[:, 1]
    orders = ([4, 2, 1], [2, 1, 4], [1, 4, 2], [2, 4, 1], [4, 1, 2], [1, 2, 4])
    return types.SimpleNamespace(points=points, tets=np.array([np.cumsum([0, *order]) for order in orders]))


class Section(unittest.TestCase):
    def test_planes_are_covered_once_with_linear_values(self):
        mesh = cube()
        values = mesh.points @ [2.0, -1.0, 3.0] + 0.5
        # The cube reaches from x = 0.3 y to 1 + 0.3 y: before 0.3 and behind 1 the plane meets only a part of it.
        for x, covered in [(0.15, 0.5), (0.5, 1), (0.6, 1), (1.15, 0.5)]:
            corners, found = pictures.section(mesh, values, x)
            np.testing.assert_allclose(found, 2 * x + corners @ [-1.0, 3.0] + 0.5, atol=1e-12)
            sides = corners[:, 1:] - corners[:, :1]
            area = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]).sum() / 2
            self.assertAlmostEqual(area, covered, places=9)


if __name__ == "__main__":
    unittest.main()
