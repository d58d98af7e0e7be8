"""Runs the cases: the adapters in turn, cycle by cycle, each on its own last mesh, judged after each."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from judging import cycles, meshfile, metric, report

from .adapters import Task
from .cases import OUT

# How the field reaches the program: by its name; as a file with the field at the input's vertices, as a solver gives it;
# or as the file that the program wrote beside its last mesh, the hardest, where every cycle interpolates what the last one interpolated.
EVALUATED, AT_VERTICES, CARRIED = "evaluated", "at the vertices", "carried"


@dataclass
class Chain:
    """The cycles of one adapter on one case: where it is, and what it took so far."""

    code: object
    path: Path
    mesh: meshfile.Mesh
    way: str
    label: str
    runs: list = field(default_factory=list)
    figures: list = field(default_factory=list)
    inputs: list = field(default_factory=list)
    failed: str | None = None

    def result(self):
        """Figures of the last mesh and what all cycles took, ready for JSON."""
        common = {"cycles": len(self.figures), "mesh": str(self.path)}
        if self.failed:
            return common | {"failed": self.failed}
        made = [figures["vertices"] for figures in self.figures]
        seconds = max(sum(run.cpu_seconds for run in self.runs), 1e-9)
        last = {key: value for key, value in self.figures[-1].items() if not key.endswith("_histogram")}
        return last | common | {
            "findings": [f"cycle {i}: {line}" for i, figures in enumerate(self.figures, 1) for line in figures["findings"]],
            "cpu_seconds": seconds,
            "wall_seconds": sum(run.wall_seconds for run in self.runs),
            "vertices_per_second": sum(made) / seconds,
            "input_vertices_per_second": sum(self.inputs) / seconds,
            "peak_bytes": max(run.peak_bytes for run in self.runs),
            "bytes_per_vertex": max(run.peak_bytes / max(pair) for run, *pair in zip(self.runs, self.inputs, made)),
            "unit_edges_of_cycles": [figures["unit_edges"] for figures in self.figures],
        }


def compare(case, codes, ours, count):
    """One case by all codes, alternating so that their times are of the same minutes; {code: result} and the start mesh."""
    start, model = case.start(ours)
    mesh = meshfile.read_mesh(start)
    way = AT_VERTICES if case.from_file else EVALUATED
    chains = [Chain(code, start, mesh, way, code.name) for code in codes]
    for _ in range(count):
        for chain in chains:
            if not chain.failed:
                advance(chain, case, model, mesh)
    return {chain.code.name: chain.result() for chain in chains}, start


def drift(case, ours, count):
    """The field reached in three ways, `count` cycles each; {way: result} and the start mesh."""
    start, model = case.start(ours)
    mesh = meshfile.read_mesh(start)
    first = Chain(ours, start, mesh, EVALUATED, "evaluated")
    while len(first.runs) < count and not first.failed:
        advance(first, case, model, mesh)
    results = {EVALUATED: first.result()}
    # a file on the coarse start mesh cannot hold the layers: these two begin where the field is resolved
    resolved = folder(case) / f"evaluated-{min(4, count)}.meshb"
    for way in () if first.failed else (AT_VERTICES, CARRIED):
        chain = Chain(ours, resolved, meshfile.read_mesh(resolved), way, way.replace(" ", "-"))
        while len(chain.runs) < count and not chain.failed:
            advance(chain, case, model, mesh)
        results[way] = chain.result()
    return results, start


def folder(case):
    """Where the meshes, logs and reports of a case lie."""
    return OUT / case.name


def advance(chain, case, model, start):
    """One cycle more: the field at the vertices, the adapter, the judge."""
    number, place = len(chain.runs) + 1, folder(case)
    log, output = place / f"{chain.label}.log", place / f"{chain.label}-{number}.meshb"
    if number == 1:
        log.unlink(missing_ok=True)
    output.unlink(missing_ok=True)
    values = metric.analytic(case.field, chain.mesh.points)
    # both programs and the judge have the field times the same factor, which comes from the input mesh
    factor = 1.0
    if case.complexity:
        factor = (case.complexity / metric.complexity(chain.mesh.points, chain.mesh.tets, values)) ** (2 / 3)
    sizes = chain.path.with_suffix(".solb") if chain.way == CARRIED else place / f"{chain.label}-{number}-in.solb"
    if chain.way != CARRIED:
        meshfile.write_metric(sizes, factor * values)
    task = Task(chain.path, output, model, case.field, case.complexity, sizes, from_file=chain.way != EVALUATED)
    before = len(chain.mesh.points)
    ran = cycles.measured(chain.code.command(task), log)
    if ran.code != 0 or not output.is_file():
        chain.failed = f"cycle {number}: {chain.code.name} ended with {ran.code} ({log}):\n{cycles.tail(log)}"
        return
    chain.path, chain.mesh = output, meshfile.read_mesh(output)
    figures = report.figures(chain.mesh, factor * metric.analytic(case.field, chain.mesh.points))
    if model and chain.code.name == "geo-adapt":
        more, found = case.judge(chain.mesh, start)
        figures |= more | {"findings": figures["findings"] + found}
    chain.runs.append(ran)
    chain.figures.append(figures)
    chain.inputs.append(before)


def ratios(results):
    """Ours over mmg3d's: time, memory, vertices a second; nothing where one is missing."""
    pair = [results.get(name) for name in ("geo-adapt", "mmg3d")]
    if any(result is None or "failed" in result for result in pair):
        return {}
    ours, other = pair
    names = {"time_ratio": "cpu_seconds", "memory_ratio": "peak_bytes", "rate_ratio": "vertices_per_second"}
    return {name: ours[figure] / other[figure] for name, figure in names.items()}


def growth(small, big):
    """The exponent of the time in the number of vertices, log(t'/t)/log(n'/n)."""
    return float(np.log(big["cpu_seconds"] / small["cpu_seconds"]) / np.log(big["vertices"] / small["vertices"]))


def worst_drift(results):
    """{way: points of unit edges that the last cycle is below the best}."""
    return {way: 100 * (max(result["unit_edges_of_cycles"]) - result["unit_edges_of_cycles"][-1])
            for way, result in results.items() if "failed" not in result}
