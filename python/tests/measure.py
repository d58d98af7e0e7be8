"""Measures what the package promises, on a machine that does nothing else. Usage: measure.py [overhead|on_cad|memory|copies|interrupt]…

python/check runs memory and interrupt, which fail where the promise is not kept; the others are for a look.
"""

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

import geo_adapt


def resident() -> float:
    """Memory of this process, MB."""
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS")) / 1024


def large(points: float):
    """A cube, and a metric that asks for so many points, nearly: thin layers along x."""
    mesh = geo_adapt.examples.cube(16)
    h = np.column_stack([0.02 + 0.2 * mesh.points[:, 0], np.full((len(mesh.points), 2), 0.1)])
    m = np.zeros((len(h), 6))
    m[:, [0, 2, 5]] = h**-2.0
    return mesh, geo_adapt.metric.scale(mesh, m, points / 2, order="medit")


def overhead(points: float = 100_000, pairs: int = 5) -> None:
    """Processor time of an adaptation here and by the program, without reading and writing, on one thread: in pairs, so that others on the machine
    slow both. What the binding itself takes is the processor time of the calling thread: the library works in another."""
    mesh, m = large(points)
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        mesh.write(place / "a.meshb")
        geo_adapt.write_sol(place / "m.solb", m)
        ours, theirs, binding = [], [], []
        for _ in range(pairs):
            before, own = time.process_time(), time.thread_time()
            geo_adapt.adapt(mesh, m, threads=1, order="medit")
            binding.append(time.thread_time() - own)
            ours.append(time.process_time() - before)
            began = resource.getrusage(resource.RUSAGE_CHILDREN)
            words = ["adapt", "a.meshb", "--metric", "m.solb", "-o", "b.meshb", "--threads", "1", "-q"]
            subprocess.run([geo_adapt.program.PATH, *words], cwd=place, check=True)
            ended = resource.getrusage(resource.RUSAGE_CHILDREN)
            theirs.append(ended.ru_utime + ended.ru_stime - began.ru_utime - began.ru_stime)
    ratios = np.array(ours) / np.array(theirs) - 1
    print(f"overhead: least {min(ours):.2f} s here, {min(theirs):.2f} s by the program with its files: {min(ours) / min(theirs) - 1:+.1%}")
    print(f"  middle of the pairs {np.median(ratios):+.1%}; the calling thread: {np.median(np.array(binding) / ours):.3%}")


def on_cad(pairs: int = 5) -> None:
    """The case `large` of cases/comparing, cube-cylinder with polar-2 at complexity 100 000, on one thread: wall-clock time of `adapt` here, and
    what the program's report calls adapting: without reading the files and putting the mesh on the model, which `adapt` here does too. What
    the binding itself takes is the processor time of the calling thread: the library works in another."""
    root = Path(__file__).resolve().parents[2]
    cad = root / "geometry/cube-cylinder.step"
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        at = root / "cases/cube-cylinder/start.meshb"
        for number in range(4):
            geo_adapt.program.run(["adapt", at, "--cad", cad, "--analytic", "polar-2", "-o", place / f"natural-{number}.meshb", "-q"])
            at = place / f"natural-{number}.meshb"
        mesh, model = geo_adapt.Mesh.read(at), geo_adapt.Model(cad)
        m = geo_adapt.read_sol(at.with_suffix(".solb"))[0]

        binding: list[float] = []

        def here() -> float:
            began, own = time.perf_counter(), time.thread_time()
            result = geo_adapt.adapt(mesh, m, model, complexity=100_000, threads=1, order="medit", report=False)
            took = time.perf_counter() - began
            binding.append((time.thread_time() - own) / took)
            result.mesh.write(place / "ours.meshb")
            return took

        def there() -> float:
            words = ["adapt", at, "--cad", cad, "--metric", at.with_suffix(".solb"), "--complexity", "100000"]
            geo_adapt.program.run([*words, "-o", place / "theirs.meshb", "--threads", "1", "-q", "--report", place / "report.json"])
            return float(json.loads((place / "report.json").read_text())["seconds"]["adapt"])

        ours, theirs = [], []
        for number in range(pairs):
            for way, times in ((here, ours), (there, theirs))[:: 1 if number % 2 else -1]:
                times.append(way())
            print(f"  {ours[-1]:.3f} s here, {theirs[-1]:.3f} s by the program: {ours[-1] / theirs[-1] - 1:+.2%}", flush=True)
        same = (place / "ours.meshb").read_bytes() == (place / "theirs.meshb").read_bytes()
    ratios = np.array(ours) / np.array(theirs) - 1
    print(f"on_cad: least {min(ours):.3f} s here, {min(theirs):.3f} s by the program: {min(ours) / min(theirs) - 1:+.2%}; middle of the pairs")
    print(f"  {np.median(ratios):+.2%}; the same bytes: {same}; the calling thread: {np.median(binding):.3%}")


def memory() -> None:
    """A thousand adaptations in a process, of a loop with one adapter and of adapters of their own."""
    model = geo_adapt.Model(geo_adapt.examples.cylinder())
    first = geo_adapt.bootstrap(model, size=0.6, threads=1)
    m = geo_adapt.metric.geometry(first, model)
    adapter = geo_adapt.Adapter(model, threads=2)
    at = {}
    for number in range(1, 1001):
        if number % 2:
            geo_adapt.adapt(first, m, model, complexity=300 + number % 7, order="medit", threads=2)
        else:
            adapter.adapt(first, m, complexity=300 + number % 7, order="medit")
        if number in (100, 200, 400, 600, 800, 1000):
            at[number] = resident()
    print("memory after adaptations, MB:", {number: round(value, 1) for number, value in at.items()})
    grown = at[1000] - at[200]
    assert grown < 8, f"memory grew by {grown:.1f} MB in 800 adaptations: at most 10 kB each are allowed"


def copies() -> None:
    """Memory that arrays take again when they become a mesh and a metric."""
    count = 4_000_000
    points, m = np.ones((count, 3)), np.ones((count, 6))
    tets = np.ones((count, 4), np.uint32)
    references = np.ones(count, np.int32)
    size = (points.nbytes + tets.nbytes + m.nbytes + 2 * references.nbytes) / 2**20
    before = resident()
    mesh = geo_adapt.Mesh(points, tets, tet_references=references, point_references=references)
    geo_adapt.packed(m, "medit")
    print(f"copies: arrays of {size:.0f} MB go in, {resident() - before:.0f} MB more")
    print("  points, tets, metric have the caller's memory:", mesh.points is points, np.shares_memory(mesh.tets, tets))


def interrupt() -> None:
    """Ctrl-C during an adaptation to a million tetrahedra, at several moments: how long until control is back."""
    # What a shell starts in the background ignores SIGINT, and Python with it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    mesh, m = large(220_000)
    for delay in (1.0, 3.0, 6.0, 9.0, 12.0):
        at = [0.0, 0.0]

        def kick(at=at):
            at[:] = time.monotonic(), time.process_time()
            os.kill(os.getpid(), signal.SIGINT)

        timer = threading.Timer(delay, kick)
        timer.start()
        try:
            result = geo_adapt.adapt(mesh, m, order="medit")
            print(f"interrupt after {delay} s: done before, {len(result.mesh.tets)} tetrahedra")
            timer.cancel()
            break
        except KeyboardInterrupt as error:
            back, used = time.monotonic() - at[0], time.process_time() - at[1]
            found = error.partial.mesh
            valid = geo_adapt.inspect(found)["valid"]
            print(f"interrupt after {delay} s: back in {back:.2f} s, {used:.2f} s of processors, {len(found.tets)} tetrahedra, valid: {valid}")
            assert valid and back < 1, "control is not back within a second, or the mesh is not valid"


if __name__ == "__main__":
    for what in sys.argv[1:] or ["overhead", "on_cad", "memory", "copies", "interrupt"]:
        globals()[what]()
