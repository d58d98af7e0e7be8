"""One model of the zoo: its first mesh, two cycles to each field, and the judge's figures of the last meshes."""

import json

import layer
from judging import meshfile, report, represent
from judging.tools import Failed

CYCLES = 2
FIELDS = ("layer", "geometry")


def go(tools, path, folder, mesher):
    """{"model", "start", "layer", "geometry", "problems"}: figures for JSON, and everything that is wrong, one line each."""
    folder.mkdir(parents=True, exist_ok=True)
    result = {"problems": []}
    try:
        model = json.loads(tools.run("model", path, "--json")[0])
        result["model"] = {"diagonal": model["diagonal"], "tolerance": model["tolerance"]}
        result["model"] |= {kind: len(model[kind]) for kind in ("faces", "edges", "vertices")}
        start, seconds = first_mesh(tools, path, folder, mesher)
        mesh = meshfile.read_mesh(start)
        problems = report.counts(mesh)["findings"] + represent.missing(mesh, model)
        result["start"] = {"vertices": len(mesh.points), "seconds": seconds, "problems": problems}
        result["problems"] += [f"start: {line}" for line in problems]
    except (Failed, meshfile.FileError, KeyError) as error:
        result["problems"].append(f"start: {error}")
        return result
    for name in FIELDS:
        try:
            result[name] = adapted(tools, path, model, start, folder, name)
            result["problems"] += [f"{name}: {line}" for line in result[name]["problems"]]
        except (Failed, meshfile.FileError, ValueError) as error:
            result["problems"].append(f"{name}: {error}")
    return result


def first_mesh(tools, path, folder, mesher):
    """The start mesh, by `bootstrap` or `gmsh`, associated with the model, and its CPU seconds."""
    start = folder / "start.meshb"
    start.unlink(missing_ok=True)
    if mesher == "bootstrap":
        return start, tools.run("bootstrap", path, "-o", start, "-q", *tools.threads_words())[1]
    raw = folder / "gmsh.mesh"
    seconds = tools.command("gmsh", "-3", "-clcurv", "12", "-format", "mesh", "-o", raw, path)[1]
    return start, seconds + tools.run("classify", raw, "--cad", path, "-o", start)[1]


def adapted(tools, path, model, start, folder, name):
    """Two cycles to a field, and the judge's figures of the last mesh."""
    current, seconds = start, 0.0
    for cycle in range(1, CYCLES + 1):
        sizes, target = folder / f"{name}-{cycle}-in.solb", folder / f"{name}-{cycle}.meshb"
        write_sizes(tools, path, model, current, sizes, name)
        target.unlink(missing_ok=True)
        before = current
        words = ["adapt", current, "-o", target, "--cad", path, "--metric", sizes, "-q", *tools.threads_words()]
        seconds += tools.run(*words)[1]
        current = target
    mesh = meshfile.read_mesh(current)
    values = wanted(tools, model, before, sizes, current, folder / f"{name}-wanted.solb", mesh, name)
    figures = {key: value for key, value in report.figures(mesh, values).items() if not key.endswith(("_histogram", "_references"))}
    # 1: the mesh has flaws.
    inspected = json.loads(tools.run("inspect", current, "--cad", path, "--json", codes=(0, 1))[0])
    figures["off_model"], far = represent.off_model(inspected, model)
    problems = figures.pop("findings") + represent.missing(mesh, model) + far + represent.flaws(inspected, path.name)
    lost = represent.names(start) - represent.names(current)
    if lost:
        problems.append(f"names lost: {sorted(lost)}")
    return figures | {"seconds": seconds, "problems": problems}


def write_sizes(tools, path, model, mesh, sizes, name):
    """The field at the vertices of a mesh."""
    if name == "geometry":
        tools.run("metric", "geometry", mesh, "--cad", path, "-o", sizes, "-q")
    else:
        meshfile.write_metric(sizes, layer.metric(meshfile.read_mesh(mesh).points, middle(model), model["diagonal"]))


def wanted(tools, model, old, sizes, new, target, mesh, name):
    """The field that was asked for, at the vertices of the result: evaluated, or interpolated."""
    if name == "layer":
        return layer.metric(mesh.points, middle(model), model["diagonal"])
    tools.run("metric", "interpolate", old, sizes, new, "-o", target, "-q")
    return meshfile.read_metric(target)


def middle(model):
    """The middle of the model's box."""
    low, high = model["bounds"]
    return [(a + b) / 2 for a, b in zip(low, high)]
