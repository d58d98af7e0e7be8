"""The independent side of cases/m6-metric: curvatures of B-splines from a STEP file, the other code's recovery and gradation."""

import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "cases"))
from judging import metric  # noqa: E402
from metrics import recipe, spread, splines  # noqa: E402

# z = x² − xy/2 + 3y²/2 on [-1, 1]², one Bézier patch whose parameters are (x + 1)/2 and (y + 1)/2; then a plane and a sphere.
POLES = [[2.0, -0.5, 3.0], [0.5, -2.5, 0.5], [3.0, -0.5, 2.0]]
HEAD = """#1 = CLOSED_SHELL('',(#4,#2,#3));
#2 = ADVANCED_FACE('',(#90),#5,.T.);
#3 = ADVANCED_FACE('',(#90),#6,.T.);
#4 = ADVANCED_FACE('',(#90),#7,.F.);
#5 = PLANE('',#8);
#6 = SPHERICAL_SURFACE('',#8,4.);
#8 = AXIS2_PLACEMENT_3D('',#9,#9,#9);
#9 = CARTESIAN_POINT('',(1.,2.,3.E0));
"""


def step_file(folder):
    path, rows = Path(folder) / "patch.stp", []
    lines = HEAD
    for i, row in enumerate(POLES):
        for j, z in enumerate(row):
            lines += f"#{10 + 3 * i + j} = CARTESIAN_POINT('',({i - 1.},{j - 1.},{z}));\n"
        rows.append("(" + ",".join(f"#{10 + 3 * i + j}" for j in range(3)) + ")")
    lines += f"#7 = B_SPLINE_SURFACE_WITH_KNOTS('',2,2,(\n{','.join(rows)}),.UNSPECIFIED.,.F.,.F.,.F.,(3,3),(3,3),(0.,1.),(0.,1.),.UNSPECIFIED.);\n"
    path.write_text(lines, encoding="ascii")
    return path


class Splines(unittest.TestCase):
    def setUp(self):
        with tempfile.TemporaryDirectory() as folder:
            self.faces = splines.faces(step_file(folder))

    def test_faces_come_in_the_order_of_the_shell(self):
        self.assertEqual([type(face).__name__ for face in self.faces], ["Spline", "Plane", "Sphere"])

    def test_a_graph_has_the_curvatures_of_its_formula(self):
        for x, y in ((0.0, 0.0), (0.4, -0.7), (1.0, 1.0)):
            point = self.faces[0].derivative((x + 1) / 2, (y + 1) / 2, 0, 0)
            np.testing.assert_allclose(point, [x, y, x * x - x * y / 2 + 1.5 * y * y], atol=1e-12)
            curvatures, directions = self.faces[0].curvatures((x + 1) / 2, (y + 1) / 2, point)
            p, q = 2 * x - y / 2, 3 * y - x / 2
            w = 1 + p * p + q * q
            self.assertAlmostEqual(curvatures.prod(), (2 * 3 - 0.25) / w**2, places=10)
            mean = ((1 + q * q) * 2 + p * q + (1 + p * p) * 3) / (2 * w**1.5)
            self.assertAlmostEqual(abs(curvatures.sum()), 2 * mean, places=10)
            np.testing.assert_allclose(directions @ directions.T, np.eye(3), atol=1e-12)
            np.testing.assert_allclose(np.abs(directions[2]), np.abs([p, q, -1]) / w**0.5, atol=1e-12)
            # Along a principal direction the surface bends as told: a second difference of the height above the tangent plane.
            for curvature, along in zip(curvatures, directions):
                step = 1e-4 * along
                rise = [(x + s * step[0]) ** 2 - (x + s * step[0]) * (y + s * step[1]) / 2 + 1.5 * (y + s * step[1]) ** 2 - point[2] - s * step[2]
                        for s in (-1, 1)]
                self.assertAlmostEqual(abs(sum(rise)) / 1e-8 / w**0.5, abs(curvature), places=4)

    def test_a_sphere_bends_by_its_radius(self):
        curvatures, directions = self.faces[2].curvatures(0, 0, np.array([1.0, 2.0, 7.0]))
        np.testing.assert_allclose(curvatures, 0.25)
        np.testing.assert_allclose(directions[2], [0, 0, 1])

    def test_a_collapsed_side_has_no_normal(self):
        self.faces[0].poles[0] = [-1, 0, 0]
        with self.assertRaises(splines.StepError):
            self.faces[0].curvatures(0, 0.5, None)


def cube(n):
    """Points, tets and boundary vertices' triangles of the unit cube in n³ cubes of six tetrahedra."""
    index = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    points = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
    tets = []
    for corner in np.ndindex(n, n, n):
        for axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            for order in (axes, axes[::-1]):
                at, path = list(corner), [index[corner]]
                for axis in order:
                    at[axis] += 1
                    path.append(index[tuple(at)])
                # Odd orders of the axes come out negative.
                tets.append(path if order is axes else [path[0], path[2], path[1], path[3]])
    boundary = np.flatnonzero(((points == 0) | (points == 1)).any(1))
    return SimpleNamespace(points=points, tets=np.array(tets), triangles=boundary[:, None])


class Recipe(unittest.TestCase):
    def setUp(self):
        self.mesh = cube(6)
        self.domain = recipe.Domain(self.mesh)
        self.points = self.mesh.points

    def test_the_mesh_fills_the_cube(self):
        self.assertAlmostEqual(metric.volumes(self.points, self.mesh.tets).sum(), 1)
        self.assertGreater(metric.volumes(self.points, self.mesh.tets).min(), 0)
        self.assertEqual(len(self.domain.edges), len(metric.unique_edges(self.mesh.tets)))

    def test_quadratics_are_met_two_layers_inside(self):
        exact = np.array([[2, -1, 0.5], [-1, 3, 4], [0.5, 4, -6]])
        found = self.domain.hessians(7 + self.points[:, 0] + 0.5 * np.einsum("ni,ij,nj->n", self.points, exact, self.points))
        deep = ((self.points > 0.3) & (self.points < 0.7)).all(1)
        np.testing.assert_allclose(found[deep], np.broadcast_to(exact, found[deep].shape), atol=1e-10)

    def test_the_boundary_takes_the_mean_of_what_is_inside(self):
        values = np.einsum("n,ij->nij", self.points[:, 0], np.eye(3))
        found = self.domain.from_inside(values)
        inside = ~self.domain.on_boundary
        np.testing.assert_array_equal(found[inside], values[inside])
        on_side = np.flatnonzero((self.points == [0, 0.5, 0.5]).all(1))
        np.testing.assert_allclose(found[on_side][0], np.eye(3) / 6)
        self.assertGreaterEqual(found[:, 0, 0].min(), 1 / 6 - 1e-12)
        self.assertLessEqual(found[:, 0, 0].max(), 5 / 6 + 1e-12)

    def test_an_intersection_asks_for_both_and_no_more(self):
        first, second = np.diag([1.0, 4, 9])[None], np.diag([16.0, 1, 4])[None]
        np.testing.assert_allclose(recipe.intersection(first, second), np.diag([16.0, 4, 9])[None])
        turned, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
        both = recipe.intersection(turned @ first @ turned.T, second)
        for one in (turned @ first @ turned.T, second):
            self.assertAlmostEqual(np.linalg.eigvalsh(both - one)[0, 0], 0, places=9)

    def test_a_sweep_grows_sizes_by_the_law(self):
        metrics = np.repeat(np.eye(3)[None], len(self.points), 0)
        centre = np.flatnonzero((self.points == 0.5).all(1))[0]
        metrics[centre] *= 100
        found = self.domain.swept(metrics, lambda first, second, vectors: 1 + np.linalg.norm(vectors, axis=1) * 6)
        beside = np.flatnonzero(np.isclose(np.abs(self.points - 0.5).sum(1), 1 / 6))
        np.testing.assert_allclose(found[beside], 25 * np.repeat(np.eye(3)[None], len(beside), 0))
        np.testing.assert_allclose(found[centre], metrics[centre])
        self.assertTrue((found[0] == np.eye(3)).all())

    def test_the_aspect_ratio_is_cut_at_the_greater_sizes(self):
        np.testing.assert_allclose(recipe.limited(np.diag([1e4, 1.0, 400])[None], 10), np.diag([1e4, 100, 400])[None])

    def test_a_metric_scaled_has_the_complexity(self):
        found = recipe.solution_metric(self.domain, np.repeat(np.diag([1.0, 2, 3])[None], len(self.points), 0))
        self.assertAlmostEqual(metric.complexity(self.points, self.mesh.tets, found), recipe.COMPLEXITY, places=4)
        np.testing.assert_allclose(np.linalg.eigvalsh(found)[:, 0] / np.linalg.eigvalsh(found)[:, 2], 1 / 3)

    def test_the_distance_is_that_of_the_logarithms(self):
        first = np.diag([1.0, 4, 9])[None]
        self.assertAlmostEqual(spread.distance(first, np.e**2 * first)[0], 2 * 3**0.5)
        np.testing.assert_allclose(spread.size_ratios(first, 4 * first), -np.ones((1, 3)))


if __name__ == "__main__":
    unittest.main()
