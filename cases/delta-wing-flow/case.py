"""The delta wing of the high-order workshops, laminar, Mach 0.3, Re 4000 and 12.5°, by OpenFOAM or SU2 in the loop: lift and drag beside the published ones.

Runs loop.toml or, with --solver su2, loop-su2.toml, or, with --goal, loop-goal.toml, whose meshes are made for the lift (--restart: anew); compares C_D and C_L with those of Tsolakis 2021 (section 4.2.2, at 5.7 million vertices), and draws the vortex and
the way to the coefficients. --short: coarse, with its own floors, half a minute. Exit code: 0 when every floor is held, else 1.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import pictures  # noqa: E402
from comparing.expected import Bound  # noqa: E402
from judging import cycles, loops, meshfile  # noqa: E402

HERE = Path(__file__).resolve().parent
OUT = cycles.ROOT / "out" / "delta-wing-flow"
MODEL = cycles.ROOT / "geometry/zoo/delta-wing-domain.step"
NAMES = {"farfield": [1, 3, 4, 5, 6], "symmetry": [2], "wing": [7, 8, 9, 10]}
# C_D and C_L of the dissertation's last mesh.
PUBLISHED = {"CD": 0.165396, "CL": 0.346937}
# (target, floor of today): relative differences from the published ones, which are within 0.55 % of each other.
BOUNDS = [Bound("drag, error", "≤", 0.0055, 0.01), Bound("lift, error", "≤", 0.0055, 0.01), Bound("adaptation", "≤", 0.05, 0.05)]
# SU2 has its values at the vertices, OpenFOAM in the cells, of which there are five times as many: of the same coarse mesh it makes less.
SHORT = {
    "openfoam": [Bound("drag, error", "≤", 0.0055, 0.02), Bound("lift, error", "≤", 0.0055, 0.025), Bound("adaptation", "≤", 0.05, 0.15)],
    "su2": [Bound("drag, error", "≤", 0.0055, 0.1), Bound("lift, error", "≤", 0.0055, 0.03), Bound("adaptation", "≤", 0.05, 0.15)],
}
SHORTER = {"complexity": "1000", "max_complexity": "1500", "every": "1", "factor": "1.5"}


def main():
    options = loops.arguments(__doc__, short="coarse, half a minute", solvers=["openfoam", "su2"], goal="meshes for the lift, by OpenFOAM's adjoint")
    if not loops.has_solver(options):
        return 0
    # SU2 takes numbers in its list of walls for temperatures: the faces need names.
    values = {"MODEL": loops.named(options.program, MODEL, OUT / "model", NAMES)} if loops.by_su2(options) else {}
    folder, loop = loops.ran(options, HERE, OUT, SHORTER, values)
    for step in loop:
        found = step["functionals"]
        shown = "  ".join(f"{key} {found[key]:.6f} ({found[key] / value - 1:+.2%})" for key, value in PUBLISHED.items())
        cycles.say(f"cycle {step['cycle']:>2}  {step['vertices']:>8} vertices  {shown}  {found.get('steps', found.get('iterations')):.0f} steps")
    mesh, solution = loops.last(loop, folder)
    mesh, fields = meshfile.read_mesh(mesh), loops.fields(solution)
    pictures.vortex(mesh, fields["Mach"], folder / "vortex.png")
    pictures.way(loop, PUBLISHED, folder / "coefficients.png")
    last = loop[-1]["functionals"]
    result = {"vertices": len(mesh.points), "CD": last["CD"], "CL": last["CL"], "adaptation": loops.adaptation(loop),
              "drag, error": abs(last["CD"] / PUBLISHED["CD"] - 1), "lift, error": abs(last["CL"] / PUBLISHED["CL"] - 1)}
    folder.with_suffix(".json").write_text(json.dumps(result, indent=1))
    cycles.say("  ".join(f"{key} {value:.5g}" for key, value in result.items()))
    cycles.say(f"{folder}/report.html, {folder}/vortex.png, {folder}/coefficients.png")
    return loops.judged(SHORT[options.solver] if options.short else BOUNDS, result)


if __name__ == "__main__":
    sys.exit(main())
