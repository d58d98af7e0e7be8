"""Compares geo-adapt with mmg3d on the same inputs, judged independently; other codes' known figures stand beside.

Exit code: 0 when every floor of comparing/expected.py is held and every mesh of geo-adapt is valid, 1 else, 2 on a wrong command line.
Everything lies under out/compare; a case's figures in out/compare/CASE/result.json.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from comparing import runs, table  # noqa: E402
from comparing.adapters import GeoAdapt, Mmg3d  # noqa: E402
from comparing.cases import CASES, OUT  # noqa: E402
from comparing.expected import EXPECTED  # noqa: E402
from judging import cycles  # noqa: E402


def arguments():
    listing = "\n".join(f"  {case.name:<12} {case.summary}" for case in CASES.values())
    parser = argparse.ArgumentParser(prog="cases/compare", allow_abbrev=False, description=__doc__, epilog=f"cases:\n{listing}",
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE", help="default: all")
    parser.add_argument("--cycles", type=int, help="instead of the case's own; floors and targets are not held then")
    parser.add_argument("--only", choices=["geo-adapt", "mmg3d"], help="run one of the two (its partner's earlier result stays)")
    parser.add_argument("--program", type=Path, required=True, help="a geo-adapt that is built (default: it is built, release)")
    parser.add_argument("--mmg3d", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    unknown = [name for name in options.cases if name not in CASES]
    if unknown:
        parser.error(f"no case {', '.join(unknown)}; there are {', '.join(CASES)}")
    if options.cycles is not None and options.cycles < 1:
        parser.error("--cycles: at least 1")
    for path in (options.program, options.mmg3d):
        if path and not path.is_file():
            parser.error(f"{path} is not there")
    return options


def run(case, options, ours, rival):
    """One case, its lines printed and its file written; (what expected.py asks for, what is wrong with geo-adapt's meshes)."""
    count = options.cycles if options.cycles and case.cycles > 1 else case.cycles
    place = runs.folder(case)
    place.mkdir(parents=True, exist_ok=True)
    if case.rivals:
        codes = [code for code in (ours, rival) if code and options.only in (None, code.name)]
        results, start = runs.compare(case, codes, ours, count)
    else:
        results, start = runs.drift(case, ours, count)
    for name, result in results.items():
        cycles.say(table.row(case.name, name, result))
    ratios = runs.ratios(results)
    if ratios:
        cycles.say(table.ratio_line(ratios))
    figures = results.get("geo-adapt", {}) | ratios
    if not case.rivals:
        drifts = runs.worst_drift(results)
        figures = {f"drift {way}": points for way, points in drifts.items()}
        for way in drifts:
            shares = " ".join(f"{100 * share:.2f}" for share in results[way]["unit_edges_of_cycles"])
            cycles.say(f"{'':<12}{way}: unit edges {shares} %, the last {drifts[way]:.2f} points below the best")
    remember(place / "result.json", case, start, results, ratios)
    wrong = []
    for name, result in results.items():
        if name != "mmg3d":
            wrong += [f"{name}: {line}" for line in [*result.get("findings", []), *filter(None, [result.get("failed")])]]
    return figures, wrong


def remember(path, case, start, results, ratios):
    """Puts the results beside those of earlier runs; the ratios are of one run, or none."""
    known = json.loads(path.read_text()) if path.is_file() else {}
    earlier = known.get("codes", {}) if known.get("start") == str(Path(start).resolve()) else {}
    stamp = {"when": time.strftime("%Y-%m-%d %H:%M:%S"), "load": round(os.getloadavg()[0], 2), "cores": os.cpu_count()}
    codes = earlier | {name: result | stamp for name, result in results.items()}
    content = {"case": case.name, "start": str(Path(start).resolve()), "codes": codes, "ratios": ratios}
    path.write_text(json.dumps(content, indent=1))


def hold(figures, wrong, held):
    """Prints what was reached; returns the lines about what was lost."""
    lost = []
    for name, values in figures.items():
        for bound in EXPECTED[name] if held else []:
            value = values.get(bound.figure)
            cycles.say(f"{name:<12}{bound.line(value)}")
            if value is not None and not bound.held(value):
                lost.append(f"{name}: {bound.line(value)}")
    return lost + [f"{name}: {line}" for name, lines in wrong.items() for line in lines]


def main():
    options = arguments()
    OUT.mkdir(parents=True, exist_ok=True)
    ours = GeoAdapt(options.program.resolve())
    rival = Mmg3d(options.mmg3d.resolve()) if options.mmg3d else None
    if os.getloadavg()[0] > 1:
        cycles.say(f"others are at work on this machine (load {os.getloadavg()[0]:.1f}): trust the ratios, not the seconds")
    cycles.say(table.header())
    figures, wrong, notes = {}, {}, []
    for name in options.cases or CASES:
        case = CASES[name]
        try:
            figures[name], wrong[name] = run(case, options, ours, rival if case.rivals else None)
        except RuntimeError as error:
            figures[name], wrong[name] = {}, [str(error)]
        for line in table.published_rows(name, notes):
            cycles.say(line)
    if all("cpu_seconds" in figures.get(name, {}) for name in ("large-25k", "large-400k")):
        figures["large-400k"]["growth"] = runs.growth(figures["large-25k"], figures["large-400k"])
        cycles.say(f"the time grows with the vertices to the power {figures['large-400k']['growth']:.3f}")
    cycles.say(table.notes_text(notes))
    lost = hold(figures, wrong, held=options.cycles is None)
    (OUT / "figures.json").write_text(json.dumps(figures, indent=1))
    cycles.say(f"meshes, reports, logs and figures: {OUT}")
    for line in lost:
        cycles.say(f"LOST  {line}")
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
