"""Progress, stops and Ctrl-C: control comes back, with a valid mesh."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import geo_adapt


def large():
    """About a quarter of a million tetrahedra are wanted of six thousand."""
    mesh = geo_adapt.examples.cube(10)
    return mesh, geo_adapt.metric.isotropic(np.full(len(mesh.points), 0.03))


def test_progress_is_told_and_stops():
    mesh, m = large()
    told = []

    def progress(p):
        told.append((time.monotonic(), p))
        return len(told) < 8

    result = geo_adapt.adapt(mesh, m, order="medit", progress=progress)
    assert not result.complete and result.report == {}
    assert geo_adapt.inspect(result.mesh)["valid"]
    times = np.diff([at for at, _ in told])
    assert len(told) == 8 and np.median(times) < 0.1
    assert {p.operation for _, p in told} <= {
        "insertion", "collapse", "reconnection", "smoothing", "projection", "repair"
    }
    assert all(0 <= p.done <= p.items for _, p in told)


def test_ctrl_c_raises_with_the_mesh_so_far():
    mesh, m = large()
    threading.Timer(0.4, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt) as caught:
        geo_adapt.adapt(mesh, m, order="medit")
    partial = caught.value.partial
    assert not partial.complete and len(partial.mesh.points) > len(mesh.points)
    assert geo_adapt.inspect(partial.mesh)["valid"]


def test_an_exception_of_progress_comes_out():
    mesh, m = large()

    def progress(p):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough") as caught:
        geo_adapt.adapt(mesh, m, order="medit", progress=progress)
    assert geo_adapt.inspect(caught.value.partial.mesh)["valid"]


def test_other_threads_of_python_go_on():
    mesh, m = large()
    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1
            time.sleep(0.001)

    other = threading.Thread(target=count)
    other.start()
    began = time.monotonic()
    geo_adapt.adapt(mesh, m, order="medit", threads=1, progress=lambda p: time.monotonic() - began < 1.0)
    over.set()
    other.join()
    assert counted[0] > 100


def test_an_adapter_at_work_says_so():
    mesh, m = large()
    adapter = geo_adapt.Adapter(threads=1)
    errors = []

    def progress(p):
        if not errors:
            with pytest.raises(geo_adapt.InputError, match="at work"):
                adapter.adapt(mesh, m, order="medit")
            errors.append(True)
        return False

    adapter.adapt(mesh, m, order="medit", progress=progress)
    assert errors
    # And can be used again.
    assert adapter.adapt(mesh, m, order="medit", complexity=200).complete
