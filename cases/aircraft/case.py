"""Half of a transport aircraft, 117 faces, inviscid at Mach 0.8, by SU2 in the loop: a mesh on its CAD with all faces and names, and the shocks on the wing.

`bootstrap` makes the first mesh of its far field; then SU2 solves, and the mesh is adapted to the Mach number, up to 200 000 vertices (--complexity 100000). --short: one
coarse adaptation. It needs SU2_CFD on the PATH, and ends with 0 where that is not there. Exit code: 0 when every floor is held, else 1.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import parts  # noqa: E402
from comparing.expected import Bound  # noqa: E402
from judging import cycles, loops, meshfile, metric, represent  # noqa: E402

HERE = Path(__file__).resolve().parent
OUT = cycles.ROOT / "out" / "aircraft"
MODEL = cycles.ROOT / "geometry/aircraft/transport-half.step"
# (target, floor of today).
COMMON = [Bound("least ratio", "≥", 0.2, 0.2), Bound("greatest local Mach number on the wing", "≥", 1.2, 1.2)]
BOUNDS = [*COMMON, Bound("vertices", "≥", 180000, 180000), Bound("adaptation", "≤", 0.05, 0.05)]
SHORT = [*COMMON, Bound("vertices", "≥", 40000, 40000), Bound("adaptation", "≤", 0.05, 0.05)]
# File: words of `view`. Lengths are metres; x goes aft, z up.
PICTURES = {
    "wing": ["--color", "Mach", "--range", "0.3,1.5", "--no-wire", "--view=-90,89", "--at", "17.5,9.5,0", "--zoom", "1.8"],
    "wing-mesh": ["--color", "Mach", "--range", "0.3,1.5", "--view=-90,89", "--at", "17.5,9.5,0", "--zoom", "1.8"],
    "aircraft": ["--color", "Mach", "--range", "0.3,1.5", "--no-wire", "--view", "125,25"],
    "cut": ["--cut", "y=8.5", "--color", "Mach", "--range", "0.3,1.5", "--view", "90,0", "--at", "18.5,8.5,-0.3", "--zoom", "5"],
    "nacelle": ["--color", "Mach", "--range", "0.3,1.5", "--view", "125,-20", "--at", "13,5.2,-2", "--zoom", "6"],
}


def told(program, *words):
    """What the program prints."""
    return subprocess.run([str(word) for word in (program, *words)], check=True, stdout=subprocess.PIPE, text=True).stdout


def first(program, folder):
    """The first mesh, its model with the far field, and the parts of the aircraft, by which its faces are named."""
    numbers = parts.of_faces(json.loads(told(program, "model", MODEL, "--json"))["faces"])
    body, mesh = loops.named(program, MODEL, folder, numbers), folder / "first.meshb"
    told(program, "bootstrap", body, "--far-field", "box:10", "--symmetry", "y", "-o", mesh, "-q")
    return mesh, mesh.with_suffix(".brep"), list(numbers)


def judged(program, path, cad, solution):
    """Figures of the last mesh and the flow on it; and what is lost of the model."""
    mesh, fields = meshfile.read_mesh(path), loops.fields(solution)
    model, inspected = (json.loads(told(program, *words, "--json")) for words in (["model", cad], ["inspect", path, "--cad", cad]))
    off, lost = represent.off_model(inspected, model)
    lost += represent.missing(mesh, model) + represent.flaws(inspected, cad.name)
    labels = json.loads(path.with_suffix(".names.json").read_text())["triangles"]
    wing = [int(number) for number, label in labels.items() if label.get("name") == "wing"]
    ratios = metric.mean_ratios(mesh.points, mesh.tets, meshfile.read_metric(path.with_suffix(".solb")))
    on_wing = np.unique(mesh.triangles[np.isin(mesh.triangle_refs, wing)])
    return {"vertices": len(mesh.points), "tetrahedra": len(mesh.tets), "faces": len(np.unique(mesh.triangle_refs)), "off the model": off,
            "least ratio": float(ratios.min()), "mean ratio": float(ratios.mean()),
            "greatest local Mach number on the wing": float(np.percentile(fields["Mach"][on_wing], 99))}, lost


def main():
    options = loops.arguments(__doc__, short="one coarse adaptation")
    if not loops.has_su2():
        return 0
    folder = OUT / ("short" if options.short else "loop")
    made = OUT / "first" / "made.json"
    if options.restart or not made.is_file():
        mesh, cad, walls = first(options.program, OUT / "first")
        made.write_text(json.dumps([str(mesh), str(cad), walls]))
    mesh, cad, walls = json.loads(made.read_text())
    text = (HERE / "loop.toml").read_text().replace('"WALLS"', json.dumps(walls))
    changed = {"max_complexity": 25000} if options.short else {}
    changed |= {"max_complexity": f"{options.complexity:g}"} if options.complexity else {}
    changed |= {"processes": options.processes} if options.processes else {}
    config = folder.with_suffix(".toml")
    config.write_text(loops.replaced(loops.filled(text, {"MESH": mesh, "MODEL": cad, "FOLDER": folder}), changed))
    loop = loops.run(options.program, config, folder, *(["--restart"] if options.restart or options.short else []))[1]
    for step in loop:
        cycles.say(f"cycle {step['cycle']:>2}  {step['vertices']:>8} vertices  " + "  ".join(f"{key} {value:.5g}" for key, value in step["functionals"].items()))
    path, solution = loops.last(loop, folder)
    for name, words in PICTURES.items():
        told(options.program, "view", path, "--field", solution, "--png", folder / f"{name}.png", *words, "-q")
    result, lost = judged(options.program, path, Path(cad), solution)
    lost += [f"the name {name[1]} is lost" for name in represent.names(Path(mesh)) - represent.names(path)]
    result |= {"adaptation": loops.adaptation(loop), **loop[-1]["functionals"]}
    folder.with_suffix(".json").write_text(json.dumps(result, indent=1))
    cycles.say("  ".join(f"{key} {value:.5g}" for key, value in result.items()))
    cycles.say(f"{folder}/report.html; {', '.join(f'{name}.png' for name in PICTURES)} beside it")
    return loops.judged(SHORT if options.short else BOUNDS, result, lost)


if __name__ == "__main__":
    sys.exit(main())
