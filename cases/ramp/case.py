"""A supersonic ramp, Mach 2 and 15°, inviscid, by OpenFOAM or SU2 in the loop: angle, strength and sharpness of its shock against theory.

Runs loop.toml or, with --solver su2, loop-su2.toml anew, judges its last mesh and solution, and the same solver on a uniform mesh of as many vertices. --short: coarser and with
fewer cycles, with its own floors. Exit code: 0 when every floor is held, else 1.
"""

import json
import math
import re
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import shock  # noqa: E402
from comparing.expected import Bound  # noqa: E402
from judging import cycles, loops, meshfile  # noqa: E402

HERE = Path(__file__).resolve().parent
OUT = cycles.ROOT / "out" / "ramp"
MODEL = cycles.ROOT / "geometry/ramp.step"
# (target, floor of today); angles in degrees, lengths in those of the ramp.
BOUNDS = [
    Bound("angle, error", "≤", 0.3, 0.3), Bound("pressure, error", "≤", 0.01, 0.01),
    Bound("uniform error / error", "≥", 3, 3), Bound("cells", "≤", 0.01, 0.01), Bound("layer", "≤", 0.01, 0.01),
]
SHORT = [
    Bound("angle, error", "≤", 0.3, 0.5), Bound("pressure, error", "≤", 0.01, 0.015),
    Bound("uniform error / error", "≥", 3, 2), Bound("cells", "≤", 0.01, 0.02), Bound("layer", "≤", 0.01, 0.03),
]
# What is another in the short form.
SHORTER = {"complexity": "500", "max_complexity": "1000"}
# How a solver calls its steps, and how many they are in the short form and on the uniform mesh.
STEPS = {"openfoam": ("steps", 800, 3000), "su2": ("iterations", 400, 1500)}


def judged(mesh, solution, exact):
    """Figures of a mesh and the fields on it."""
    fields = loops.fields(solution)
    return shock.figures(meshfile.read_mesh(mesh), loops.pressure(fields), fields["Mach"], exact)


def uniform(options, text, vertices, folder, exact):
    """Figures on a mesh of one size everywhere with as many vertices, within some percent."""
    folder.mkdir(parents=True, exist_ok=True)
    mesh, size = folder / "uniform.meshb", (1.31 * 0.05 / vertices) ** (1 / 3)
    for _ in range(3):
        mesh.unlink(missing_ok=True)
        words = [options.program, "bootstrap", MODEL, "-o", mesh, "--size", str(size), "--feature-cells", "off", "-q"]
        if subprocess.run(words, check=False).returncode != 0:
            sys.exit("the uniform mesh could not be made")
        found = len(meshfile.read_mesh(mesh).points)
        size *= (found / vertices) ** (1 / 3)
        if abs(found / vertices - 1) < 0.05:
            break
    # One solve; what is adapted after it is small, and of no interest.
    name, _, steps = STEPS[options.solver]
    changed = {name: steps, "complexity": "100", "max_complexity": "100", "folder": f'"{folder}/uniform"'}
    text = re.sub(r'(?m)^bootstrap = .*\noptions = .*$', f'file = "{mesh}"\ncad = "{MODEL}"', loops.replaced(text, changed))
    config = folder / "uniform.toml"
    config.write_text(text)
    loops.run(options.program, config, folder / "uniform", "--restart")
    return judged(mesh, folder / "uniform/cycle-01/solve/solution.solb", exact)


def main():
    options = loops.arguments(__doc__, short="coarser, fewer cycles", solvers=list(STEPS))
    if not loops.has_solver(options):
        return 0
    exact, (name, few, _) = shock.oblique(2.0, math.radians(15)), STEPS[options.solver]
    options.restart = True
    folder, steps = loops.ran(options, HERE, OUT, SHORTER | {name: few})
    text, seconds = loops.configuration(HERE, options), sum(value for step in steps for value in step["seconds"].values())
    result = judged(*loops.last(steps, folder), exact)
    even = uniform(options, text, result["vertices"], OUT / f"{folder.name}-uniform", exact)
    cycles.say(f"exact    angle {math.degrees(exact.angle):.4f}°, pressure ratio {exact.pressure:.5f}, Mach number behind {exact.behind:.5f}")
    for name, found in [("adapted", result), ("uniform", even)]:
        shown = "  ".join(f"{key} {value:.5g}" for key, value in found.items())
        cycles.say(f"{name}  {shown}")
    result |= {
        "angle, error": abs(result["angle"] - math.degrees(exact.angle)), "pressure, error": abs(result["pressure"]),
        "uniform error / error": even["mach_error"] / result["mach_error"], "seconds": seconds,
    }
    (folder.parent / f"{folder.name}.json").write_text(json.dumps({"adapted": result, "uniform": even}, indent=1))
    cycles.say(f"{seconds:.0f} s in the loop; its report is {folder}/report.html")
    return loops.judged(SHORT if options.short else BOUNDS, result)


if __name__ == "__main__":
    sys.exit(main())
