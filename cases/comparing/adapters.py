"""The adapters that are compared: how each is told what to do."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Task:
    """One adaptation: from `mesh` to `output`, by the field (scaled to `complexity` on `mesh`, if given)."""

    mesh: Path
    output: Path
    # None where no CAD model is to be used
    model: Path | None
    field: str
    complexity: float | None
    # the field at the vertices of `mesh`, scaled; a .solb that the caller has written
    sizes: Path
    # whether the field is known by `sizes` alone
    from_file: bool = False


@dataclass(frozen=True)
class GeoAdapt:
    """Ours: one thread, on the CAD model, the analytic field evaluated by the program itself where it has it."""

    program: Path
    name: str = "geo-adapt"

    def command(self, task):
        """The command line of a task."""
        metric = ["--metric", task.sizes] if task.from_file else ["--analytic", task.field]
        if task.complexity and not task.from_file:
            metric += ["--complexity", task.complexity]
        model = ["--cad", task.model] if task.model else []
        report = task.output.with_suffix(".json")
        return [self.program, "adapt", task.mesh, "-o", task.output, *model, *metric, "--threads", "1", "--report", report]


@dataclass(frozen=True)
class Mmg3d:
    """mmg3d 5.8 without its gradation (it would change the metric asked for); it knows no CAD model."""

    program: Path
    name: str = "mmg3d"

    def command(self, task):
        """The command line of a task."""
        return [self.program, "-hgrad", "-1", "-v", "1", "-sol", task.sizes, task.mesh, task.output]
