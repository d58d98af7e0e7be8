"""Forecasts what so many processes of so many threads take to adapt a mesh part by part, from the report of one such run on one thread:

    geo-adapt adapt in.meshb ... --memory 64GiB --threads 1 --report one.json -o out.meshb
    cases/ranks one.json --ranks 1 2 4 8 16

The parts are dealt as the program deals them, the heaviest first by the work that was expected; what a part took comes from the report. With
--vertices a mesh of so many is forecast, in parts of --part-vertices: a vertex of a part takes as long as it did, there are more parts, and
around cuts the tetrahedra within a distance that the report tells are adapted again. What is not in it: the input (it is read by
every process, or by slices), the disk of a scratch folder, and what cores of one machine take from each other.
"""

import argparse
import heapq
import json
import math
import sys
from dataclasses import dataclass
from pathlib import Path

# Parts of a round from which on each has one thread (src/decomposition/rounds.rs).
OF_ONE_THREAD = 16
# Bytes of a sample, of a vertex and a tetrahedron on their way, of a vertex of the boundary, and of a shared one, in an outline.
SAMPLE, VERTEX, TET, LISTED, SHARED = 104, 180, 24, 330, 8
# Tetrahedra of a vertex, and bytes of it in the two files.
TETS = 5.8
WRITTEN = 28 + TETS * 20 + 48
# Samples of a round, and the least of a part.
SAMPLES, LEAST_SAMPLES = 1 << 18, 1 << 10


@dataclass
class Machine:
    """Processes, their threads, and what is between them."""
    ranks: int
    threads: int = 1
    latency: float = 2e-6
    bandwidth: float = 1e10
    disk: float = 2e9
    # What threads of one part cannot share (Amdahl): 16 threads are 7.7 times one.
    serial: float = 0.072

    def speed(self, threads):
        """How much faster so many threads are with one part."""
        return 1 / (self.serial + (1 - self.serial) / max(threads, 1))

    def message(self, to_each, whole):
        """A call in which every process sends each other one so many bytes, and receives so many."""
        others = self.ranks - 1
        return others * (self.latency + to_each / self.bandwidth) + whole / self.bandwidth * (others > 0)


@dataclass
class Round:
    """A round: (expected work, seconds, vertices) of each part, and what all of it costs beside them."""
    parts: list
    tets: float
    cutting: float
    dealing: float


@dataclass
class Run:
    """A run on one process, s."""
    vertices: float
    rounds: list
    outlines: float
    numbers: float
    boundary: float
    boundary_measured: float
    writing: float
    listed: float
    shared: float


def of_report(report):
    """The run of a report: one process, one thread."""
    told = report["parts"]
    if len(told["processes"]) != 1 or report["threads"] != 1:
        raise ValueError("the report is not of one process with one thread")
    seconds, numbering = report["seconds"], told["numbering"]
    rounds = [Round([(part["work"], part["seconds"], part["vertices"]) for part in round["of_parts"]], round["tets"], round["cutting"],
                    round["dealing"]) for round in told["rounds"]]
    vertices, triangles = report["statistics"]["vertices"], report["statistics"]["triangles"]
    main = next((round["of_parts"] for round in told["rounds"] if any(part["active"] < part["vertices"] for part in round["of_parts"])), [])
    twice = sum(part["vertices"] for part in main) - vertices
    ending = seconds["total"] - seconds["read_and_classify"] - seconds["adapt"] - told["boundary_measured"]
    return Run(vertices, rounds, numbering["outlines"], numbering["numbers"], numbering["boundary"], told["boundary_measured"], ending,
               triangles / 2, max(twice, 0))


def owners(work, ranks):
    """The process of each part: the heaviest first, each to the process with the least work so far."""
    load, of = [(0.0, rank) for rank in range(ranks)], [0] * len(work)
    for part in sorted(range(len(work)), key=lambda part: (-work[part], part)):
        so_far, rank = heapq.heappop(load)
        of[part] = rank
        heapq.heappush(load, (so_far + work[part], rank))
    return of


def on_threads(seconds, threads):
    """How long so many threads take, each part on the one that is free first."""
    free = [0.0] * max(threads, 1)
    for part in seconds:
        heapq.heapreplace(free, free[0] + part)
    return max(free)


def round_seconds(round, machine):
    """Seconds of a round: [cutting and dealing, parts, messages]."""
    of = owners([work for work, _, _ in round.parts], machine.ranks)
    mine = [[] for _ in range(machine.ranks)]
    for (work, seconds, _), rank in zip(round.parts, of):
        mine[rank].append((work, seconds))
    slowest = 0.0
    for parts in mine:
        heaviest_first = [seconds for _, seconds in sorted(parts, key=lambda part: -part[0])]
        if len(round.parts) < OF_ONE_THREAD and parts:
            at_once = min(len(parts), machine.threads)
            faster = machine.speed(machine.threads // at_once)
            slowest = max(slowest, on_threads([seconds / faster for seconds in heaviest_first], at_once))
        else:
            slowest = max(slowest, on_threads(heaviest_first, machine.threads))
    # Each process has its share of the pieces, but no more than one thread works on one of them.
    workers = min(machine.ranks * machine.threads, len(round.parts))
    samples = min(max(SAMPLES, LEAST_SAMPLES * len(round.parts)), round.tets) * SAMPLE
    share = round.tets * (TET + VERTEX / TETS) / machine.ranks
    moved = machine.message(share / machine.ranks, share) + machine.message(samples / machine.ranks, samples)
    # The first cut is tried along three axes at once, the next two at six, and so on.
    depth = max(math.log2(len(round.parts)), 1.0)
    cutting = round.cutting * max(1 / machine.threads, min(2 / 3 / depth, 1.0))
    return [cutting + round.dealing / workers, slowest, moved]


def forecast(run, machine):
    """Seconds by what they go to."""
    sums = [sum(column) for column in zip(*(round_seconds(round, machine) for round in run.rounds))]
    workers = min(machine.ranks * machine.threads, sum(len(round.parts) for round in run.rounds))
    outlines = run.listed * LISTED + run.shared * SHARED
    told = {
        "cuts": sums[0],
        "parts": sums[1],
        "numbers": run.outlines / workers + run.numbers + run.boundary / machine.speed(machine.threads),
        "boundary": run.boundary_measured / machine.speed(machine.threads),
        "writing": max(run.writing / workers, run.vertices * WRITTEN / machine.disk),
        "messages": sums[2] + machine.message(outlines / machine.ranks, outlines),
    }
    return {**told, "all": sum(told.values())}


def blocks(parts):
    """A box of so many parts, as nearly a cube as may be: [a, b, c]."""
    a = max(round(parts ** (1 / 3)), 1)
    b = max(round(math.sqrt(parts / a)), 1)
    return [a, b, max(parts / a / b, 1.0)]


def finished(parts, vertices, width, dimension=3):
    """The share of parts of so many vertices that is farther from the cuts than the width, in vertices; cuts across so many axes."""
    side = (vertices / (2 * width) ** (3 - dimension)) ** (1 / dimension) if dimension else math.inf
    counts = blocks(parts) if dimension == 3 else [parts ** (1 / dimension)] * dimension if dimension else []
    return math.prod(max(1 - 2 * width * (1 - 1 / count) / side, 0.0) for count in counts)


def width(report):
    """The width of a zone on one side of a cut, in vertices: what makes the share that the report tells of its first zone."""
    for told in report["parts"]["rounds"]:
        parts = told["of_parts"]
        active, vertices = sum(part["active"] for part in parts), sum(part["vertices"] for part in parts)
        if len(parts) > 1 and active < vertices:
            low, high = 0.0, 50.0
            for _ in range(50):
                middle = (low + high) / 2
                low, high = (middle, high) if 1 - finished(len(parts), vertices / len(parts), middle) < active / vertices else (low, middle)
            return low
    raise ValueError("the report has no zone")


def spread(count, vertices, like):
    """So many parts of so many vertices in all, as uneven as those of a round."""
    of = [like.parts[at % len(like.parts)] for at in range(count)]
    scale = vertices / max(sum(part[2] for part in of), 1)
    return [tuple(scale * number for number in part) for part in of]


def rounds(vertices, part, least, given=8e3, growth=8.0):
    """The rounds of a mesh that grows: (vertices, parts)."""
    def parts(size):
        return max(math.ceil(max(size / part, min(size / least, 16))), 1)
    sizes = [vertices]
    while sizes[0] > growth * given and parts(sizes[0]) > 1:
        sizes.insert(0, sizes[0] / growth)
    return [(size, parts(size)) for size in sizes]


def zones(vertices, parts, near, least):
    """The zones: (vertices, parts), of which the first is around the faces of parts, the next around their edges, and so on."""
    left, found = vertices, []
    for dimension in (3, 2, 1, 0):
        if parts == 1:
            break
        left *= 1 - finished(parts, left / parts, near, dimension)
        parts = max(math.ceil(left / least), 1)
        found.append((left, parts))
    return found


def grown(report, vertices, part, least):
    """The run of a mesh of so many vertices, in parts of `part`, and of `least` in zones."""
    run = of_report(report)
    main = max(run.rounds, key=lambda round: sum(work for work, _, _ in round.parts))
    zone = run.rounds[min(run.rounds.index(main) + 1, len(run.rounds) - 1)]

    def made(size, count, like):
        samples, known = (min(max(SAMPLES, LEAST_SAMPLES * len(of)), tets) for of, tets in
                          ((range(count), TETS * size), (like.parts, like.tets)))
        depth = math.log2(max(count, 2)) / math.log2(max(len(like.parts), 2))
        tets = TETS * size
        return Round(spread(count, size, like), tets, like.cutting * samples / known * depth, like.dealing * tets / like.tets)

    stages = rounds(vertices, part, least)
    made_rounds = [made(size, count, main) for size, count in stages]
    made_rounds += [made(size, count, zone) for size, count in zones(*stages[-1], width(report), least)]
    size, boundary = vertices / run.vertices, (vertices / run.vertices) ** (2 / 3)
    shared = run.shared * sum(len(round.parts) for round in made_rounds) / sum(len(round.parts) for round in run.rounds)
    # Every process numbers the boundary and what pieces share.
    numbers = run.numbers * (run.listed * boundary + shared) / (run.listed + run.shared)
    return Run(vertices, made_rounds, run.outlines * size, numbers, run.boundary * boundary, run.boundary_measured * boundary, run.writing * size,
               run.listed * boundary, shared)


def row(ranks, threads, told, one):
    """A line of the table; `one` are the seconds of one process."""
    return f"{ranks:>6} {threads:>7} {told['all']:>10.2f} {one / told['all']:>8.2f} " + " ".join(f"{told[name]:>9.2f}" for name in NAMES)


NAMES = ["parts", "cuts", "numbers", "boundary", "writing", "messages"]


def main():
    parser = argparse.ArgumentParser(prog="cases/ranks", allow_abbrev=False, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("report", type=Path, help="of a run part by part, on one thread")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4, 8, 16], help="processes (default: 1 2 4 8 16)")
    parser.add_argument("--threads", type=int, default=1, help="threads of each (default: 1)")
    parser.add_argument("--vertices", type=float, nargs="+", help="forecast meshes of so many vertices")
    parser.add_argument("--part-vertices", type=float, default=300_000, help="of a part, with --vertices (default: 300 000)")
    parser.add_argument("--zone-vertices", type=float, default=100_000, help="of a part around former cuts, with --vertices (default: 100 000)")
    parser.add_argument("--latency", type=float, default=2e-6, help="of a message, s (default: 2e-6)")
    parser.add_argument("--bandwidth", type=float, default=1e10, help="of a process, bytes/s (default: 1e10)")
    parser.add_argument("--disk", type=float, default=2e9, help="of the file system, bytes/s (default: 2e9)")
    options = parser.parse_args()
    report = json.loads(options.report.read_text())
    runs = [grown(report, vertices, options.part_vertices, options.zone_vertices) for vertices in options.vertices or []] or [of_report(report)]
    for run in runs:
        machines = [Machine(ranks, options.threads, options.latency, options.bandwidth, options.disk) for ranks in options.ranks]
        one = forecast(run, Machine(1, 1, options.latency, options.bandwidth, options.disk))["all"]
        print(f"{run.vertices:.3g} vertices, rounds of {', '.join(str(len(round.parts)) for round in run.rounds)} parts, one thread {one:.1f} s")
        print(" ranks threads    seconds speed-up " + " ".join(f"{name:>9}" for name in NAMES))
        for machine in machines:
            print(row(machine.ranks, machine.threads, forecast(run, machine), one))
    return 0


if __name__ == "__main__":
    sys.exit(main())
