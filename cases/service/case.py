"""The service under load: 20 clients run 200 jobs on two cores, against the program itself in a row; states, results and memory meanwhile.

A browser goes through the workbench: drops a model, makes a mesh of it, adapts that and downloads it. Then it starts `geo-adapt serve` on two cores. Twenty clients run 200 jobs, small adaptations of a few meshes and of a CAD model, inspections and
conversions, and download what they make; another one asks for the state of a job 20 times a second. Then the program runs the same jobs, two at
a time, and every result must be the same. --short: 40 jobs.
--minutes M: the jobs again and again for so long instead, and what memory the service has meanwhile. Exit code: 0 when every floor is held, else 1. All lies under out/service.
"""

import argparse
import hashlib
import json
import multiprocessing
import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import browser  # noqa: E402
import service  # noqa: E402
import work  # noqa: E402
from comparing.expected import Bound  # noqa: E402
from judging import cycles, loops  # noqa: E402

OUT = cycles.ROOT / "out" / "service"
CLIENTS, JOBS, SHORT = 20, 200, 40
# States that are asked for in a second.
RATE = 20
# Under load for long: errors, and memory in MB that it has in the last quarter beyond that of the second.
LASTING = [Bound("errors", "≤", 0, 0), Bound("memory, more", "≤", 5, 5)]
# Seconds that a whole run of the jobs may take.
LIMIT = 1800
# (target, floor of today); times in ms, memory in MB.
BOUNDS = [
    Bound("throughput / program", "≥", 0.9, 0.9), Bound("errors", "≤", 0, 0), Bound("other results", "≤", 0, 0),
    Bound("status p99", "≤", 50, 50), Bound("memory, more", "≤", 50, 50),
]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=cycles.ROOT / "target/release/geo-adapt")
    parser.add_argument("--short", action="store_true", help=f"{SHORT} jobs")
    parser.add_argument("--minutes", type=float, help="load for so long, and its memory meanwhile")
    options = parser.parse_args()
    if not options.program.is_file():
        sys.exit(f"{options.program} is not there: cargo build --release, or cases/run service, which does it")
    options.program = options.program.resolve()
    return options


def digest(contents):
    return hashlib.sha256(contents).hexdigest()


def processor():
    """Seconds of the processor that children have taken which have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


@contextmanager
def asked(port, clients, found):
    """Another client asks for the state of the latest job meanwhile; `found` gets how long each answer took."""
    words = [sys.executable, Path(service.__file__).with_name("asking.py"), port, RATE, RATE * LIMIT]
    asking = subprocess.Popen(list(map(str, words)), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    is_over = threading.Event()

    def tell():
        told = None
        while not is_over.wait(0.02):
            if clients.last != told:
                told = clients.last
                asking.stdin.write(f"{told}\n")
                asking.stdin.flush()

    telling = threading.Thread(target=tell, daemon=True)
    telling.start()
    try:
        yield
    finally:
        is_over.set()
        telling.join()
        text, _ = asking.communicate(timeout=service.LIMIT)
        found |= json.loads(text)


def served(program, files, jobs, cores):
    """The jobs by a service: seconds, of the processor too, digests, errors, the answers to who asks for states, and memory before and after."""
    shutil.rmtree(OUT / "data", ignore_errors=True)
    states = {}
    with service.started(program, OUT / "data", cores, OUT / "serve.log") as at_work:
        ids = service.uploaded(at_work.port, files)
        # All that jobs use is loaded before memory is first looked at: models, and the code.
        first = service.Clients(at_work.port, ids, jobs[:10], digest, time.monotonic() + LIMIT)
        first.run(2)
        memory, before = [at_work.memory()], at_work.processor()
        clients = service.Clients(at_work.port, ids, jobs, digest, time.monotonic() + LIMIT)
        with asked(at_work.port, clients, states):
            seconds = clients.run(CLIENTS)
        memory.append(at_work.memory())
        cpu = at_work.processor() - before
    return {"seconds": seconds, "cpu": cpu, "digests": clients.results, "errors": first.errors + clients.errors,
            "states": states["seconds"], "states_errors": states["errors"], "memory": memory}


def looked_at(program, cores, cad):
    """A browser goes through the workbench, where the program reads models: how long that took; what it downloads is a valid mesh on its model."""
    if not cad:
        return {}
    model, downloads, began = cycles.ROOT / "geometry" / "cube-cylinder.step", OUT / "downloads", time.monotonic()
    for folder in (downloads, OUT / "data"):
        shutil.rmtree(folder, ignore_errors=True)
    downloads.mkdir()
    with service.started(program, OUT / "data", cores, OUT / "serve.log") as at_work:
        mesh = browser.through(f"http://127.0.0.1:{at_work.port}", model, 0.08, downloads)
    seconds = time.monotonic() - began
    subprocess.run([program, "inspect", mesh, "-q", "--cad", model], check=True, timeout=LIMIT)
    cycles.say(f"the browser: from {model.name} to {mesh.name} in {seconds:.1f} s")
    return {"browser, s": seconds}


def lasting(program, files, jobs, cores, minutes):
    """The jobs again and again: the service's memory after each turn, and errors."""
    shutil.rmtree(OUT / "data", ignore_errors=True)
    until, memory, errors, done = time.monotonic() + 60 * minutes, [], [], 0
    with service.started(program, OUT / "data", cores, OUT / "serve.log") as at_work:
        ids = service.uploaded(at_work.port, files)
        while time.monotonic() < until:
            clients = service.Clients(at_work.port, ids, jobs, digest, time.monotonic() + LIMIT)
            clients.run(CLIENTS)
            errors += clients.errors
            done += len(jobs)
            memory.append(at_work.memory()[0])
    for error in errors[:10]:
        cycles.say(f"error: {error}")
    cycles.say(f"{done} jobs; memory in MB, turn by turn: {' '.join(f'{one:.1f}' for one in memory)}")
    return {"errors": len(errors), "memory, more": grown(memory)}


def grown(memory):
    """How much more of it there is at most in the last quarter than in the second; the first is for what is loaded once."""
    quarter = max(len(memory) // 4, 1)
    return max(memory[-quarter:]) - max(memory[quarter:2 * quarter] or memory)


def alone(*given):
    """What `in_a_row` does, in a session of its own as the service is, since the system shares the processor out by sessions."""
    fork = multiprocessing.get_context("fork")
    here, there = fork.Pipe(duplex=False)

    def run():
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        os.setsid()
        there.send(in_a_row(*given))

    process = fork.Process(target=run)
    process.start()
    there.close()
    try:
        return here.recv()
    finally:
        process.terminate()
        process.join()


def in_a_row(program, files, jobs, cores):
    """The same jobs by the program, as many at a time as there are cores: seconds, of the processor too, and digests."""
    place, digests, errors = OUT / "program", [None] * len(jobs), []
    shutil.rmtree(place, ignore_errors=True)
    numbers, lock = iter(range(len(jobs))), threading.Lock()
    before, began = processor(), time.monotonic()

    def worker():
        while time.monotonic() - began < LIMIT:
            with lock:
                number = next(numbers, None)
            if number is None:
                return
            job, folder = jobs[number], place / str(number)
            folder.mkdir(parents=True)
            for name in job.reads:
                os.link(files[name], folder / name)
            ran = subprocess.run([program, *job.typed(), "-q"], cwd=folder, capture_output=True, timeout=LIMIT, check=False,
                                 preexec_fn=lambda: os.sched_setaffinity(0, cores))
            if ran.returncode == 0:
                digests[number] = [digest((folder / name).read_bytes()) for name in job.writes]
            else:
                errors.append(f"{' '.join(job.typed())}: {ran.returncode} {ran.stderr.decode(errors='replace')[-200:]}")
            shutil.rmtree(folder)

    threads = [threading.Thread(target=worker) for _ in cores]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return {"seconds": time.monotonic() - began, "cpu": processor() - before, "digests": digests, "errors": errors}


def quantile(values, part):
    """The value that this part of all does not exceed."""
    ordered = sorted(values)
    return ordered[min(int(part * len(ordered)), len(ordered) - 1)]


def figures(there, here):
    """What is judged, of what the service and the program did."""
    other = sum(a != b or a is None for a, b in zip(there["digests"], here["digests"], strict=True))
    milliseconds = [1000 * seconds for seconds in there["states"]]
    return {
        "jobs": len(here["digests"]), "service, s": there["seconds"], "program, s": here["seconds"],
        "throughput / program": here["seconds"] / there["seconds"], "processor / program": there["cpu"] / here["cpu"],
        "errors": len(there["errors"]) + len(there["states_errors"]) + len(here["errors"]), "other results": other,
        # Nobody asked: that is not good enough.
        "states": len(milliseconds), "status p50": quantile(milliseconds, 0.5) if milliseconds else float("inf"),
        "status p99": quantile(milliseconds, 0.99) if milliseconds else float("inf"),
        "memory, before": there["memory"][0][0], "memory, after": there["memory"][1][0],
        "memory, more": there["memory"][1][0] - there["memory"][0][0],
        "memory of all, before": there["memory"][0][1], "memory of all, after": there["memory"][1][1],
    }


def main():
    options = arguments()
    # Who ends this ends what it has started.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    OUT.mkdir(parents=True, exist_ok=True)
    cores = sorted(os.sched_getaffinity(0))[:2]
    cad = work.has_cad(options.program)
    files = work.prepare(options.program, OUT / "files", cad)
    jobs = work.jobs(SHORT if options.short else JOBS, cad)
    cycles.say(f"{len(jobs)} jobs{'' if cad else ' without OpenCASCADE'}, {CLIENTS} clients, cores {cores}, load {os.getloadavg()[0]:.1f}")
    if os.getloadavg()[0] > 1:
        cycles.say("others are at work on this machine: it shares its cores out by sessions, and times against times say little")
    if options.minutes:
        return loops.judged(LASTING, lasting(options.program, files, jobs, cores, options.minutes))
    seconds = looked_at(options.program, cores, cad)
    there = served(options.program, files, jobs, cores)
    cycles.say(f"the service: {there['seconds']:.1f} s, {there['cpu']:.1f} s of the processor, load {os.getloadavg()[0]:.1f}")
    here = alone(options.program, files, jobs, cores)
    cycles.say(f"the program: {here['seconds']:.1f} s, {here['cpu']:.1f} s of the processor, load {os.getloadavg()[0]:.1f}")
    result = figures(there, here) | seconds
    cycles.say("  ".join(f"{name} {value:.4g}" for name, value in result.items()))
    (OUT / "result.json").write_text(json.dumps(result, indent=1))
    errors = [*there["errors"], *there["states_errors"], *here["errors"]]
    for error in errors[:10]:
        cycles.say(f"error: {error}")
    return loops.judged(BOUNDS, result)


if __name__ == "__main__":
    sys.exit(main())
