"""A service of geo-adapt (``geo-adapt serve``), on which the calls of this package work as they do here.

What goes in is sent where it is not there yet, the command runs on the service, and what comes of it is read back: meshes, fields and metrics
as arrays. The service reads the CAD models; here nothing need be installed for that. What it decides itself is not asked for: threads.

A mesh may be a `Mesh`, the path of a file of any format, or a `File` that the service has; a metric or a field an array, a path of a .sol or
.solb, or a `File`; a model a `Model`, a path, the bytes of a BREP, an object of cadquery or build123d, or a `File`.

What is a matter of a few operations is done here: `metric.isotropic`, `packed`, `full`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from .errors import InputError
from .inputs import Inputs, Source, plain
from .jobs import File, Job, JobProgress
from .mesh import Mesh, _shaped, _shown
from .served import Adaptation, ServedModel
from .server_metric import ServerMetric
from .tensors import Floats, packed, rows
from .transport import Transport
from .work import _method

#: The environment variable with the token.
_TOKEN = "GEO_ADAPT_TOKEN"
#: Seconds that a job may take to end with its last valid mesh when it is asked to.
_PATIENCE = 90.0
#: Arguments that name what is written.
_WRITTEN = ("output", "report", "png")

MeshSource = Union[Mesh, File, str, "os.PathLike[str]"]
Progress = Callable[[JobProgress], Union[bool, None]]


def connect(url: str = "http://127.0.0.1:7878", token: str | None = None) -> Server:
    """A service at an address.

    Parameters
    ----------
    url : str
        Of ``geo-adapt serve``. It is asked directly, without a proxy.
    token : str, optional
        Of who asks, made by ``geo-adapt serve token add``. By default that of the environment variable GEO_ADAPT_TOKEN; a service on this
        machine wants none.

    Returns
    -------
    Server

    Raises
    ------
    InputError
        When the address is none.
    ServerError
        When no service answers there, or the token is not good.

    Examples
    --------
    >>> import numpy as np, geo_adapt
    >>> with geo_adapt.examples.service() as url:
    ...     server = geo_adapt.connect(url)
    ...     mesh = geo_adapt.examples.cube(4)
    ...     m = server.metric.multiscale(mesh, np.tanh(20 * (mesh.points[:, 0] - 0.5)), complexity=300)
    ...     result = server.adapt(mesh, m, order="medit")
    >>> result.complete, result.report["statistics"]["mean_ratios"]["min"] > 0.1
    (True, True)
    """
    server = Server(url, token if token is not None else os.environ.get(_TOKEN) or None)
    server.about()
    return server


class Server:
    """A service, on which the calls of this package work. `connect` makes it; threads may share it.

    The results are those of the same calls here, bit for bit. Ctrl-C ends the job that is waited for.

    Attributes
    ----------
    url : str
        Where it is.
    metric : ServerMetric
        Metrics, as in `geo_adapt.metric`.
    """

    def __init__(self, url: str, token: str | None = None) -> None:
        self._transport = Transport(url, token)
        self.url = self._transport.url
        self.metric = ServerMetric(self)

    # What it is, and what it keeps.

    def about(self) -> dict[str, Any]:
        """Who asks, and what they may: "owner", "scopes", "bytes" that are kept, "most_bytes", "most_vertices", "version".

        Raises
        ------
        ServerError
            When it does not answer, or the token is not good.
        """
        found: dict[str, Any] = self._transport.json("GET", "/v1/me")
        return found

    def commands(self) -> list[dict[str, Any]]:
        """The commands that `run` may ask for, with their arguments, as the service describes them."""
        found: list[dict[str, Any]] = self._transport.json("GET", "/v1/commands")
        return found

    def upload(self, given: Source, name: str | None = None) -> File:
        """Sends a file, for several jobs. What is there already is not sent again, and a large file goes on where it broke off.

        Parameters
        ----------
        given : Mesh, Model, path, bytes, array or File
            A `File` is there, and stays as it is. A mesh goes as its name tells, by default .meshb; an array as .solb.
        name : str, optional
            What it shall be called. By default its own name.

        Returns
        -------
        File

        Raises
        ------
        FileError
            When it cannot be read.
        InputError
            When the service does not take such a file.
        ServerError
            When it has no room, or does not answer.
        """
        if isinstance(given, File):
            return given
        inputs = Inputs(self._transport, are_uploads=True)
        if name is None:
            name = inputs.add(given, _usual(given))
        else:
            inputs.put(name, given)
        sent = {other: self._of_id(id, other) for other, id in inputs.ids.items()}
        file = sent.pop(name)
        file._beside = tuple(sent.values())
        return file

    def _of_id(self, id: str, name: str) -> File:
        """An upload under the name that it was sent with; the service knows it by its last one."""
        told = self._transport.json("GET", f"/v1/files/{id}")
        return File(self._transport, f"/v1/files/{id}/content", {**told, "name": name})

    def files(self, kind: str | None = None) -> list[File]:
        """The uploads, the newest first.

        Parameters
        ----------
        kind : {"model", "mesh", "field", "other"}, optional
            Of this kind alone.
        """
        listed = self._transport.json("GET", "/v1/files", kind=kind)
        return [File(self._transport, f"/v1/files/{told['id']}/content", told) for told in listed]

    def jobs(self, state: str | None = None, limit: int | None = None) -> list[Job]:
        """The jobs, the newest first.

        Parameters
        ----------
        state : {"queued", "running", "done", "failed", "cancelled"}, optional
            In this state alone.
        limit : int, optional
            At most so many, up to 200.
        """
        listed = self._transport.json("GET", "/v1/jobs", state=state, limit=limit)
        return [Job(self._transport, told) for told in listed]

    def job(self, id: str) -> Job:
        """A job, by what it is known by.

        Raises
        ------
        ServerError
            When there is none.
        """
        return Job(self._transport, self._transport.json("GET", f"/v1/jobs/{id}"))

    # Any command.

    def run(
        self,
        command: str,
        arguments: Mapping[str, Any] | Sequence[Any] = (),
        files: Mapping[str, Source] | None = None,
        *,
        label: str = "",
    ) -> Job:
        """Asks for any command of the program, and does not wait for it.

        Parameters
        ----------
        command : str
            "adapt", "metric multiscale", …: those of `commands`.
        arguments : mapping or sequence
            By their names, ``{"mesh": "in.meshb", "output": "out.meshb", "size": 0.1}``, or as they are typed,
            ``["in.meshb", "-o", "out.meshb", "--size", 0.1]``. Files go by the names of `files`.
        files : mapping of str to Mesh, Model, path, bytes, array or File
            What the command reads, by the names that it shall have, whose endings tell the formats. A mesh in libMeshb's format goes without
            its fields; several arrays in a list are the fields of one .solb. The file with names beside a path goes with it.
        label : str
            What the job shall be called.

        Returns
        -------
        Job

        Raises
        ------
        InputError
            When the command line is wrong, or the service does not take a file.
        ServerError
            When it does not take the job, or does not answer.

        Examples
        --------
        >>> import geo_adapt
        >>> with geo_adapt.examples.service() as url:
        ...     server = geo_adapt.connect(url)
        ...     arguments = {"mesh": "in.meshb", "output": "out.meshb", "size": 0.2}
        ...     job = server.run("adapt", arguments, {"in.meshb": geo_adapt.examples.cube(3)}).wait()
        ...     job.state, sorted(job.results)[:2], job.result("out.meshb").mesh().volume.__round__(12)
        ('done', ['out.meshb', 'out.names.json'], 1.0)
        """
        inputs = Inputs(self._transport)
        for name, given in (files or {}).items():
            inputs.put(name, given)
        return self._asked(command, arguments, inputs, label)

    def _asked(self, command: str, arguments: Mapping[str, Any] | Sequence[Any], inputs: Inputs, label: str = "") -> Job:
        request = {"command": command, "arguments": plain(arguments), "files": inputs.ids, "label": label}
        return Job(self._transport, self._transport.json("POST", "/v1/jobs", request))

    def _call(
        self,
        command: str,
        arguments: Mapping[str, Any],
        given: Mapping[str, tuple[Any, str] | None],
        *,
        check: bool = True,
        progress: Progress | None = None,
    ) -> Job:
        """Runs a command to its end. `given` are the arguments that name files, with what they are and what they are called where they have no name; a
        list of files for an argument of several."""
        inputs = Inputs(self._transport, [arguments[name] for name in _WRITTEN if isinstance(arguments.get(name), str)])
        named: dict[str, Any] = {}
        for name, one in given.items():
            if one is not None:
                what, usual = one
                named[name] = [inputs.add(part, usual) for part in what] if isinstance(what, _Several) else inputs.add(what, usual)
        options = {name.replace("_", "-"): value for name, value in arguments.items() if value is not None and value is not False}
        job = self._asked(command, {**named, **options}, inputs)
        try:
            return job.wait(progress=progress, check=check)
        except BaseException as error:
            if not job._is_over:
                error.job = job  # type: ignore[attr-defined]
                _cancelled(job)
            raise

    # The calls of the package.

    def Model(self, source: Source, labels: Mapping[str, Sequence[int]] | None = None) -> ServedModel:  # noqa: N802
        """Sends a CAD model to the service, which reads it: as `geo_adapt.Model`, with faces, edges, vertices and names.

        Parameters
        ----------
        source : path, bytes, File, Model, or an object of cadquery or build123d
            A file (.step, .stp, .iges, .igs, .brep, .egads); or a BREP's bytes.
        labels : mapping of str to sequence of int, optional
            Names of faces by their numbers from 1, beside those in the file.

        Returns
        -------
        ServedModel

        Raises
        ------
        ProgramError
            When it is no readable model, once its faces are asked for or it is used.

        Examples
        --------
        >>> import geo_adapt
        >>> with geo_adapt.examples.service() as url:
        ...     server = geo_adapt.connect(url)
        ...     model = server.Model(geo_adapt.examples.cylinder())
        ...     [face.kind for face in model.faces]
        ['cylinder', 'plane', 'plane']
        """
        sent = self.upload(source)
        known = {}
        if sent._beside:
            found = sent._beside[0].json()
            known = {kind: found[kind] for kind in ("triangles", "edges", "tetrahedra") if found.get(kind)}
        # Its names go with the model, which may get others.
        file = File(self._transport, sent._path, {"name": sent.name, "id": sent.id, "bytes": sent.size})
        model = ServedModel(self, file, known)
        if labels:
            model.name(labels)
        return model

    def bootstrap(
        self,
        model: Source,
        size: float | None = None,
        *,
        segments: float | None = None,
        feature_cells: float | None = None,
        complexity: float | None = None,
        far_field: str | None = None,
        symmetry: str | None = None,
        heal: float | bool | None = None,
        mesher: str | None = None,
        time_limit: float | None = None,
        progress: Progress | None = None,
    ) -> Mesh:
        """Makes the first mesh of a CAD model: as `geo_adapt.bootstrap`, which lists the parameters.

        Parameters
        ----------
        model : Model, path, bytes, File, or an object of cadquery or build123d
            A CAD model; or the file of a closed surface of triangles.
        size, segments, feature_cells, complexity, far_field, symmetry, heal, mesher, time_limit : optional
            As there.
        progress : callable, optional
            Is called with a `JobProgress`; it returns False to stop.

        Returns
        -------
        Mesh
            With the metric it was made for as the field "metric". Its `domain` is a model on the service.

        Raises
        ------
        ProgramError
            When the model cannot be meshed; the message says where.
        """
        options = {
            "size": size,
            "segments": segments,
            "feature-cells": feature_cells,
            "complexity": complexity,
            "far-field": far_field,
            "symmetry": symmetry,
            "heal": heal,
            "mesher": mesher,
            "time-limit": time_limit,
            "output": "mesh.meshb",
        }
        job = self._call("bootstrap", options, {"model": (model, "model.brep")}, progress=progress)
        mesh = _made(job, "mesh.meshb").mesh()
        metric = job.results.get("mesh.solb")
        if metric is not None:
            mesh.fields["metric"] = _shaped(metric.fields()[0].reshape(len(mesh.points), -1))
        if "mesh.brep" in job.results:
            mesh.domain = self.Model(job.results["mesh.brep"])
        return mesh

    def classify(self, mesh: MeshSource, model: Source, *, tolerance: float | None = None) -> Mesh:
        """Puts the boundary of a mesh on the entities of a CAD model: as `geo_adapt.classify`.

        Parameters
        ----------
        mesh : Mesh, path or File
            A mesh whose boundary points lie on the model.
        model : Model, path, bytes or File
            The model.
        tolerance : float, optional
            How far a point may be from it, in its units.

        Returns
        -------
        Mesh
            The same mesh, with the numbers of faces as references of its triangles, the model's names, and its place on the model.

        Raises
        ------
        ProgramError
            When the mesh does not fit the model; the message says where.
        """
        options = {"tolerance": tolerance, "output": "out.meshb"}
        job = self._call("classify", options, {"mesh": (mesh, "mesh.meshb"), "cad": (model, "model.brep")})
        found = _made(job, "out.meshb").mesh()
        found.fields = dict(mesh.fields) if isinstance(mesh, Mesh) else {}
        return found

    def adapt(
        self,
        mesh: MeshSource | Adaptation,
        metric: npt.ArrayLike | str | os.PathLike[str] | File,
        model: Source | None = None,
        complexity: float | None = None,
        vertices: float | None = None,
        freeze: Sequence[str | int] = (),
        progress: Progress | None = None,
        *,
        order: str | None = None,
        max_vertices: int | None = None,
        limit_chords: float | str | None = None,
        tolerance: float | None = None,
        normal_deviation: float | None = None,
        hausdorff: float | None = None,
        report: bool = True,
    ) -> Adaptation:
        """Adapts a mesh to a metric: as `geo_adapt.adapt`, which lists the parameters, and to the same mesh.

        Parameters
        ----------
        mesh : Mesh, path, File or Adaptation
            The mesh.
        metric : array_like, shape (n, 3, 3) or (n, 6); or path or File of a .sol or .solb
            At its points, symmetric and positive definite, in 1/length².
        model : Model, path, bytes or File, optional
            The CAD model that the boundary lies on. By default the mesh's own surface.
        complexity, vertices, freeze, order, max_vertices, limit_chords, tolerance, normal_deviation, hausdorff : optional
            As there.
        progress : callable, optional
            Is called with a `JobProgress` about every second; it returns False to stop.
        report : bool
            Whether the report is fetched.

        Returns
        -------
        Adaptation

        Raises
        ------
        InputError
            When arrays are of other shapes.
        ProgramError
            When the mesh, the metric or the model is not good; the message says where.
        KeyboardInterrupt
            After Ctrl-C, with the mesh so far, which is valid, in ``.partial`` where there is one; so does any exception of `progress`.

        Examples
        --------
        >>> import numpy as np, geo_adapt
        >>> mesh = geo_adapt.examples.cube(4)
        >>> m = geo_adapt.metric.isotropic(0.05 + 0.3 * mesh.points[:, 0])
        >>> with geo_adapt.examples.service() as url:
        ...     there = geo_adapt.connect(url).adapt(mesh, m, order="medit")
        >>> here = geo_adapt.adapt(mesh, m, order="medit")
        >>> bool((there.mesh.points == here.mesh.points).all())
        True
        """
        if complexity is not None and vertices is not None:
            raise InputError("give a complexity or a number of vertices, not both")
        options: dict[str, Any] = {
            "complexity": complexity,
            "vertices": vertices,
            "max-vertices": max_vertices,
            "limit-chords": limit_chords,
            "tolerance": tolerance,
            "normal-deviation": normal_deviation,
            "hausdorff": hausdorff,
            "freeze": [str(part) for part in ([freeze] if isinstance(freeze, (str, int)) else freeze)] or None,
            "report": "report.json" if report else None,
            "output": "out.meshb",
        }
        given = {
            "mesh": (mesh.job.result("out.meshb") if isinstance(mesh, Adaptation) else mesh, "mesh.meshb"),
            "metric": (_tensors(metric, order), "metric.solb"),
            "cad": None if model is None else (model, "model.brep"),
        }
        try:
            job = self._call("adapt", options, given, check=False, progress=progress)
        except BaseException as error:
            ended: Job | None = getattr(error, "job", None)
            if ended is not None and ended._is_over and "out.meshb" in ended.results:
                error.partial = Adaptation(ended)  # type: ignore[attr-defined]
            raise
        if "out.meshb" not in job.results:
            raise job._failure()
        return Adaptation(job)

    def transfer(
        self,
        old: MeshSource,
        values: npt.ArrayLike,
        new: MeshSource,
        *,
        conservative: bool | str = False,
        metric: bool = False,
        order: str | None = None,
    ) -> Floats:
        """Brings values from the points of one mesh to those of another: as `geo_adapt.transfer`.

        Parameters
        ----------
        old, new : Mesh, path or File
            The mesh that has the values, and the one that gets them.
        values : array_like, shape (n, ...)
            At the points of the old mesh.
        conservative : bool or {"mean", "mass"}
            Keeps the integral of each value, as there.
        metric : bool
            The values are a metric, and interpolated as one (METHOD.md, 1.2): shape (n, 3, 3), or (n, 6) with its order.
        order : {"medit", "voigt"}, optional
            Of such a metric.

        Returns
        -------
        ndarray, shape (m, ...)
            Of a metric (m, 6) in the order "medit".

        Raises
        ------
        InputError
            When there is not a row for each point.
        ProgramError
            When a tetrahedron is inverted, or a metric not positive definite.
        """
        if metric and conservative:
            raise InputError("a metric is not transferred conservatively: give one of the two")
        columns, shape = [packed(values, order)] if metric else [], (6,)
        if not metric:
            count = len(old.points) if isinstance(old, Mesh) else len(np.atleast_1d(np.asarray(values)))
            table, shape = rows(values, count, "values")
            columns = [np.ascontiguousarray(table[:, k]) for k in range(table.shape[1])]
        method = _method(conservative)
        options = {"metric": metric, "conservative": None if method == "linear" else method, "output": "out.solb"}
        given = {"old_mesh": (old, "old.meshb"), "old_fields": (columns, "old.solb"), "new_mesh": (new, "new.meshb")}
        found = _made(self._call("transfer", options, given), "out.solb").fields()
        return found[0] if metric else np.column_stack(found).reshape(len(found[0]), *shape)

    def inspect(
        self,
        mesh: MeshSource,
        metric: npt.ArrayLike | str | os.PathLike[str] | File | None = None,
        model: Source | None = None,
        *,
        order: str | None = None,
    ) -> dict[str, Any]:
        """Is it a good mesh: as `geo_adapt.inspect`.

        Parameters
        ----------
        mesh : Mesh, path or File
            The mesh.
        metric : array_like, shape (n, 3, 3) or (n, 6); or path or File, optional
            In which edges and shapes are measured; by default in space.
        model : Model, path, bytes or File, optional
            The CAD model that it should lie on.
        order : {"medit", "voigt"}, optional
            Of a metric of shape (n, 6).

        Returns
        -------
        dict
            "valid", "flaws", edge lengths, mean ratios, volume, counts, "worst_tet", "cad", as there.

        Raises
        ------
        ProgramError
            When the files cannot be read.
        """
        given = {
            "mesh": (mesh, "mesh.meshb"),
            "metric": None if metric is None else (_tensors(metric, order), "metric.solb"),
            "cad": None if model is None else (model, "model.brep"),
        }
        # A mesh that is not valid is an answer, not an error.
        job = self._call("inspect", {"report": "report.json"}, given, check=False)
        found: dict[str, Any] = _made(job, "report.json").json()
        return found

    def convert(
        self,
        source: Source,
        path: str | os.PathLike[str],
        *,
        fields: npt.ArrayLike | str | os.PathLike[str] | File | None = None,
        text: bool = False,
        plain: bool = False,
        scale: float | None = None,
        translate: Sequence[float] | None = None,
    ) -> Path:
        """Writes a mesh in another program's format: ``geo-adapt convert``.

        Parameters
        ----------
        source : Mesh, path or File
            The mesh.
        path : path
            The file that is to be written, here; its ending tells the format. What belongs to it comes beside it.
        fields : array_like, path or File, optional
            Fields at its points.
        text, plain : bool
            As the program's options.
        scale : float, optional
            A factor of all coordinates.
        translate : sequence of three floats, optional
            A shift, length.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        ProgramError
            When the mesh cannot be read, or the format cannot carry it.
        """
        target = Path(path)
        options = {
            "output": f"converted{target.suffix}",
            "text": text,
            "plain": plain,
            "scale": scale,
            "translate": None if translate is None else ",".join(f"{float(x)!r}" for x in translate),
        }
        usual = "mesh.vtu" if isinstance(source, Mesh) and source.fields and fields is None else "mesh.meshb"
        given = {"input": (source, usual), "fields": None if fields is None else (fields, "fields.solb")}
        job = self._call("convert", options, given)
        _made(job, f"converted{target.suffix}")
        for name, file in job.results.items():
            if name.startswith("converted."):
                file.save(target.with_name(target.stem + name.removeprefix("converted")))
        return target

    def view(self, mesh: MeshSource, field: str | None = None, **options: object) -> Any:
        """Shows a mesh: in a notebook as a page within it, elsewhere in the browser: as `Mesh.view`, which lists the parameters."""
        return _shown(lambda page: self.write_page(mesh, page, field, **options))

    def write_page(self, mesh: MeshSource, path: str | os.PathLike[str], field: str | None = None, **options: object) -> None:
        """Writes a page for the browser (.html), or a picture (.png), of a mesh: as `Mesh.write_page`.

        Parameters
        ----------
        mesh : Mesh, path or File
            The mesh; of a `Mesh` with its fields.
        path : path
            The file.
        field : str, optional
            The field to be coloured by.
        **options
            Those of ``geo-adapt view``, as there; `cad` is a model.

        Raises
        ------
        InputError
            When an option is not known.
        ProgramError
            When it cannot be written.
        """
        target = Path(path)
        is_picture = target.suffix.lower() == ".png"
        name, option = ("mesh.png", "png") if is_picture else ("mesh.html", "output")
        model = options.pop("cad", None)
        chosen = {"title": target.stem, "color": field, **options, option: name}
        given = {"mesh": (mesh, "mesh.vtu"), "cad": None if model is None else (model, "model.brep")}
        _made(self._call("view", chosen, given), name).save(target)

    def __repr__(self) -> str:
        return f"<geo_adapt.Server at {self.url}>"


class _Several(list[Any]):
    """Files for an argument that takes several."""


def _tensors(metric: Any, order: str | None) -> Any:
    """A metric as an array in the order of .sol files, or the file that it is."""
    return metric if isinstance(metric, (str, os.PathLike, File)) else packed(metric, order)


def _usual(given: Source) -> str:
    if isinstance(given, (Mesh, File)):
        return "mesh.meshb"
    module = type(given).__module__.split(".")[0]
    return "model.brep" if isinstance(given, (bytes, bytearray, memoryview)) or module in ("cadquery", "build123d") else "field.solb"


def _made(job: Job, name: str) -> File:
    """A file that a job must have made."""
    found = job.results.get(name)
    if found is None:
        raise job._failure()
    return found


def _cancelled(job: Job) -> None:
    """Asks a job to end, and waits for it as long as that may take."""
    try:
        job.cancel()
        job.wait(_PATIENCE, check=False)
    except Exception:
        # What went wrong before this is told.
        return


__all__ = ["Server", "connect"]
