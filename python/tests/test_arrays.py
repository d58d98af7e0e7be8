"""Arrays go in and out without a copy, and what does not fit is told."""

import re

import numpy as np
import pytest

import geo_adapt


def test_contiguous_arrays_are_taken_as_they_are():
    base = geo_adapt.examples.cube(3)
    for kind in (np.uint32, np.int32):
        tets = np.array(base.tets, dtype=kind)
        references = np.ones(len(tets), np.int32)
        mesh = geo_adapt.Mesh(base.points, tets, tet_references=references)
        assert mesh.points is base.points
        assert np.shares_memory(mesh.tets, tets)
        assert np.shares_memory(mesh.tet_references, references)
    # 64 bits are converted: the kernel counts with 32.
    wide = base.tets.astype(np.int64)
    assert not np.shares_memory(geo_adapt.Mesh(base.points, wide).tets, wide)


def test_a_metric_of_the_medit_order_is_taken_as_it_is():
    m = np.ones((5, 6))
    assert geo_adapt.packed(m, "medit") is m


def test_results_own_the_memory_of_the_kernel():
    mesh = geo_adapt.examples.cube(3)
    m = geo_adapt.metric.isotropic(np.full(len(mesh.points), 0.2))
    result = geo_adapt.adapt(mesh, m, order="medit", threads=1)
    for array in (result.mesh.points, result.mesh.tets, result.metric, result.parents.weights):
        # A view of what the kernel handed over, not of a copy by numpy.
        assert not array.flags.owndata
        assert array.flags.c_contiguous and array.flags.writeable


def test_the_mesh_that_goes_in_stays_as_it_is():
    mesh = geo_adapt.examples.cube(3)
    before = mesh.points.copy(), mesh.tets.copy()
    geo_adapt.adapt(mesh, geo_adapt.metric.isotropic(np.full(len(mesh.points), 0.2)), order="medit")
    assert (mesh.points == before[0]).all() and (mesh.tets == before[1]).all()


def test_orders_are_said_and_not_guessed():
    full = np.array([[[1.0, 2, 4], [2, 3, 5], [4, 5, 6]]])
    assert geo_adapt.packed(full).tolist() == [[1, 2, 3, 4, 5, 6]]
    assert geo_adapt.packed([[1, 3, 6, 5, 4, 2]], "voigt").tolist() == [[1, 2, 3, 4, 5, 6]]
    assert (geo_adapt.full([[1, 3, 6, 5, 4, 2]], "voigt") == full).all()
    with pytest.raises(geo_adapt.InputError, match="order"):
        geo_adapt.packed(np.ones((4, 6)))
    with pytest.raises(geo_adapt.InputError, match="symmetric"):
        geo_adapt.packed([[[1.0, 2, 0], [0, 1, 0], [0, 0, 1]]])
    with pytest.raises(geo_adapt.InputError, match="symmetric"):
        geo_adapt.packed(np.full((1, 3, 3), np.nan))


POINTS = np.eye(4, 3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((POINTS[:, :2], [[0, 1, 2, 3]]), "(n, 3)"),
        ((POINTS, [[0, 1, 2]]), "(n, 4)"),
        ((POINTS, [[0, 1, 2, 4]]), "tetrahedron 0 refers"),
        ((POINTS, [[0, 1, 2, -1]]), "tetrahedron 0 refers"),
        ((POINTS, [[0.0, 1, 2, 3]]), "integers"),
        ((POINTS, [[0, 1, 2, 3]], [[0, 1, 2]], [1, 2]), "references"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(arguments, message):
    with pytest.raises(geo_adapt.InputError, match=re.escape(message)):
        geo_adapt.Mesh(*arguments)


def test_what_is_wrong_with_the_input_is_told():
    mesh = geo_adapt.examples.cube(2)
    good = geo_adapt.metric.isotropic(np.full(27, 0.5))
    bad = good.copy()
    bad[3] = -1
    with pytest.raises(geo_adapt.MetricError, match="vertex 3 is not positive definite"):
        geo_adapt.adapt(mesh, bad, order="medit")
    with pytest.raises(geo_adapt.InputError, match="26 metrics are given for 27"):
        geo_adapt.adapt(mesh, good[:26], order="medit")
    with pytest.raises(geo_adapt.MetricError, match="complexity"):
        geo_adapt.adapt(mesh, good, order="medit", complexity=-1)
    with pytest.raises(geo_adapt.InputError, match="no surface is called"):
        geo_adapt.adapt(mesh, good, order="medit", freeze=["inlet"])
    flat = geo_adapt.Mesh(mesh.points * [1, 1, 0], mesh.tets)
    with pytest.raises(geo_adapt.MeshError):
        geo_adapt.adapt(flat, good, order="medit")
    with pytest.raises(geo_adapt.MetricError, match="not positive definite"):
        geo_adapt.metric.grade(mesh, bad, order="medit")
    with pytest.raises(geo_adapt.InputError, match="27 points"):
        geo_adapt.transfer(mesh, np.ones(5), mesh)
    # The points may have been changed since the mesh was made.
    mesh.tets[0, 0] = 99
    with pytest.raises(geo_adapt.InputError, match="refers to 99"):
        geo_adapt.adapt(mesh, good, order="medit")
    assert issubclass(geo_adapt.InputError, geo_adapt.Error)


def test_frozen_surfaces_stay():
    mesh = geo_adapt.examples.cube(4)
    m = geo_adapt.metric.isotropic(np.full(len(mesh.points), 0.1))
    new = geo_adapt.adapt(mesh, m, order="medit", freeze=["x=0"]).mesh
    assert new.names == mesh.names
    old = {tuple(p) for p in mesh.points[mesh.on("x=0")].tolist()}
    assert {tuple(p) for p in new.points[new.on("x=0")].tolist()} == old
    assert len(new.on("x=1")) > len(mesh.on("x=1"))


def test_fields_go_through_files(tmp_path):
    mesh = geo_adapt.examples.cube(2)
    mesh.fields = {"p": mesh.points[:, 0], "u": mesh.points}
    for ending in ("vtu", "meshb"):
        mesh.write(tmp_path / f"a.{ending}")
        again = geo_adapt.Mesh.read(tmp_path / f"a.{ending}")
        assert (again.points == mesh.points).all() and (again.tets == mesh.tets).all()
    again = geo_adapt.Mesh.read(tmp_path / "a.vtu")
    assert (again.fields["p"] == mesh.fields["p"]).all() and (again.fields["u"] == mesh.fields["u"]).all()
    with pytest.raises(geo_adapt.FileError, match=r"nothing\.meshb"):
        geo_adapt.Mesh.read(tmp_path / "nothing.meshb")
