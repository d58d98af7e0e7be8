"""Random layers on the models of geometry/: whatever a metric asks for, the mesh is valid, on the model, and made in bounded time.

Each seed draws a model, one to three layers (planes, spheres, cylinders, walls; 1e-5 to 1e-2 of the model's diagonal across), a complexity and
one to three cycles from a coarse first mesh. A line a seed: vertices, also a unit of complexity, unit edges, least and mean ratio
in the metric that the last cycle asked for, milliseconds of CPU time a vertex and cycle, and what was drawn. A seed fails where a command does, the mesh is not
valid or its boundary crosses itself, or a vertex is off the model. Exit code: 1 if any fails. Everything lies under out/random-layers.
"""

import argparse
import json
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cases"))
import layers  # noqa: E402
from judging import meshfile, represent, report  # noqa: E402
from judging.tools import Failed, Tools, ended  # noqa: E402

OUT = ROOT / "out" / "random-layers"
# Segments a radian along the curved faces and edges of the first meshes, which are to be coarse.
SEGMENTS = 2


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/geo-adapt", help="the built program (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first seed (default %(default)s)")
    parser.add_argument("--count", type=int, default=20, help="seeds (default %(default)s)")
    parser.add_argument("--limit", type=float, default=600, help="seconds that one command may take (default %(default)s)")
    parser.add_argument("--threads", type=int, default=1, help="default: 1")
    options = parser.parse_args()
    if not options.program.is_file():
        sys.exit(f"{options.program} is not there: cargo build --release, or cases/run random-layers, which does it")
    return options


def known_models(tools):
    """{name: what `geo-adapt model --json` tells}, and a coarse first mesh of each under OUT."""
    found = {}
    OUT.mkdir(parents=True, exist_ok=True)
    for path in sorted((ROOT / "geometry").glob("*.step")):
        found[path.stem] = json.loads(tools.run("model", path, "--json")[0])
        if not first_mesh(path.stem).is_file():
            tools.run("bootstrap", path, "-o", first_mesh(path.stem), "--segments", SEGMENTS, "--feature-cells", "off", "-q", *tools.threads_words())
    return found


def first_mesh(name):
    """Where the first mesh of a model is."""
    return OUT / f"first-{name}.meshb"


def adapted(tools, job, model, folder):
    """All cycles of a job: (the last mesh's figures in the metric that was asked for last, what is wrong)."""
    path, current, seconds = ROOT / "geometry" / f"{job.model}.step", first_mesh(job.model), 0.0
    folder.mkdir(parents=True, exist_ok=True)
    for cycle in range(1, job.cycles + 1):
        sizes, target = folder / f"{cycle}-in.solb", folder / f"{cycle}.meshb"

        def of_wall(layer, mesh=current):
            field = folder / "wall.solb"
            tools.run("metric", "wall", mesh, "--cad", path, *layer.wall(), "-o", field, "-q")
            return meshfile.read_metric(field)

        meshfile.write_metric(sizes, job.metric(meshfile.read_mesh(current).points, of_wall))
        target.unlink(missing_ok=True)
        words = ["adapt", current, "-o", target, "--cad", path, "--metric", sizes, "--complexity", f"{job.complexity:.0f}"]
        seconds += tools.run(*words, *tools.threads_words())[1]
        current = target
    mesh = meshfile.read_mesh(current)
    figures = report.figures(mesh, meshfile.read_metric(current.with_suffix(".solb")))
    # 1: the mesh has flaws.
    inspected = json.loads(tools.run("inspect", current, "--cad", path, "--json", codes=(0, 1))[0])
    problems = figures["findings"] + represent.missing(mesh, model) + represent.off_model(inspected, model)[1]
    problems += represent.flaws(inspected, path.name)
    return figures | {"milliseconds": 1e3 * seconds / job.cycles / figures["vertices"]}, problems


def main():
    options, failed, began = arguments(), {}, time.monotonic()
    tools = Tools(options.program.resolve(), options.limit, options.threads)
    models = known_models(tools)
    print(f"{'seed':>6} {'vertices':>9} {'per C':>6} {'unit':>7} {'least':>6} {'mean':>6} {'ms/v':>6}", flush=True)
    for seed in range(options.seed, options.seed + options.count):
        job, folder, tools.log = layers.drawn(seed, models), OUT / str(seed), []
        try:
            figures, problems = adapted(tools, job, models[job.model], folder)
            line = (f"{figures['vertices']:>9} {figures['vertices_per_complexity']:>6.2f} {100 * figures['unit_edges']:>5.1f} % "
                    f"{figures['ratio_least']:>6.3f} {figures['ratio_mean']:>6.3f} {figures['milliseconds']:>6.3f}")
        except (Failed, meshfile.FileError) as error:
            line, problems = f"{'–':>9} {'':>6} {'':>7} {'':>6} {'':>6} {'':>6}", [str(error)]
        (folder / "log.txt").write_text("\n".join(tools.log + problems))
        print(f"{seed:>6} {line}  {job.told()}{'  FAILED' * bool(problems)}", flush=True)
        if problems:
            failed[f"seed {seed}"] = problems
    return ended(failed, options.count, "seeds", began, OUT)


if __name__ == "__main__":
    sys.exit(main())
