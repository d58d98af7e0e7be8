"""Many threads, from the measured times of the tasks on one: GEO_ADAPT_SIMULATE (src/tasks/simulation.rs)."""

import json
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from judging import cycles  # noqa: E402

# Sections that are told for each number of threads: those that lose most.
TOLD = 4


def told(text):
    """What a run says of its simulation: the last such line of its log."""
    lines = [line for line in text.splitlines() if line.startswith("simulated {")]
    if not lines:
        raise ValueError("the program tells no simulation")
    return json.loads(lines[-1].removeprefix("simulated "))


def lost(simulation):
    """Sections by what they take beyond their share of the work, the most first: (seconds, name)."""
    threads = simulation["threads"]
    beyond = [(part["simulated"] - (part["serial"] + part["work"]) / threads, name) for name, part in simulation["sections"].items()]
    return sorted(beyond, reverse=True)


def row(simulation, one):
    """A line of the table; `one` are the seconds of one thread."""
    threads, seconds = simulation["threads"], simulation["simulated"]
    limits = ", ".join(f"{name} {seconds:.3f}" for seconds, name in lost(simulation)[:TOLD])
    return (f"{threads:>7} {seconds:>9.3f} s {one / seconds:>8.2f} {simulation['serial']:>9.3f} s {simulation['work']:>9.3f} s "
            f"{simulation['span']:>8.3f} s   {limits}")


def run(command, out, name, threads):
    """The wall seconds of a run that simulates so many threads, or of one on threads that are there, and its log."""
    log = out / f"{name}.log"
    log.unlink(missing_ok=True)
    os.environ.pop("GEO_ADAPT_SIMULATE", None)
    if threads is not None:
        os.environ["GEO_ADAPT_SIMULATE"] = str(threads)
    try:
        ran = cycles.measured(command, log)
    finally:
        os.environ.pop("GEO_ADAPT_SIMULATE", None)
    if ran.code != 0:
        raise RuntimeError(f"{name}: geo-adapt ended with {ran.code} ({log}):\n{cycles.tail(log)}")
    return ran.wall_seconds, log.read_text(errors="replace")


def simulate(words, out, threads, repetitions):
    """Prints the table; returns 0 if the forecast for two threads is within 3 % of two threads, else 1. `words` are a run without --threads."""
    command = [*words, "--scheduler", "deterministic", "--quiet", "--threads"]
    walls = {1: [], 2: []}
    two = []
    # In turn, so that a slow minute of the machine meets all.
    for _ in range(repetitions):
        for count in walls:
            walls[count].append(run([*command, count], out, f"measured-{count}", None)[0])
        two.append(told(run([*command, 1], out, "simulated-2", 2)[1]))
    one = min(walls[1])
    cycles.say("threads   simulated  speed-up      serial        work      span   seconds that sections take beyond their share")
    forecast = min(two, key=lambda simulation: simulation["simulated"])
    for count in [1, *threads]:
        cycles.say(row(told(run([*command, 1], out, f"simulated-{count}", count)[1]), one))
    measured, simulated = min(walls[1]) / min(walls[2]), one / forecast["simulated"]
    off = simulated / measured - 1
    cycles.say(f"2 threads: measured {min(walls[2]):.3f} s ({measured:.3f} times one of {one:.3f} s), simulated {forecast['simulated']:.3f} s "
               f"({simulated:.3f} times), {100 * off:+.1f} %")
    return 0 if abs(off) <= 0.03 else 1
