"""The same four cycles with mmg3d -hgrad -1: no CAD, the metric evaluated at the vertices before each cycle.

Started by mmg.sh, which brings the program. Writes out/cube-cylinder/mmg.json for case.py to compare with.
"""

import argparse
import importlib.util
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cases"))
from judging import cycles, meshfile, metric  # noqa: E402


def program():
    """The program itself, not PyPI's Python wrapper around it, whose start-up would count as CPU time."""
    found = importlib.util.find_spec("mmgpy")
    path = Path(found.origin).parent / "bin" / "mmg3d_O3" if found else None
    if not path or not path.is_file():
        sys.exit("mmg3d_O3 is not there: run cases/cube-cylinder/mmg.sh, which installs mmgpy from PyPI")
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("start", type=Path, help="the start mesh")
    parser.add_argument("--fields", nargs="+", default=list(cycles.FLOORS), choices=metric.FIELDS)
    parser.add_argument("--cycles", type=int, default=4)
    options = parser.parse_args()
    folder = ROOT / "out" / "cube-cylinder" / "mmg"
    folder.mkdir(parents=True, exist_ok=True)
    results = {}
    cycles.say(cycles.COLUMNS)
    for field in options.fields:
        results[field] = run(options, folder, field)
        cycles.say(cycles.row("mmg3d -hgrad -1", field, results[field], results[field]["cpu_seconds"]))
    remember(folder.parent / "mmg.json", str(options.start.resolve()), results)


def remember(path, start, results):
    """Puts the results under their start mesh, beside those of other start meshes and fields."""
    known = json.loads(path.read_text()) if path.is_file() else {}
    known[start] = known.get(start, {}) | results
    path.write_text(json.dumps(known, indent=1))


def run(options, folder, field):
    """The cycles of one field; the judge's figures of the last mesh with the CPU seconds of all."""
    current, total, log = options.start, 0.0, folder / f"{field}.log"
    log.unlink(missing_ok=True)
    for cycle in range(1, options.cycles + 1):
        mesh = meshfile.read_mesh(current)
        sizes, target = folder / f"{field}-{cycle}-in.solb", folder / f"{field}-{cycle}.meshb"
        meshfile.write_metric(sizes, metric.analytic(field, mesh.points))
        code, seconds, _ = cycles.measured([program(), "-hgrad", "-1", "-v", "1", "-sol", sizes, current, target], log)
        if code != 0:
            sys.exit(f"mmg3d ended with {code} ({log}):\n{cycles.tail(log)}")
        current, total = target, total + seconds
    result = cycles.judged(current, field)
    return result | {"cpu_seconds": total}


if __name__ == "__main__":
    main()
