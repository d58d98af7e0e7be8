"""A mesh grows as far as it may, and the result says why it ended; the forecast is that of the program."""

import json

import numpy as np
import pytest

import geo_adapt


def asked(size):
    mesh = geo_adapt.examples.cube(6)
    return mesh, geo_adapt.metric.isotropic(np.full(len(mesh.points), size))


def test_a_mesh_has_at_most_the_points_that_it_may_have():
    mesh, m = asked(0.03)
    result = geo_adapt.adapt(mesh, m, order="medit", threads=1, max_vertices=3000)
    assert 2900 <= len(result.mesh.points) <= 3000
    assert result.growth_end == result.report["growth_end"] == "max-vertices" and result.overgrown
    assert result.complete and geo_adapt.inspect(result.mesh)["valid"]
    # The forecast tells what the metric asks for.
    assert result.report["forecast"]["vertices"] > 20_000


def test_a_mesh_that_needs_fewer_is_not_touched_by_it():
    mesh, m = asked(0.2)
    free = geo_adapt.adapt(mesh, m, order="medit", threads=1)
    bounded = geo_adapt.adapt(mesh, m, order="medit", threads=1, max_vertices=3000)
    assert free.growth_end is bounded.growth_end is None and not bounded.overgrown
    assert np.array_equal(free.mesh.points, bounded.mesh.points) and np.array_equal(free.mesh.tets, bounded.mesh.tets)
    # A bound is of one call: the adapter does not keep it.
    adapter = geo_adapt.Adapter(threads=1)
    mesh, m = asked(0.1)
    assert adapter.adapt(mesh, m, order="medit", max_vertices=400).growth_end == "max-vertices"
    assert adapter.adapt(mesh, m, order="medit").growth_end is None


def test_bounds_that_no_mesh_can_have_are_refused():
    mesh, m = asked(0.2)
    for bound in (0, -3, 2**32):
        with pytest.raises(geo_adapt.InputError, match="max_vertices"):
            geo_adapt.adapt(mesh, m, order="medit", max_vertices=bound)


@pytest.mark.parametrize("bound", [None, 1500])
def test_what_the_program_tells(tmp_path, typed, bound):
    mesh, m = asked(0.06)
    mesh.write(tmp_path / "mesh.meshb")
    geo_adapt.write_sol(tmp_path / "m.solb", m)
    result = geo_adapt.adapt(geo_adapt.Mesh.read(tmp_path / "mesh.meshb"), m, order="medit", threads=1, max_vertices=bound)
    words = ["adapt", "mesh.meshb", "--metric", "m.solb", "-o", "out.meshb", "--threads", 1, "--report", "report.json"]
    if bound is None:
        typed(*words)
    else:
        # A mesh that does not meet its metric is written, and the exit code is 3.
        with pytest.raises(Exception, match="exit status 3"):
            typed(*words, f"--max-vertices={bound}")
    told = json.loads((tmp_path / "report.json").read_text())
    for name in ("overgrown", "growth_end"):
        assert result.report[name] == told[name], name
    for name in ("vertices", "bytes"):
        assert result.report["forecast"][name] == told["forecast"][name], name
    result.mesh.write(tmp_path / "ours.meshb")
    assert (tmp_path / "ours.meshb").read_bytes() == (tmp_path / "out.meshb").read_bytes()
