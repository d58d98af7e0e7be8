"""The comparison measures what it says: inputs, processes, keys of rows, floors and targets."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cases"))
from comparing import cases, command, expected, published, runs, table  # noqa: E402
from comparing.uniform import uniform_cube  # noqa: E402
from judging import cube, cycles, meshfile, metric, validity  # noqa: E402


class Inputs(unittest.TestCase):
    def test_uniform_cube_is_valid_and_carries_the_numbers_of_the_model(self):
        mesh = uniform_cube(5)
        self.assertEqual(validity.findings(mesh), [])
        figures, found = cube.judge(mesh)
        self.assertEqual(found, [])
        self.assertEqual((len(mesh.points), len(mesh.tets), len(mesh.triangles), len(mesh.edges)), (125, 384, 192, 48))
        # geometry/cube.step: edge 1 is where x = 0 and y = 0, edge 12 where y = 1 and z = 1
        self.assertTrue((mesh.points[mesh.edges[mesh.edge_refs == 1]][..., :2] == 0).all())
        self.assertTrue((mesh.points[mesh.edges[mesh.edge_refs == 12]][..., 1:] == 1).all())
        self.assertEqual({tuple(point) for point in mesh.points[mesh.corners]}, {(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)})

    def test_triangles_look_outward(self):
        mesh = uniform_cube(3)
        a, b, c = (mesh.points[mesh.triangles[:, i]] for i in range(3))
        outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), (a + b + c) / 3 - 0.5)
        self.assertGreater(outward.min(), 0)

    def test_uniform_cube_survives_the_file(self):
        with tempfile.TemporaryDirectory() as place:
            path = Path(place) / "cube.meshb"
            meshfile.write_mesh(path, uniform_cube(3))
            again = meshfile.read_mesh(path)
        self.assertTrue((again.tets == uniform_cube(3).tets).all())
        self.assertTrue((again.triangle_refs == uniform_cube(3).triangle_refs).all())

    def test_cube_judge_sees_a_vertex_off_its_side(self):
        mesh = uniform_cube(3)
        vertex = mesh.triangles[mesh.triangle_refs == 2][0, 0]
        mesh.points[vertex, 0] += 1e-8
        self.assertIn("off the side", " / ".join(cube.judge(mesh)[1]))

    def test_front_has_its_sizes_along_and_across_the_radius(self):
        radial = np.array([1.0, 2.0, 2.0]) / 3
        across = np.array([2.0, -1.0, 0.0]) / np.sqrt(5)
        for r, size in [(0.5, 0.01), (0.6, 0.028), (1e-9, 0.1)]:
            (m,) = metric.analytic("front", r * radial[None])
            self.assertAlmostEqual((radial @ m @ radial) ** -0.5, size, places=8)
            self.assertAlmostEqual((across @ m @ across) ** -0.5, 0.1, places=10)
        (m,) = metric.analytic("front", np.zeros((1, 3)))
        self.assertTrue(np.allclose(m, 100 * np.eye(3)))


class Keys(unittest.TestCase):
    def test_equal_rows_have_equal_keys_whatever_the_number_of_vertices(self):
        rows = np.random.default_rng(7).integers(0, 4, (500, 4))
        wanted = len(np.unique(rows, axis=0))
        for limit in (4, 10_000_000, np.iinfo(np.int64).max // 1000):
            scaled = rows * ((limit - 1) // 3)
            keys = metric.row_keys(scaled, limit)
            self.assertEqual(len(np.unique(keys)), wanted)
            self.assertTrue(all(len(np.unique(rows[keys == key], axis=0)) == 1 for key in np.unique(keys)))


class Processes(unittest.TestCase):
    def measured(self, script):
        with tempfile.TemporaryDirectory() as place:
            return cycles.measured([sys.executable, "-c", script], Path(place) / "log")

    def test_memory_is_the_child_s_own(self):
        held = np.ones(300 << 17)  # 300 MiB that are ours, and no matter of the child's
        small = self.measured("pass")
        big = self.measured("x = bytearray(200 << 20)")
        self.assertEqual(held[0], 1)
        self.assertLess(small.peak_bytes, 100 << 20)
        self.assertGreater(big.peak_bytes, 200 << 20)
        self.assertLess(big.peak_bytes, 300 << 20)

    def test_time_and_exit_code(self):
        ran = self.measured("import time, sys\nwhile time.process_time() < 0.3: pass\nsys.exit(3)")
        self.assertEqual(ran.code, 3)
        self.assertGreater(ran.cpu_seconds, 0.25)
        self.assertLess(ran.cpu_seconds, 3)

    def test_a_program_that_is_not_there_is_said(self):
        with tempfile.TemporaryDirectory() as place, self.assertRaisesRegex(OSError, "could not be started"):
            cycles.measured([Path(place) / "nothing"], Path(place) / "log")


class Expectations(unittest.TestCase):
    def test_a_floor_is_no_target(self):
        bound = expected.Bound("unit_edges", "≥", 0.99, 0.98)
        self.assertTrue(bound.held(0.985))
        self.assertIn("not reached", bound.line(0.985))
        self.assertNotIn("LOST", bound.line(0.985))
        self.assertIn("LOST", bound.line(0.97))
        self.assertRegex(bound.line(0.995), " reached$")
        self.assertFalse(expected.Bound("time_ratio", "≤", 0.2, 0.5).held(0.6))

    def test_every_case_has_its_expectations_and_no_floor_asks_more_than_its_target(self):
        self.assertEqual(set(expected.EXPECTED), set(cases.CASES))
        for bound in sum(expected.EXPECTED.values(), []):
            self.assertTrue(bound.floor is None or not bound.met(bound.floor, bound.target) or bound.floor == bound.target, bound)

    def test_a_lost_floor_and_a_bad_mesh_are_both_lost_and_a_missed_target_is_not(self):
        good = {"unit_edges": 1.0, "ratio_least": 0.9, "ratio_mean": 0.95}
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            self.assertEqual(command.hold({"cube-linear": good}, {}, held=True), [])
            lost = command.hold({"cube-linear": good | {"unit_edges": 0.5}}, {"cube-linear": ["1 tetrahedra are inverted"]}, held=True)
            shorter = command.hold({"cube-linear": good | {"unit_edges": 0.5}}, {}, held=False)
        self.assertEqual(len(lost), 2)
        self.assertIn("unit_edges 0.5", lost[0])
        self.assertIn("inverted", lost[1])
        self.assertEqual(shorter, [])
        self.assertIn("LOST", printed.getvalue())

    def test_published_figures_belong_to_cases_and_are_marked(self):
        self.assertLessEqual({row.case for row in published.PUBLISHED}, set(cases.CASES))
        notes = []
        lines = table.published_rows("polar-1", notes)
        self.assertTrue(all(line.strip().startswith("*") for line in lines))
        self.assertIn("not run here", table.notes_text(notes))

    def test_ratios_growth_and_drift(self):
        ours = {"cpu_seconds": 2.0, "peak_bytes": 50, "vertices_per_second": 600.0, "vertices": 1000,
                "unit_edges_of_cycles": [0.5, 0.98, 0.97]}
        other = ours | {"cpu_seconds": 8.0, "peak_bytes": 100, "vertices_per_second": 150.0}
        self.assertEqual(runs.ratios({"geo-adapt": ours, "mmg3d": other}), {"time_ratio": 0.25, "memory_ratio": 0.5, "rate_ratio": 4.0})
        self.assertEqual(runs.ratios({"geo-adapt": ours, "mmg3d": {"failed": "…"}}), {})
        self.assertAlmostEqual(runs.growth(ours, ours | {"cpu_seconds": 32.0, "vertices": 16000}), 1.0)
        self.assertAlmostEqual(runs.worst_drift({"evaluated": ours})["evaluated"], 1.0)


if __name__ == "__main__":
    unittest.main()
