"""The judges of the ramp and of the M6's flow: exact flows are found exact, smeared ones are not; the table of measured pressures."""

import math
import sys
import types
import unittest
from pathlib import Path

import numpy as np

CASES = Path(__file__).resolve().parents[2] / "cases"
sys.path[:0] = [str(CASES), str(CASES / "ramp"), str(CASES / "onera-m6-flow")]
import pressure  # noqa: E402
import shock  # noqa: E402

EXACT = shock.oblique(2.0, math.radians(15))


def slab(cells):
    """A plane mesh of the square [0, 1.2]² a cell thick, as tetrahedra: six a cube."""
    count = cells + 1
    x, y, z = np.meshgrid(np.linspace(0, 1.2, count), np.linspace(0, 1.2, count), [0, 0.05], indexing="ij")
    points = np.stack([x, y, z], -1).reshape(-1, 3)
    tets = []
    for i in range(cells):
        for j in range(cells):
            for order in ([0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]):
                at, nodes = [i, j, 0], []
                for step in [None, *order]:
                    if step is not None:
                        at[step] += 1
                    nodes.append((at[0] * count + at[1]) * 2 + at[2])
                tets.append(nodes)
    return types.SimpleNamespace(points=points, tets=np.array(tets))


def flow(mesh, width):
    """Pressure and Mach number with a shock of that width."""
    across = mesh.points @ [-math.sin(EXACT.angle), math.cos(EXACT.angle), 0]
    behind = np.clip(0.5 - across / width, 0, 1)
    return 1 + (EXACT.pressure - 1) * behind, 2 + (EXACT.behind - 2) * behind


class Ramp(unittest.TestCase):
    def test_the_shock_of_the_tables(self):
        # NACA report 1135, chart 2 and table: Mach 2, 15°.
        self.assertAlmostEqual(math.degrees(EXACT.angle), 45.34, delta=0.01)
        self.assertAlmostEqual(EXACT.pressure, 2.195, delta=0.001)
        self.assertAlmostEqual(EXACT.behind, 1.446, delta=0.001)

    def test_a_shock_of_some_width_is_measured(self):
        mesh = slab(60)
        found = shock.figures(mesh, *flow(mesh, 0.1), EXACT)
        self.assertAlmostEqual(found["angle"], math.degrees(EXACT.angle), delta=0.02)
        self.assertLess(abs(found["pressure"]), 1e-9)
        # 10 to 90 % of a ramp, of which 90 % of the vertices.
        self.assertAlmostEqual(found["layer"], 0.1 * 0.8 * 0.9, delta=0.01)
        # A triangle of height 1/2 and half the width on each side, along the shock's length in the square.
        volume, length = 1.2**2, 1.2 / math.sin(EXACT.angle)
        expected = (2 - EXACT.behind) * 0.1 / 4 * length / volume
        self.assertAlmostEqual(found["mach_error"], expected, delta=0.1 * expected)

    def test_a_turned_shock_is_seen(self):
        mesh = slab(40)
        level, _ = flow(mesh, 0.1)
        mesh.points = mesh.points * [1, 1.05, 1]
        found = shock.figures(mesh, level, level, EXACT)
        self.assertAlmostEqual(found["angle"], math.degrees(math.atan(1.05 * math.tan(EXACT.angle))), delta=0.05)


class Pressure(unittest.TestCase):
    def test_the_table_is_whole(self):
        table = pressure.measured()
        self.assertEqual(sorted({key[0] for key in table}), [0.2, 0.44, 0.65, 0.8, 0.9, 0.96, 0.99])
        # 271 orifices, of which one is doubtful.
        self.assertEqual(sum(len(rows) for rows in table.values()), 270)
        self.assertTrue(all((np.diff(rows[:, 0]) > 0).all() for rows in table.values()))
        np.testing.assert_allclose(table[0.44, "upper"][5], [0.05911, -1.092])

    def test_steep_places(self):
        rows = np.array([[0, 1], [0.3, -1], [0.4, -1], [0.42, -0.3], [1, 0.2]])
        self.assertTrue(pressure.steep(rows, 0.38) and pressure.steep(rows, 0.2))
        self.assertFalse(pressure.steep(rows, 0.6) or pressure.steep(rows, 0.05))

    def test_the_section_of_a_plate(self):
        share = 0.5
        y = share * pressure.SPAN
        nose, chord = y * math.tan(math.radians(30)), pressure.ROOT * (1 - 0.438 * share)
        points = np.array([[nose, y - 1, 0.1], [nose, y + 1, 0.1], [nose + chord, y - 1, 0.1], [nose + chord, y + 1, 0.1]])
        mesh = types.SimpleNamespace(points=points, triangles=np.array([[0, 1, 2], [1, 3, 2]]), triangle_refs=np.array([3, 3]))
        found = pressure.section(mesh, points[:, 0], share)
        self.assertEqual(len(found["lower"]), 0)
        np.testing.assert_allclose(found["upper"][[0, -1]], [[0, nose], [1, nose + chord]], atol=1e-12)


if __name__ == "__main__":
    unittest.main()
