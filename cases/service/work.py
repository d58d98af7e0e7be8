"""The jobs of the case: small adaptations of a few start meshes and of a CAD model, and between them an inspection and a conversion."""

import json
import shutil
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CAD = ROOT / "geometry/cube-cylinder.step"
START = ROOT / "cases/cube-cylinder/start.meshb"
# Seconds that a command of the preparation may take.
LIMIT = 120


@dataclass(frozen=True)
class Job:
    """A command with its words, the files that it reads and those that it writes."""

    command: str
    words: tuple
    reads: tuple
    writes: tuple
    options: tuple = field(default=())

    def typed(self):
        """What is typed behind the name of the program, to get what a service makes."""
        return [self.command, *self.words, *self.options]


def has_cad(program):
    """Whether the program reads CAD models."""
    ran = subprocess.run([program, "model", CAD, "--json"], capture_output=True, timeout=LIMIT, check=False)
    return ran.returncode == 0 and bool(json.loads(ran.stdout)["faces"])


def prepare(program, folder, cad):
    """Start meshes in a folder: {name: file}, the model's among them."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    files = {"start.meshb": folder / "start.meshb"}
    shutil.copyfile(START, files["start.meshb"])
    if cad:
        files[CAD.name] = folder / CAD.name
        shutil.copyfile(CAD, files[CAD.name])
    for name, words in {
        "even.meshb": ["start.meshb", "--size", "0.06"],
        "layer.meshb": ["start.meshb", "--analytic", "polar-1", "--complexity", "600"],
    }.items():
        command = [program, "adapt", *words, "-o", name, "--threads", "1", "--deterministic", "-q"]
        subprocess.run(command, cwd=folder, timeout=LIMIT, check=True)
        files[name] = folder / name
    return files


# What is adapted: the start mesh, the field and its complexity, and whether on the CAD model where there is one. 0.3 to 1.5 s of CPU each.
ADAPTED = [
    ("start.meshb", "linear", 2500, True), ("even.meshb", "polar-2", 4000, False), ("layer.meshb", "polar-1", 1500, False),
    ("start.meshb", "polar-2", 3500, True), ("even.meshb", "linear", 3000, False), ("layer.meshb", "polar-2", 2000, False),
    ("start.meshb", "polar-1", 1200, True), ("even.meshb", "polar-2", 6000, False),
]


def jobs(count, cad):
    """So many jobs, of which no two adaptations are the same: in each ten, eight of these, an inspection and a conversion."""
    found = []
    for number in range(count):
        at, turn = number % 10, number // 10
        if at == 4:
            found.append(Job("inspect", ("even.meshb", "--report", "report.json"), ("even.meshb",), ("report.json",)))
        elif at == 9:
            found.append(Job("convert", ("layer.meshb", "out.vtu"), ("layer.meshb",), ("out.vtu",)))
        else:
            mesh, analytic, complexity, on_cad = ADAPTED[at - (at > 4)]
            words = (mesh, "-o", "out.meshb", "--analytic", analytic, "--complexity", str(complexity + 5 * turn))
            model = (CAD.name,) if cad and on_cad else ()
            words += ("--cad", CAD.name) if model else ()
            found.append(Job("adapt", words, (mesh, *model), ("out.meshb", "out.solb"), ("--threads", "1", "--deterministic")))
    return found
