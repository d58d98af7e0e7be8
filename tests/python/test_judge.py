"""The judge is right on meshes whose figures are known by hand, and finds every kind of damage."""

import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cases"))
from judging import cube_cylinder, meshfile, metric, validity  # noqa: E402

START = ROOT / "cases" / "cube-cylinder" / "start.meshb"
# A tetrahedron with all edges √2.
REGULAR = np.array([[0, 0, 0], [1, 1, 0], [0, 1, 1], [1, 0, 1]], float)
TET = np.array([[0, 1, 2, 3]])


class Formulas(unittest.TestCase):
    def test_mean_ratio_is_one_for_the_unit_tet_of_its_metric(self):
        if metric.volumes(REGULAR, TET)[0] < 0:
            self.fail("REGULAR must be positive")
        stretch = np.diag([1.0, 3.0, 20.0])
        squeezed = REGULAR @ np.linalg.inv(stretch)
        sizes = np.broadcast_to(stretch @ stretch, (4, 3, 3))
        self.assertAlmostEqual(metric.mean_ratios(squeezed, TET, sizes)[0], 1.0, places=12)
        flipped = TET[:, [1, 0, 2, 3]]
        self.assertAlmostEqual(metric.mean_ratios(squeezed, flipped, sizes)[0], -1.0, places=12)

    def test_mean_ratio_of_the_corner_of_a_cube(self):
        points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
        expected = 36 / 3 ** (1 / 3) * (1 / 6) ** (2 / 3) / 9
        self.assertAlmostEqual(metric.mean_ratios(points, TET, np.broadcast_to(np.eye(3), (4, 3, 3)))[0], expected, places=12)

    def test_length_integrates_a_size_that_varies_linearly(self):
        points = np.array([[0, 0, 0], [1, 0, 0]], float)
        sizes = np.array([0.1, 0.4])
        lengths = metric.edge_lengths(points, np.array([[0, 1]]), np.einsum("n,ij->nij", sizes**-2, np.eye(3)))
        # ∫ ds/h with 1/h varying geometrically: (10 − 2.5)/ln 4
        self.assertAlmostEqual(lengths[0], 7.5 / np.log(4), places=12)

    def test_complexity_is_the_integral_of_the_density(self):
        mesh = meshfile.read_mesh(START)
        values = np.broadcast_to(np.diag([100.0, 25.0, 4.0]), (len(mesh.points), 3, 3))
        volume = metric.volumes(mesh.points, mesh.tets).sum()
        self.assertAlmostEqual(metric.complexity(mesh.points, mesh.tets, values), 100 * volume, places=8)
        scaled = metric.scale_to(values, 100 * volume, 5000)
        self.assertAlmostEqual(metric.complexity(mesh.points, mesh.tets, scaled), 5000, places=7)

    def test_fields_have_their_sizes_along_their_directions(self):
        at = np.array([[0.6 * np.cos(0.3), 0.6 * np.sin(0.3), 0.75]])
        radial, around = np.array([np.cos(0.3), np.sin(0.3), 0]), np.array([-np.sin(0.3), np.cos(0.3), 0])
        wanted = {"polar-1": (0.001 + 0.198 * 0.1, 0.1), "polar-2": (0.001 + 0.198 * 0.1, 0.1)}
        for name, (along_r, along_theta) in wanted.items():
            (m,) = metric.analytic(name, at)
            self.assertAlmostEqual(radial @ m @ radial, along_r**-2, places=6)
            self.assertAlmostEqual(around @ m @ around, along_theta**-2, places=6)
        (inner,) = metric.analytic("polar-2", np.array([[0.5, 0, 0.2]]))
        self.assertAlmostEqual(inner[1, 1], (1 / 40) ** -2, places=6)
        (layer,) = metric.analytic("linear", np.array([[0.9, 0.9, 0.5]]))
        self.assertAlmostEqual(layer[2, 2], 1e6, places=3)


class Validity(unittest.TestCase):
    def setUp(self):
        self.mesh = meshfile.read_mesh(START)

    def found(self):
        return " / ".join(validity.findings(self.mesh))

    def test_start_mesh_is_valid(self):
        self.assertEqual(self.found(), "")

    def test_inverted_tet(self):
        self.mesh.tets[7] = self.mesh.tets[7][[1, 0, 2, 3]]
        self.assertIn("1 tetrahedra are inverted", self.found())
        self.assertIn("same side", self.found())

    def test_flat_tet_is_told_from_a_thin_one_exactly(self):
        mesh = meshfile.read_mesh(START)
        for height, valid in [(0.0, False), (1e-300, True), (-1e-300, False)]:
            mesh.points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, height]])
            mesh.tets = TET
            self.assertEqual(bool(validity._positive(mesh)[0]), valid)

    def test_missing_tet_leaves_faces_bare(self):
        self.mesh.tets, self.mesh.tet_refs = self.mesh.tets[1:], self.mesh.tet_refs[1:]
        self.assertIn("have no triangle", self.found())

    def test_missing_triangle(self):
        self.mesh.triangles, self.mesh.triangle_refs = self.mesh.triangles[1:], self.mesh.triangle_refs[1:]
        self.assertIn("1 faces on the boundary or between regions have no triangle", self.found())

    def test_doubled_triangle(self):
        self.mesh.triangles = np.vstack([self.mesh.triangles, self.mesh.triangles[:1, [1, 2, 0]]])
        self.assertIn("1 triangles are there twice", self.found())

    def test_triangle_inside_a_region_that_is_no_face(self):
        self.mesh.triangles[0] = self.mesh.triangles[0][0], self.mesh.triangles[100][0], self.mesh.triangles[200][0]
        self.assertIn("no face of a tetrahedron", self.found())

    def test_hanging_vertex(self):
        self.mesh.points = np.vstack([self.mesh.points, [0.9, 0.9, 0.9]])
        self.assertIn("1 vertices belong to no tetrahedron", self.found())

    def test_region_border_without_triangles(self):
        self.mesh.tet_refs[0] = 9
        self.assertIn("between regions have no triangle", self.found())

    def test_two_tets_that_touch_along_an_edge_only(self):
        self.mesh.points = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, -1, 0]], float)
        self.mesh.tets = np.array([[0, 2, 3, 1], [0, 4, 5, 1]])
        self.mesh.tet_refs = np.zeros(2, np.int64)
        self.mesh.triangles = np.vstack([self.mesh.tets[:, face] for face in validity.OUTWARD])
        self.mesh.edges = self.mesh.edges[:0]
        self.assertEqual(self.found(), "1 edges of the boundary do not lie between exactly two triangles")


class CubeCylinder(unittest.TestCase):
    def setUp(self):
        self.start, self.mesh = meshfile.read_mesh(START), meshfile.read_mesh(START)

    def found(self):
        return " / ".join(cube_cylinder.judge(self.mesh, self.start)[1])

    def test_start_mesh_sits_on_the_model(self):
        self.assertEqual(self.found(), "")

    def test_vertex_off_its_face(self):
        wall = [ref for ref, (name, _) in cube_cylinder.fit(self.mesh)["triangles"].items() if name == "wall"]
        vertex = self.mesh.triangles[self.mesh.triangle_refs == wall[0]][0, 0]
        self.mesh.points[vertex, :2] *= 1 + 1e-8
        self.assertIn("off its own entity", self.found())

    def test_references_exchanged(self):
        swap = {1: 2, 2: 1}
        self.mesh.triangle_refs = np.array([swap.get(ref, ref) for ref in self.mesh.triangle_refs])
        self.assertIn("triangles: references lost or moved to another entity: [1, 2]", self.found())

    def test_edge_lost(self):
        keep = self.mesh.edge_refs != 5
        self.mesh.edges, self.mesh.edge_refs = self.mesh.edges[keep], self.mesh.edge_refs[keep]
        self.assertIn("14 references on 14 entities", self.found())
        self.assertIn("[5]", self.found())

    def test_corner_lost(self):
        self.mesh.corners = self.mesh.corners[1:]
        self.assertIn("Corners marks 9 vertices", self.found())

    def test_region_lost(self):
        self.mesh.tet_refs[:] = 4
        self.assertIn("regions [1] became [4]", self.found())


class Files(unittest.TestCase):
    def test_what_is_written_is_read(self):
        mesh = meshfile.read_mesh(START)
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / "copy.meshb"
            meshfile.write_mesh(copy, mesh)
            self.assertEqual(copy.read_bytes(), START.read_bytes())
            values = metric.analytic("polar-2", mesh.points)
            meshfile.write_metric(Path(folder) / "m.solb", values)
            np.testing.assert_array_equal(meshfile.read_metric(Path(folder) / "m.solb"), values)

    def test_text_with_comments_and_unknown_keywords(self):
        text = """MeshVersionFormatted 2 # a comment
            Dimension 3
            Vertices 4
            0 0 0 5  1 0 0 6
            0 1 0 7  0 0 1 8
            Tangents 1 1.0 2.0 3.0
            Tetrahedra 1  1 2 3 4 42
            VerticesOnGeometricEdges 1  2 9 0.25 1e-3
            End"""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.mesh"
            path.write_text(text)
            mesh = meshfile.read_mesh(path)
        self.assertEqual(mesh.point_refs.tolist(), [5, 6, 7, 8])
        self.assertEqual((mesh.tets.tolist(), mesh.tet_refs.tolist()), ([[0, 1, 2, 3]], [42]))
        self.assertEqual((mesh.on_edges.tolist(), mesh.parameters_on_edges.tolist()), ([[1, 9]], [[0.25, 0.001]]))
        self.assertEqual(mesh.skipped, ["tangents"])

    def test_cut_file_and_index_out_of_range_are_refused(self):
        whole = START.read_bytes()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.meshb"
            path.write_bytes(whole[: len(whole) // 2])
            self.assertRaises(meshfile.FileError, meshfile.read_mesh, path)
            mesh = meshfile.read_mesh(START)
            mesh.tets[3, 2] = len(mesh.points)
            meshfile.write_mesh(path, mesh)
            with self.assertRaisesRegex(meshfile.FileError, "Tetrahedra: a vertex index out of 1..309"):
                meshfile.read_mesh(path)


if __name__ == "__main__":
    unittest.main()
