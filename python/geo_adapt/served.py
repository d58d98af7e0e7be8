"""What a service makes of meshes and models: an adaptation, and a CAD model that is there."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .errors import InputError
from .jobs import File, Job
from .mesh import Mesh
from .model import Closest, Model
from .tensors import Floats

if TYPE_CHECKING:
    from .server import Server


class Adaptation:
    """What came of an adaptation on a service.

    Attributes
    ----------
    mesh : Mesh
        The adapted mesh, with the references and names of the one that went in.
    metric : ndarray, shape (n, 6)
        The metric at its points, in the order "medit": 11 12 22 13 23 33, in 1/length².
    report : dict
        The figures of ``geo-adapt adapt --json``. Empty where the work was stopped.
    complexity : float or None
        That the metric was scaled to.
    complete : bool
        Whether it came to its end: False where it was cancelled. The mesh is valid in any case.
    growth_end : {None, "not-accounted-for", "max-vertices", "memory"}
        Why the mesh stopped growing before its metric was met: see `Result`.
    overgrown : bool
        Whether there is such a reason.
    off_model : ndarray of uint32
        Points of the boundary that found no room on the model.
    deviating, crossings : int
        Triangles beyond the bounds of the surface; pairs of triangles in which the boundary crosses itself.
    job : Job
        What made it. Its results are the files "out.meshb" and "out.solb".
    """

    def __init__(self, job: Job) -> None:
        self.job = job
        self.mesh: Mesh = job.result("out.meshb").mesh()
        found = job.results.get("out.solb")
        self.metric: Floats = found.fields()[0] if found is not None else np.empty((0, 6))
        report = job.results.get("report.json")
        self.report: dict[str, Any] = report.json() if report is not None else {}
        wanted = self.report.get("vertices_wanted") or {}
        self.complexity: float | None = self.report.get("complexity_wanted") or wanted.get("complexity")
        self.complete: bool = job.state != "cancelled"
        self.growth_end: str | None = self.report.get("growth_end")
        self.overgrown: bool = self.growth_end is not None
        # In reports what has a number counts from 1.
        self.off_model = (np.array(self.report.get("off_model", []), np.int64) - 1).astype(np.uint32)
        self.deviating: int = self.report.get("deviating", 0)
        self.crossings: int = self.report.get("crossings", {}).get("count", 0)

    def __repr__(self) -> str:
        how = "" if self.complete else ", stopped"
        return f"<geo_adapt.Adaptation: {len(self.mesh.points)} points, {len(self.mesh.tets)} tetrahedra{how}>"


class ServedModel(Model):
    """A CAD model on a service, which lists its faces, edges and vertices. `Server.Model` makes it.

    Attributes
    ----------
    path : Path
        Its name on the service.
    """

    def __init__(self, server: Server, file: File, labels: Mapping[str, Any]) -> None:
        self._server = server
        self._file_there = file
        self._labels = dict(labels)
        self.path = Path(file.name)
        self._listed: dict[str, Any] | None = None

    def _load(self) -> None:
        self._listed = None

    def _for_service(self) -> tuple[File, bytes | None]:
        return self._file_there, json.dumps(self._labels).encode() if self._labels else None

    def _file(self, place: Path) -> Path:
        path = self._file_there.save(place)
        if self._labels:
            Path(f"{path}.names.json").write_text(json.dumps(self._labels))
        return path

    @property
    def _all(self) -> dict[str, Any]:
        if self._listed is None:
            job = self._server._call("model", {"json": True}, {"file": (self, self.path.name)})
            self._listed = json.loads(job.printed)
        return self._listed

    def __getattr__(self, name: str) -> Any:
        # What OpenCASCADE has in memory here.
        if name == "_kernel":
            raise InputError(f"{self.path}: this model is on a service: give it to a call of the server, or geo_adapt.Model here")
        raise AttributeError(name)

    def closest(self, points: npt.ArrayLike, face: int | None = None, threads: int | None = None) -> Closest:
        """Is for models here: `geo_adapt.Model`."""
        raise InputError("closest: a service has no command for it; read the model here with geo_adapt.Model")

    def write_brep(self, path: str | os.PathLike[str]) -> None:
        """Writes the model as a BREP of OpenCASCADE."""
        job = self._server._call("model", {"output": "out.brep"}, {"file": (self, self.path.name)})
        job.result("out.brep").save(path)

    def __repr__(self) -> str:
        return f"<geo_adapt.ServedModel of {self.path.name} at {self._server.url}>"


__all__ = ["Adaptation", "ServedModel"]
