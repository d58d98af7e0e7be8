"""Layers along the whole ONERA M6 wing, in one run from the first mesh that `bootstrap` makes of its STEP file.

Judged by the metric of the walls made anew on the result: what counts is not what the coarse mesh told of the wing, but the wing. Exit code: 0 when
every floor is held, 1 when one is lost; 0 where the shared files are not there.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from comparing.expected import Bound  # noqa: E402
from judging import cycles, meshfile, on_cad, report  # noqa: E402

# The faces of the wing: all but the far field and the plane of symmetry.
WING = "3+4+5+6+7+8+9+10+11+12"
# Size outside of the layers.
OUTSIDE = 20

# (target, floor of today). Of a unit mesh the first height is 0.82 of what is asked for.
BOUNDS = [
    *on_cad.quality((0.95, 0.88), (0.05, 0.00005), (0.85, 0.80)),
    Bound("first_height", "≥", 0.8, 0.75),
    Bound("first_height", "≤", 0.9, 1.0),
    Bound("points", "≥", 0.95, 0.95),
    Bound("points", "≤", 1.05, 1.1),
]


def layers(program, mesh, model, wall):
    """First height and points across, over what is asked for."""
    seen = json.loads(on_cad.tool(program, "inspect", mesh, "--cad", model, "--wall", wall, "--json"))
    found = seen["walls"][0]
    return {"first_height": found["mean"] / found["asked"], "points": found["points"] / found["points_asked"]}, seen


def main():
    options = on_cad.arguments(__doc__, 1, first=1e-5)
    (model,) = on_cad.shared("onera-m6", "onera-m6-sharp-te.stp")
    folder = cycles.ROOT / "out" / "m6-walls"
    folder.mkdir(parents=True, exist_ok=True)
    start, result, sizes = folder / "start.meshb", folder / "layers.meshb", folder / "anew.solb"
    wall, log = f"{WING}:h={options.first},growth=1.2", folder / "adapt.log"
    for file in (start, result, sizes, log):
        file.unlink(missing_ok=True)
    on_cad.tool(options.program, "bootstrap", model, "-o", start, "-q")
    command = [options.program, "adapt", start, "--cad", model, "--size", OUTSIDE, "--wall", wall, "-o", result]
    command += ["--report", folder / "report.json"] + (["--threads", options.threads] if options.threads else [])
    ran = cycles.measured(command, log)
    if ran.code != 0:
        cycles.say(f"LOST  geo-adapt ended with {ran.code} ({log}):\n{cycles.tail(log)}")
        return 1
    on_cad.tool(options.program, "metric", "wall", result, "--cad", model, "--wall", wall, "--hmax", OUTSIDE, "-o", sizes, "-q")
    figures = report.figures(meshfile.read_mesh(result), meshfile.read_metric(sizes))
    of_layers, seen = layers(options.program, result, model, wall)
    figures |= of_layers | {"cpu_seconds": ran.cpu_seconds, "wall_seconds": ran.wall_seconds}
    lost = list(figures["findings"])
    diagonal = json.loads(on_cad.tool(options.program, "model", model, "--json"))["diagonal"]
    if seen["cad"]["from_entity"]["distance"] > on_cad.ON_CAD * diagonal:
        lost.append("a vertex lies off the model")
    cycles.say(cycles.COLUMNS)
    cycles.say(cycles.row("geo-adapt", "", figures, ran.cpu_seconds))
    for draft in json.loads((folder / "report.json").read_text()).get("drafts", []):
        cycles.say(f"  a draft with layers {draft['thicker']:g} times as thick: {draft['vertices']} vertices, {draft['seconds']:.2f} s")
    (folder / "result.json").write_text(json.dumps(figures, indent=1))
    for bound in BOUNDS:
        line = bound.line(figures[bound.figure])
        cycles.say(f"  {line}")
        if not bound.held(figures[bound.figure]):
            lost.append(line)
    for line in lost:
        cycles.say(f"LOST  {line}")
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
