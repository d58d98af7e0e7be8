"""The UGAWG cube-cylinder: three fields, four cycles each, judged independently.

For each input (the project's own model and start mesh; the UGAWG files where ../shared is there) and each field,
`geo-adapt adapt` runs four times, each time on its last output. The last mesh is held against the floor of issue 2.
Exit code: 0 when every figure is reached, else 1.
"""

import argparse
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cases"))
from judging import cycles, meshfile  # noqa: E402

OUT = ROOT / "out" / "cube-cylinder"


def inputs():
    """{name: (mesh, model)}: the own files, and the UGAWG ones if they are there."""
    found = {"own": (ROOT / "cases/cube-cylinder/start.meshb", ROOT / "geometry/cube-cylinder.step")}
    shared = cycles.SHARED / "cube-cylinder"
    if (shared / "cube-cylinder.meshb").is_file():
        found["ugawg"] = (shared / "cube-cylinder.meshb", shared / "cube-cylinder.step")
    else:
        cycles.say(f"the UGAWG files are not at {shared} (GEO_ADAPT_SHARED names their place): own files only")
    return found


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/geo-adapt")
    parser.add_argument("--fields", nargs="+", default=list(cycles.FLOORS), choices=list(cycles.FLOORS))
    parser.add_argument("--inputs", nargs="+", choices=["own", "ugawg"], help="default: all that are there")
    parser.add_argument("--cycles", type=int, default=4)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--pictures", action="store_true", help="also draw the last meshes")
    return parser.parse_args()


def run(options, name, mesh, model, field):
    """The cycles of one input and field: (the judge's figures of the last mesh, what was missed)."""
    log = OUT / f"{name}-{field}.log"
    log.unlink(missing_ok=True)
    start, current, total, missed = meshfile.read_mesh(mesh), mesh, 0.0, []
    for cycle in range(1, options.cycles + 1):
        target = OUT / f"{name}-{field}-{cycle}.meshb"
        target.unlink(missing_ok=True)
        command = [options.program, "adapt", current, "-o", target, "--cad", model, "--analytic", field,
                   "--threads", options.threads, "--report", target.with_suffix(".json")]
        ran = cycles.measured(command, log)
        if ran.code != 0:
            return None, [f"cycle {cycle}: geo-adapt ended with {ran.code} ({log}):\n{cycles.tail(log)}"]
        total += ran.cpu_seconds
        result = cycles.judged(target, field, start)
        missed += [f"cycle {cycle}: {finding}" for finding in result["findings"]]
        current = target
    return result | {"cpu_seconds": total}, missed + cycles.FLOORS[field].missed(result)


def baseline(mesh):
    """{field: CPU seconds of mmg3d} for the same start mesh and four cycles on this machine, where cases/compare was run."""
    found = {}
    for field in cycles.FLOORS:
        path = ROOT / "out" / "compare" / field / "result.json"
        known = json.loads(path.read_text()) if path.is_file() else {}
        rival = known.get("codes", {}).get("mmg3d")
        if rival and rival["cycles"] == 4 and known["start"] == str(Path(mesh).resolve()):
            found[field] = rival["cpu_seconds"]
    return found


def draw(options, name, field):
    """Pictures of the last mesh, by picture.py."""
    mesh = OUT / f"{name}-{field}-{options.cycles}.meshb"
    command = [sys.executable, ROOT / "cases/picture.py", mesh, "--analytic", field, "-o", mesh.with_suffix(".png")]
    drawn = cycles.measured(command, OUT / "pictures.log").code == 0
    cycles.say(f"  picture: {mesh.with_suffix('.png')}" if drawn else f"  no picture: see {OUT / 'pictures.log'}")


def main():
    options = arguments()
    if not options.program.is_file():
        sys.exit(f"{options.program} is not there: cargo build --release, or cases/run cube-cylinder, which does it")
    OUT.mkdir(parents=True, exist_ok=True)
    problems, table = [], {}
    cycles.say(cycles.COLUMNS)
    for name, (mesh, model) in inputs().items():
        if options.inputs and name not in options.inputs:
            continue
        rivals = baseline(mesh)
        for field in options.fields:
            result, missed = run(options, name, mesh, model, field)
            if result:
                rival = rivals.get(field)
                note = f"  (mmg3d {rival:.1f})" if rival else ""
                cycles.say(cycles.row(f"geo-adapt, {name}", field, result, result["cpu_seconds"]) + note)
                if rival and options.threads == 1 and result["cpu_seconds"] >= rival:
                    missed.append(f"CPU {result['cpu_seconds']:.1f} s, mmg3d took {rival:.1f} s")
                table[f"{name} {field}"] = result
                if options.pictures:
                    draw(options, name, field)
            problems += [f"{name} {field}: {line}" for line in missed]
            (OUT / "table.json").write_text(json.dumps(table, indent=1))
    cycles.say(f"meshes, reports and logs: {OUT}")
    for problem in problems:
        cycles.say(f"MISSED  {problem}")
    cycles.say("all figures reached" if not problems else f"{len(problems)} figures missed")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
