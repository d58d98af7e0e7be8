"""The zoo's judge: what of a model must be in a mesh, and the fields it asks for."""

import sys
import tempfile
import types
import unittest
from pathlib import Path

import numpy as np

CASES = Path(__file__).resolve().parents[2] / "cases"
sys.path[:0] = [str(CASES), str(CASES / "zoo")]
import layer  # noqa: E402
from judging import represent  # noqa: E402


def edge(*vertices, degenerate=False, seam=False):
    return {"vertices": list(vertices), "degenerate": degenerate, "seam": seam}


# A cone on a cylinder's rim: the seam, the rim (closed), the apex; and a line between two corners.
MODEL = {"solids": 1, "faces": [{}, {}], "vertices": [{}, {}, {}, {}], "diagonal": 10.0, "tolerance": 1e-5,
         "edges": [edge(1, 2, seam=True), edge(1, 1), edge(2, 2, degenerate=True), edge(3, 4)]}


def mesh(faces=(1, 2), edges=(2, 4), corners=(3, 4), regions=(1,)):
    return types.SimpleNamespace(triangle_refs=np.array(faces), edge_refs=np.array(edges), tet_refs=np.array(regions),
                                 on_vertices=np.array([[7, number] for number in corners]))


class Represented(unittest.TestCase):
    def test_seams_poles_and_the_ends_of_closed_edges_need_not_be_there(self):
        self.assertEqual(represent.wanted(MODEL), {"face": {1, 2}, "edge": {2, 4}, "vertex": {3, 4}})
        self.assertEqual(represent.missing(mesh(), MODEL), [])

    def test_what_is_lost_is_named(self):
        for lost, word in [(mesh(faces=(1,)), "face numbers not there: 2"), (mesh(edges=(4,)), "edge numbers not there: 2"),
                           (mesh(corners=(4,)), "vertex numbers not there: 3"), (mesh(regions=(1, 2)), "2 regions")]:
            found = represent.missing(lost, MODEL)
            self.assertEqual(len(found), 1)
            self.assertIn(word, found[0])

    def test_the_tolerance_is_the_models_where_that_is_more(self):
        for distance, wrong in [(9e-6, 0), (1.1e-5, 1)]:
            inspected = {"cad": {"from_entity": {"distance": distance}}}
            self.assertEqual(len(represent.off_model(inspected, MODEL)[1]), wrong)

    def test_names_are_read_from_beside_the_mesh(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.meshb"
            self.assertEqual(represent.names(path), set())
            path.with_suffix(".names.json").write_text('{"triangles": {"3": {"name": "inlet"}}, "tetrahedra": {}}')
            self.assertEqual(represent.names(path), {("triangles", "inlet")})


class Fields(unittest.TestCase):
    def sizes(self, values, direction):
        return np.einsum("i,nij,j->n", direction, values, direction) ** -0.5

    def test_the_layer_is_a_thousandth_across_in_the_middle(self):
        middle = np.array([1.0, 2.0, 3.0])
        points = middle + np.outer([0, 2.0, 40.0], layer.NORMAL)
        values = layer.metric(points, middle, 10.0)
        np.testing.assert_allclose(self.sizes(values, layer.NORMAL), [0.01, 0.41, 1.0])
        np.testing.assert_allclose(self.sizes(values, np.array([0.8, -0.6, 0.0])), 1.0)


if __name__ == "__main__":
    unittest.main()
