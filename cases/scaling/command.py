"""Runs the large case (cube-cylinder, polar-2, from our own mesh of its natural complexity) on more and more threads.

Prints for each scheduler and number of threads: seconds by operation, speed-up and efficiency against one thread of the same scheduler,
conflicts, the quality with its histogram, and the checksum of the mesh. Exit code: 0 when the deterministic meshes are all the same file
and the quality does not depend on the threads (unit edges within 0.3 points, least ratio not below 0.9 of one sequential thread's), 1 else.
Everything lies under out/threads.

With --repetitions the deterministic scheduler runs so many times on each number of threads and with each of --backends, on this case and on
polar-1 (four cycles in one process), and nothing else is done: exit code 0 when all meshes of a case are the same file.

With --simulate the times of more threads than there are come from the measured tasks of one (GEO_ADAPT_SIMULATE), and nothing else is done:
exit code 0 when the forecast for two threads is within 3 % of two threads.
"""

import argparse
import hashlib
import json
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from comparing.adapters import GeoAdapt  # noqa: E402
from comparing.cases import CUBE_CYLINDER, OWN_START, natural  # noqa: E402
from judging import cycles  # noqa: E402
from scaling.simulation import simulate  # noqa: E402

OUT = cycles.ROOT / "out" / "threads"
OPERATIONS = ["insertion", "collapse", "reconnection", "smoothing"]
# Points of unit edges, and the part of the least ratio, that may be lost to threads.
POINTS, PART = 0.3, 0.9


def arguments():
    parser = argparse.ArgumentParser(prog="cases/threads", allow_abbrev=False, description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--complexity", type=float, default=100_000, help="default: 100 000")
    parser.add_argument("--threads", type=int, nargs="+", help="default: powers of two up to all cores, and twice as many")
    parser.add_argument("--program", type=Path, required=True, help="a geo-adapt that is built (default: it is built, release)")
    parser.add_argument("--repetitions", type=int, metavar="N", help="only whether the same mesh comes N times from each")
    parser.add_argument("--backends", nargs="+", default=["stealing", "rayon"], help="those of --repetitions (default: stealing rayon)")
    parser.add_argument("--simulate", type=lambda text: [int(count) for count in text.split(",")], metavar="N,N,…",
                        help="forecasts for so many threads")
    options = parser.parse_args()
    if not options.program.is_file():
        parser.error(f"{options.program} is not there")
    if options.threads and min(options.threads) < 1:
        parser.error("--threads: at least 1")
    return options


def counts():
    """Powers of two up to all cores, all cores, and twice as many: more threads than cores must not matter."""
    cores = os.cpu_count() or 1
    powers = {2**k for k in range(cores.bit_length()) if 2**k <= cores}
    return sorted(powers | {cores, 2 * cores})


def one_run(program, start, complexity, scheduler, threads):
    """One run; what its report and its files tell."""
    name = f"{scheduler}-{threads}"
    mesh, report, log = (OUT / f"{name}.{end}" for end in ("meshb", "json", "log"))
    for path in (mesh, report, log):
        path.unlink(missing_ok=True)
    command = [program, "adapt", start, "-o", mesh, "--cad", CUBE_CYLINDER, "--analytic", "polar-2", "--complexity", complexity,
               "--threads", threads, "--scheduler", scheduler, "--report", report, "--quiet"]
    ran = cycles.measured(command, log)
    if ran.code != 0:
        raise RuntimeError(f"{name}: geo-adapt ended with {ran.code} ({log}):\n{cycles.tail(log)}")
    told = json.loads(report.read_text())
    lengths, ratios = told["statistics"]["edge_lengths"], told["statistics"]["mean_ratios"]
    unit = sum(c["count"] for c in lengths["classes"] if c["low"] > 0.7 and c["high"] is not None and c["high"] < 1.5)
    digest = hashlib.sha256(mesh.read_bytes() + mesh.with_suffix(".solb").read_bytes()).hexdigest()
    work = told["operations"]
    return {
        "scheduler": scheduler, "threads": threads, "adapt": told["seconds"]["adapt"],
        "seconds": {kind: work[kind]["seconds"] for kind in OPERATIONS},
        "attempts": sum(of["attempts"] for of in work.values()),
        "conflicts": sum(of["refused"].get("conflict", 0) for of in work.values()),
        "unit": 100 * unit / lengths["count"], "least": ratios["min"], "mean": ratios["mean"],
        "histogram": [c["count"] / ratios["count"] for c in ratios["classes"]], "digest": digest,
    }


def digest_of(program, name, words):
    """The checksum of what one run writes."""
    mesh, log = OUT / f"{name}.meshb", OUT / f"{name}.log"
    ran = cycles.measured([program, "adapt", *words, "-o", mesh, "--quiet"], log)
    if ran.code != 0:
        raise RuntimeError(f"{name}: geo-adapt ended with {ran.code} ({log}):\n{cycles.tail(log)}")
    return hashlib.sha256(mesh.read_bytes() + mesh.with_suffix(".solb").read_bytes()).hexdigest()


def repeat(options, start):
    """Whether the same meshes come from each number of threads and back-end, each time."""
    model = ["--cad", CUBE_CYLINDER, "--deterministic"]
    cases = {
        "polar-1": [OWN_START, *model, "--analytic", "polar-1", "--cycles", 4],
        "large": [start, *model, "--analytic", "polar-2", "--complexity", options.complexity],
    }
    same = True
    for case, words in cases.items():
        seen = {}
        for backend in options.backends:
            for threads in options.threads or [1, 2, 3, 8, 16]:
                for _ in range(options.repetitions):
                    digest = digest_of(options.program, "repeated", [*words, "--threads", threads, "--backend", backend])
                    seen.setdefault(digest, []).append(f"{backend} on {threads}")
        runs = sum(map(len, seen.values()))
        cycles.say(f"{case}: {runs} runs, {len(seen)} checksum{'s' * (len(seen) > 1)}: " + "; ".join(digest[:16] for digest in seen))
        for digest, names in list(seen.items())[1:]:
            cycles.say(f"LOST  {case}: another mesh ({digest[:16]}) from {', '.join(names)}")
            same = False
    return 0 if same else 1


def line(run, first):
    """A row of the table; `first` is the same scheduler on one thread."""
    def share(now, then):
        return f"{now:6.2f} s {then / now:5.2f}"
    parts = [share(run["seconds"][kind], first["seconds"][kind]) for kind in OPERATIONS]
    whole = first["adapt"] / run["adapt"]
    efficiency = 100 * whole / min(run["threads"], os.cpu_count() or 1)
    return (f"{run['scheduler']:<14}{run['threads']:>3}  {share(run['adapt'], first['adapt'])} {efficiency:4.0f} %  " + "  ".join(parts)
            + f"  {100 * run['conflicts'] / run['attempts']:5.2f} %  {run['unit']:6.2f} % {run['least']:.3f} {run['mean']:.4f}  {run['digest'][:12]}")


def faults(runs):
    """What depends on the threads and may not."""
    found = []
    reference = next(run for run in runs if run["scheduler"] == "sequential")
    for run in runs:
        name = f"{run['scheduler']} on {run['threads']}"
        if abs(run["unit"] - reference["unit"]) > POINTS:
            found.append(f"{name}: {run['unit']:.2f} % unit edges, {reference['unit']:.2f} sequentially")
        if run["least"] < PART * reference["least"]:
            found.append(f"{name}: least ratio {run['least']:.3f}, {reference['least']:.3f} sequentially")
    if len({run["digest"] for run in runs if run["scheduler"] == "deterministic"}) > 1:
        found.append("deterministic: the meshes are not the same")
    return found


def main():
    options = arguments()
    OUT.mkdir(parents=True, exist_ok=True)
    start, _ = natural(GeoAdapt(options.program))
    if options.simulate:
        words = [options.program, "adapt", start, "-o", OUT / "simulated.meshb", "--cad", CUBE_CYLINDER, "--analytic", "polar-2",
                 "--complexity", options.complexity]
        return simulate(words, OUT, options.simulate, options.repetitions or 3)
    if options.repetitions:
        return repeat(options, start)
    cycles.say(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; behind seconds the speed-up, then the efficiency on the cores that there are")
    cycles.say(f"{'scheduler':<14}{'thr':>3}  {'adapting':<21}  " + "  ".join(f"{kind:<14}" for kind in OPERATIONS)
               + "  conflicts  unit edges, least and mean ratio, checksum")
    runs = []
    for scheduler in ("sequential", "speculative", "deterministic"):
        first = None
        for threads in [1] if scheduler == "sequential" else options.threads or counts():
            run = one_run(options.program, start, options.complexity, scheduler, threads)
            first = first or run
            runs.append(run)
            cycles.say(line(run, first))
    cycles.say("mean ratios, per cent of the tetrahedra from the lowest class to the highest:")
    for run in runs:
        cycles.say(f"{run['scheduler']:<14}{run['threads']:>3}  " + " ".join(f"{100 * part:6.2f}" for part in run["histogram"]))
    (OUT / "result.json").write_text(json.dumps(runs, indent=1))
    found = faults(runs)
    for fault in found:
        cycles.say(f"LOST  {fault}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
