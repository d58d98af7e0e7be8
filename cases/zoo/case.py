"""Every model of geometry/: a first mesh, then two cycles each to a planar layer and to the metric of the geometry.

A line a model: vertices and CPU seconds of the first mesh; and for each field vertices, unit edges, least and mean ratio, CPU seconds, judged
in the layer evaluated, and in the geometry's metric interpolated on the result. A model fails where a command does, a mesh is not valid, a vertex
is off the model (1e-7 of its diagonal, or its own tolerance), a face, an edge, a corner, a region or a name is lost, or a ratio is below the floor.
Exit code: 1 if any model fails. Figures as JSON, meshes and logs under out/zoo.
"""

import argparse
import json
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cases"))
import one  # noqa: E402
from judging.tools import Tools, ended  # noqa: E402

OUT = ROOT / "out" / "zoo"
# What the worst tetrahedron of any result must have; a solver is stopped by what is near nothing.
LEAST = 0.01
# Its cone ends in a point of 3.4 degrees: a tetrahedron there as long as the least size is 0.03 of that wide, and one of a ring of nine
# about the axis has a ratio of 0.018 at best.
LEAST_AT_APEX = {"needle": 0.003}


def models():
    """{name: file}: the STEP files, and the BREP files under their whole names."""
    folders = [ROOT / "geometry", ROOT / "geometry/zoo", ROOT / "geometry/build123d"]
    found = {path.stem: path for folder in folders for path in sorted(folder.glob("*.step"))}
    return found | {path.name: path for folder in folders for path in sorted(folder.glob("*.brep"))}


def arguments(known):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/geo-adapt", help="the built program (default %(default)s)")
    parser.add_argument("--models", metavar="A,B,…", help="some of them (default: all)")
    parser.add_argument("--start", choices=["bootstrap", "gmsh"], default="bootstrap", help="who makes the first mesh (default %(default)s; "
                        "gmsh: the program gmsh and `geo-adapt classify`)")
    parser.add_argument("--limit", type=float, default=600, help="seconds that one command may take (default %(default)s)")
    parser.add_argument("--threads", type=int, default=0, help="default: all cores")
    options = parser.parse_args()
    options.names = options.models.split(",") if options.models else list(known)
    unknown = [name for name in options.names if name not in known]
    if unknown:
        parser.error(f"no model {', '.join(unknown)}; there are {', '.join(known)}")
    if not options.program.is_file():
        sys.exit(f"{options.program} is not there: cargo build --release, or cases/run zoo, which does it")
    return options


def row(name, result):
    """A line of the table."""
    start = result.get("start")
    text = f"{name:<27}" + (f"{start['vertices']:>7} {start['seconds']:>6.1f}" if start else f"{'–':>7} {'':>6}")
    for field in one.FIELDS:
        figures = result.get(field)
        if figures:
            text += f" |{figures['vertices']:>7} {100 * figures['unit_edges']:>5.1f} % "
            text += f"{figures['ratio_least']:>6.3f} {figures['ratio_mean']:.3f} {figures['seconds']:>6.1f}"
        else:
            text += f" |{'–':>7} {'':>7} {'':>6} {'':>5} {'':>6}"
    return text + ("  ok" if not result["problems"] else "  FAILED")


HEAD = (f"{'model':<27}{'start':>7} {'s':>6} |{'layer':>7} {'unit':>7} {'least':>6} {'mean':>5} {'s':>6}"
        f" |{'geom.':>7} {'unit':>7} {'least':>6} {'mean':>5} {'s':>6}")


def main():
    known = models()
    options, results, began = arguments(known), {}, time.monotonic()
    print(HEAD, flush=True)
    for name in options.names:
        tools = Tools(options.program.resolve(), options.limit, options.threads)
        result = one.go(tools, known[name], OUT / name, options.start)
        for field in one.FIELDS:
            least = result.get(field, {}).get("ratio_least", 1)
            floor = LEAST_AT_APEX.get(name, LEAST)
            if least < floor:
                result["problems"].append(f"{field}: the least ratio is {least:.2g}, below {floor}")
        (OUT / name / "log.txt").write_text("\n".join(tools.log))
        (OUT / name / "result.json").write_text(json.dumps(result, indent=1))
        results[name] = result
        print(row(name, result), flush=True)
    (OUT / "results.json").write_text(json.dumps(results, indent=1))
    failed = {name: result["problems"] for name, result in results.items() if result["problems"]}
    return ended(failed, len(results), "models", began, OUT)


if __name__ == "__main__":
    sys.exit(main())
