"""One model of the zoo: its first mesh, two cycles to each field, and the judge's figures of the last meshes."""

import json
import os
import resource
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

import layer
from judging import meshfile, report, represent

CYCLES = 2
FIELDS = ("layer", "geometry")


class Failed(Exception):
    """A step that did not end well; the message has the command and what it said."""


@dataclass
class Tools:
    """The program, how first meshes are made (`bootstrap` or `gmsh`), the seconds that one command may take, and threads (0: all cores)."""

    program: Path
    start: str
    limit: float
    threads: int = 0
    log: list = field(default_factory=list)

    def run(self, *words, codes=(0,)):
        """Runs the program; returns what it printed and its CPU seconds."""
        return self.command(self.program, *words, codes=codes)

    def command(self, *words, codes=(0,)):
        """Runs a command; raises Failed with what it said where its exit code is none of `codes`."""
        text = [str(word) for word in words]
        self.log.append(" ".join(text))
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        # A session of its own, so that the mesher that it may have started ends with it.
        with subprocess.Popen(text, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace", start_new_session=True) as child:
            try:
                out, err = child.communicate(timeout=self.limit)
            except subprocess.TimeoutExpired:
                os.killpg(child.pid, signal.SIGKILL)
                raise Failed(f"{' '.join(text)}\n    did not end within {self.limit:g} s") from None
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.log.append(f"# {time.monotonic() - began:.1f} s\n{out}{err}")
        if child.returncode not in codes:
            said = "\n    ".join((err or out).strip().splitlines()[-4:])
            raise Failed(f"{' '.join(text)}\n    ended with {child.returncode}: {said}")
        return out, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def threads_words(self):
        """The option of threads, if any."""
        return ["--threads", self.threads] if self.threads else []


def go(tools, path, folder):
    """{"model", "start", "layer", "geometry", "problems"}: figures for JSON, and everything that is wrong, one line each."""
    folder.mkdir(parents=True, exist_ok=True)
    result = {"problems": []}
    try:
        model = json.loads(tools.run("model", path, "--json")[0])
        result["model"] = {"diagonal": model["diagonal"], "tolerance": model["tolerance"]}
        result["model"] |= {kind: len(model[kind]) for kind in ("faces", "edges", "vertices")}
        start, seconds = first_mesh(tools, path, folder)
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


def first_mesh(tools, path, folder):
    """The start mesh, associated with the model, and its CPU seconds."""
    start = folder / "start.meshb"
    start.unlink(missing_ok=True)
    if tools.start == "bootstrap":
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
