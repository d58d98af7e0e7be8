"""The loop: solve, make the metric of what came, adapt, bring the fields along, solve again. It stops and goes on at any time."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import metric as metrics
from .adapting import Adapter, Progress
from .errors import InputError
from .mesh import Mesh
from .model import Model
from .tensors import Floats
from .work import transfer


@dataclass
class Step:
    """A step of the loop.

    Attributes
    ----------
    number : int
        From 1.
    complexity : float
        That its mesh was adapted to; 0 for the first mesh.
    mesh : Mesh
        Its mesh, with the fields of the solver.
    functionals : dict of str to float
        Those that the solver gave.
    """

    number: int
    complexity: float
    mesh: Mesh
    functionals: dict[str, float] = field(default_factory=dict)


#: What a solver is: it gets a mesh and the fields of the step before (or None), and returns fields at the points by name; or these and
#: functionals by name.
Solver = Callable[
    [Mesh, "dict[str, Floats] | None"],
    "Mapping[str, npt.ArrayLike] | tuple[Mapping[str, npt.ArrayLike], Mapping[str, float]]",
]


class Cycle:
    """The steps of a loop that are done, in their order: a sequence of `Step`, whose meshes are read when they are asked for."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def _files(self) -> list[Path]:
        # A step is done when its record is there: it is written last, and renamed.
        found: list[Path] = []
        while (record := self.folder / f"step-{len(found) + 1:03d}.json").is_file():
            found.append(record)
        return found

    def __len__(self) -> int:
        return len(self._files())

    def __getitem__(self, index: int) -> Step:
        record = self._files()[index]
        about = json.loads(record.read_text(encoding="utf-8"))
        mesh = Mesh.read(record.with_suffix(".meshb"))
        with np.load(record.with_suffix(".npz")) as fields:
            mesh.fields = {name: fields[name] for name in about["fields"]}
        return Step(about["number"], about["complexity"], mesh, about["functionals"])

    def __iter__(self) -> Iterator[Step]:
        return (self[index] for index in range(len(self)))

    @property
    def functionals(self) -> list[dict[str, float]]:
        """Of each step: "points", and those that the solver gave."""
        rows = [json.loads(record.read_text(encoding="utf-8")) for record in self._files()]
        return [{"points": row["points"], **row["functionals"]} for row in rows]

    def _keep(self, step: Step, asked: dict[str, Any]) -> None:
        stem = self.folder / f"step-{step.number:03d}"
        fields, step.mesh.fields = step.mesh.fields, {}
        try:
            step.mesh.write(stem.with_suffix(".meshb"))
        finally:
            step.mesh.fields = fields
        with open(stem.with_suffix(".npz.tmp"), "wb") as file:
            np.savez(file, **fields)  # type: ignore[arg-type]
        os.replace(stem.with_suffix(".npz.tmp"), stem.with_suffix(".npz"))
        about = {
            "number": step.number,
            "complexity": step.complexity,
            "points": len(step.mesh.points),
            "functionals": step.functionals,
            "fields": list(fields),
            "asked": asked,
        }
        stem.with_suffix(".json.tmp").write_text(json.dumps(about, indent=1), encoding="utf-8")
        os.replace(stem.with_suffix(".json.tmp"), stem.with_suffix(".json"))


def cycle(
    solve: Solver,
    mesh: Mesh,
    complexities: Sequence[float],
    folder: str | os.PathLike[str],
    *,
    model: Model | None = None,
    sensor: str | Callable[[Mesh], npt.ArrayLike] | None = None,
    geometry: bool = True,
    threads: int | None = None,
    progress: Callable[[Progress], bool | None] | None = None,
    **multiscale: Any,
) -> Cycle:
    """A loop with a Python function as the solver. Stop it when you like: the same call goes on where it was.

    Parameters
    ----------
    solve : callable
        ``solve(mesh, before)`` returns a dict of fields at the points, (n, ...); or a tuple of these and a dict of functionals.
        `before` are the fields of the last step, brought to this mesh, or None.
    mesh : Mesh
        The first mesh.
    complexities : sequence of float
        One a further step: about half the number of its points.
    folder : path
        Where each step is kept: mesh, fields, and a record that is written last. A step that was cut off is done again.
    model : Model, optional
        The CAD model. By default the surface of the first mesh.
    sensor : str or callable, optional
        What is resolved: the name of a scalar field, or a function of the mesh with its fields. By default the only scalar field.
    geometry : bool
        Whether the sizes that the model asks for are intersected, at most half of the complexity.
    threads, progress
        As in `adapt`.
    **multiscale
        Further arguments of `metric.multiscale`: norm, hessian, gradation, hmin, hmax, aspect_ratio.

    Returns
    -------
    Cycle
        The steps: ``len(complexities) + 1``.

    Raises
    ------
    InputError
        When the folder has a loop of other complexities up to its last step, or the fields do not fit.

    Examples
    --------
    >>> import numpy as np, geo_adapt, tempfile
    >>> def solve(mesh, before):
    ...     u = np.tanh(20 * (mesh.points[:, 0] - 0.5))
    ...     return {"u": u}, {"most": float(u.max())}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     steps = geo_adapt.cycle(solve, geo_adapt.examples.cube(4), [200, 400], folder)
    ...     len(steps), steps[2].mesh.fields["u"].shape == (len(steps[2].mesh.points),)
    (3, True)
    """
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    steps = Cycle(place)
    asked = [0.0, *map(float, complexities)]
    done = [json.loads(record.read_text(encoding="utf-8")) for record in steps._files()]
    if [row["complexity"] for row in done] != asked[: len(done)]:
        raise InputError(f"{place}: has a loop of other complexities; give another folder, or these with more behind them")
    adapter = Adapter(model, surface=None if model is not None else mesh, threads=threads)
    last = steps[len(done) - 1] if done else None
    for number in range(len(done) + 1, len(asked) + 1):
        complexity = asked[number - 1]
        before: dict[str, Floats] | None = None
        current = mesh
        if last is not None:
            wanted = _metric(last.mesh, complexity, sensor, model if geometry else None, threads, multiscale)
            result = adapter.adapt(
                last.mesh, wanted, order="medit", complexity=complexity, report=False, progress=progress
            )
            current = result.mesh
            before = {name: transfer(last.mesh, old, current, threads=threads) for name, old in last.mesh.fields.items()}
            if not result.complete:
                break
        answer = solve(current, before)
        fields, functionals = answer if isinstance(answer, tuple) else (answer, {})
        current.fields = {name: np.asarray(values, dtype=np.float64) for name, values in fields.items()}
        for name, values in current.fields.items():
            if values.ndim == 0 or len(values) != len(current.points):
                raise InputError(f"solve: field {name!r} of shape {values.shape} on {len(current.points)} points: give a row each")
        last = Step(number, complexity, current, {name: float(value) for name, value in functionals.items()})
        steps._keep(last, {"complexities": list(asked)})
    return steps


def _metric(
    mesh: Mesh,
    complexity: float,
    sensor: str | Callable[[Mesh], npt.ArrayLike] | None,
    model: Model | None,
    threads: int | None,
    options: dict[str, Any],
) -> Floats:
    """The multiscale metric of the sensor, with the sizes of the geometry."""
    if callable(sensor):
        values = np.asarray(sensor(mesh), dtype=np.float64)
    else:
        scalars = [name for name, found in mesh.fields.items() if found.ndim == 1]
        if sensor is None and len(scalars) != 1:
            raise InputError(f"sensor: name one of the scalar fields: {', '.join(scalars) or 'there is none'}")
        name = scalars[0] if sensor is None else sensor
        if name not in mesh.fields:
            raise InputError(f"sensor: there is no field {name!r}; there are: {', '.join(mesh.fields)}")
        values = mesh.fields[name]
    fixed = None
    if model is not None:
        fixed = metrics.geometry(mesh, model, threads=threads)
        own = metrics.complexity(mesh, fixed, order="medit", between=True, threads=threads)
        if own > complexity / 2:
            warnings.warn(
                f"the geometry alone asks for a complexity of {own:.0f}: its sizes are enlarged to half of {complexity:g}", stacklevel=3
            )
            fixed = metrics.scale(mesh, fixed, complexity / 2, order="medit", threads=threads)
    return metrics.multiscale(
        mesh, values, complexity, fixed=fixed, order="medit", between=True, threads=threads, **options
    )
