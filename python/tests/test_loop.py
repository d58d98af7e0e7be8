"""The loop goes on where it was, and gives then what it would have given."""

import numpy as np
import pytest

import geo_adapt


class Stopped(Exception):
    pass


def solver(fails_at=None):
    calls = []

    def solve(mesh, before):
        calls.append(None if before is None else before["u"].shape)
        if len(calls) == fails_at:
            raise Stopped
        u = np.tanh(15 * (mesh.points[:, 0] - 0.4))
        return {"u": u, "v": mesh.points}, {"mean": float(u.mean())}

    return solve, calls


def test_a_loop_that_was_stopped_goes_on(tmp_path):
    mesh, asked = geo_adapt.examples.cube(4), [150, 300, 500]
    whole, calls = solver()
    steps = geo_adapt.cycle(whole, mesh, asked, tmp_path / "whole", sensor="u")
    assert len(steps) == len(calls) == 4 and calls[0] is None
    assert [call for call in calls[1:]] == [(len(step.mesh.points),) for step in list(steps)[1:]]
    broken, _ = solver(fails_at=3)
    with pytest.raises(Stopped):
        geo_adapt.cycle(broken, mesh, asked, tmp_path / "parts", sensor="u")
    assert len(geo_adapt.Cycle(tmp_path / "parts")) == 2
    rest, calls = solver()
    again = geo_adapt.cycle(rest, mesh, asked, tmp_path / "parts", sensor="u")
    assert len(calls) == 2 and again.functionals == steps.functionals
    for number in range(1, 5):
        name = f"step-{number:03d}.meshb"
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    with pytest.raises(geo_adapt.InputError, match="other complexities"):
        geo_adapt.cycle(rest, mesh, [160], tmp_path / "parts", sensor="u")


def test_what_the_solver_gives_is_checked(tmp_path):
    mesh = geo_adapt.examples.cube(2)
    with pytest.raises(geo_adapt.InputError, match="field 'u'"):
        geo_adapt.cycle(lambda mesh, before: {"u": np.ones(3)}, mesh, [100], tmp_path / "a")
    with pytest.raises(geo_adapt.InputError, match="sensor"):
        geo_adapt.cycle(lambda mesh, before: {"u": mesh.points}, mesh, [100], tmp_path / "b")
