"""What a service keeps: files, and jobs with what they have made."""

from __future__ import annotations

import io
import json
import math
import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

from . import program
from .errors import Error, InputError, ProgramError
from .mesh import Mesh, read_sol
from .tensors import Floats
from .transport import Transport

#: What the service gives of its own beside what a command has written.
_LOG, _PRINTED = "log.txt", "printed.txt"


class JobProgress(NamedTuple):
    """What a job is at.

    Attributes
    ----------
    pass_ : int
        Number of the adapter's pass, from 1; 0 before it is at work.
    operation : str
        "insertion", "collapse", "reconnection", "smoothing", "projection" or "repair"; "" before the adapter is at work.
    done, items : int
        How far the adaptation is, in thousandths.
    points : int
        Points of the mesh by now; 0 before the adapter is at work.
    expected : int
        Points that the mesh will have, nearly; 0 where that is not known.
    left : float or None
        Seconds that are left, nearly.
    state : str
        "queued" or "running".
    stage : str
        What the command does, where it says so: "reading wing.step".
    """

    pass_: int
    operation: str
    done: int
    items: int
    points: int
    expected: int
    left: float | None
    state: str
    stage: str


def _progress(told: dict[str, Any]) -> JobProgress:
    said = told.get("progress") or {}
    kind = said.get("kind")
    expected = said.get("vertices", 0) if kind == "forecast" else said.get("expected", 0)
    return JobProgress(
        pass_=int(said.get("pass", 0)),
        operation=str(said.get("operation", "")),
        done=round(1000 * min(max(said.get("share", 0.0), 0.0), 1.0)),
        items=1000,
        points=int(said.get("vertices", 0)) if kind == "pass" else 0,
        expected=round(expected),
        left=said.get("seconds") if kind == "forecast" else said.get("left"),
        state=str(told.get("state", "")),
        stage=str(said.get("what", "")),
    )


class File:
    """Contents that a service keeps: an upload, or what a job has made.

    It can be given wherever a mesh, a metric, a model or a file goes to the service: nothing is sent then.

    Attributes
    ----------
    name : str
        What it is called; its ending tells the format.
    id : str
        The SHA-256 of the contents, in hexadecimal digits.
    size : int
        Bytes.
    """

    def __init__(self, transport: Transport, path: str, told: dict[str, Any], beside: tuple[File, ...] = ()) -> None:
        self._transport = transport
        self._path = path
        self.name: str = told["name"]
        self.id: str = told["id"]
        self.size: int = told["bytes"]
        # Files with the names of its faces, in the same job.
        self._beside = beside

    def read(self) -> bytes:
        """The contents, checked.

        Raises
        ------
        ServerError
            When they do not come, or not as they were sent.
        """
        to = io.BytesIO()
        self._transport.download(self._path, self.id, to)
        return to.getvalue()

    def save(self, path: str | os.PathLike[str] = ".") -> Path:
        """Writes the contents to a file, which is there once all of it has come and was checked.

        Parameters
        ----------
        path : path
            A file, or a folder, in which it has its name.

        Returns
        -------
        Path
            The file.
        """
        target = Path(path)
        target = target / self.name if target.is_dir() else target
        part = target.with_name(f"{target.name}.part")
        try:
            with open(part, "wb") as to:
                self._transport.download(self._path, self.id, to)
            os.replace(part, target)
        finally:
            part.unlink(missing_ok=True)
        return target

    def text(self) -> str:
        """The contents as text."""
        return self.read().decode(errors="replace")

    def json(self) -> Any:
        """The contents as JSON: of a report."""
        return json.loads(self.read())

    def mesh(self) -> Mesh:
        """The contents as a mesh, with its names.

        Raises
        ------
        FileError
            When they are no mesh.
        """
        with program.folder() as place:
            path = self.save(place)
            for other in self._beside:
                other.save(place)
            return Mesh.read(path)

    def fields(self) -> list[Floats]:
        """The contents as fields: those of a .sol or .solb, as of `read_sol`.

        Raises
        ------
        FileError
            When they are no fields.
        """
        with program.folder() as place:
            return read_sol(self.save(place))

    def remove(self) -> None:
        """Has the service forget an upload. What a job has made goes with the job.

        Raises
        ------
        ServerError
            When it is no upload, or not there any more.
        """
        self._transport.ask("DELETE", f"/v1/files/{self.id}")

    def __repr__(self) -> str:
        return f"<geo_adapt.File {self.name}: {self.size} bytes, {self.id[:8]}…>"


class Job:
    """A command at work on a service, or at its end.

    Attributes
    ----------
    id : str
        What the service knows it by.
    command : str
        The command: "adapt", "metric multiscale", ….
    label : str
        What its owner calls it.
    request : dict
        What was asked for.
    """

    def __init__(self, transport: Transport, told: dict[str, Any]) -> None:
        self._transport = transport
        self._told = told
        self._results: dict[str, File] | None = None
        self.id: str = told["id"]
        self.command: str = told["command"]
        self.label: str = told["label"]
        self.request: dict[str, Any] = told["request"]

    @property
    def _is_over(self) -> bool:
        return self._told["state"] in ("done", "failed", "cancelled")

    def _asked(self) -> dict[str, Any]:
        if not self._is_over:
            self._told = self._transport.json("GET", f"/v1/jobs/{self.id}")
        return self._told

    @property
    def state(self) -> str:
        """How far it is now: "queued", "running", and at last "done", "failed" or "cancelled"."""
        return str(self._asked()["state"])

    @property
    def exit_code(self) -> int | None:
        """The exit code of the command; None until its end, and where the service has ended it."""
        found: int | None = self._asked()["exit_code"]
        return found

    @property
    def reason(self) -> str | None:
        """Why it failed; None where it did not."""
        found: str | None = self._asked()["reason"]
        return found

    @property
    def seconds(self) -> float | None:
        """How long it was at work, or has been until its end; None before it begins and while it is at work."""
        told = self._asked()
        if told["started"] is None or told["ended"] is None:
            return None
        return float(told["ended"] - told["started"]) / 1000.0

    def progress(self, timeout: float | None = None) -> Iterator[JobProgress]:
        """What it is at, as it goes on, until its end.

        Parameters
        ----------
        timeout : float, optional
            Seconds. By default there is no limit.

        Yields
        ------
        JobProgress

        Raises
        ------
        TimeoutError
            When it has not ended in time. It goes on.
        ServerError
            When the service does not answer any more.
        """
        if self._is_over:
            return
        until = math.inf if timeout is None else time.monotonic() + timeout
        for kind, told in self._transport.events(self.id, until):
            if kind == "late":
                raise TimeoutError(f"job {self.id} has not ended within {timeout:g} s")
            self._told = told
            if kind != "end":
                yield _progress(told)

    def wait(
        self,
        timeout: float | None = None,
        *,
        progress: Callable[[JobProgress], bool | None] | None = None,
        check: bool = True,
    ) -> Job:
        """Waits for its end.

        Parameters
        ----------
        timeout : float, optional
            Seconds. By default there is no limit.
        progress : callable, optional
            Is called with a `JobProgress` as it goes on; it returns False to cancel the job.
        check : bool
            Whether it is an error when the job has failed.

        Returns
        -------
        Job
            Itself, at its end.

        Raises
        ------
        ProgramError
            When it has failed, with the program's text.
        TimeoutError
            When it has not ended in time. It goes on.
        ServerError
            When the service does not answer any more.
        """
        for at in self.progress(timeout):
            if progress is not None and progress(at) is False:
                self.cancel()
                progress = None
        if check and self._told["state"] == "failed":
            raise self._failure()
        return self

    def _failure(self) -> Error:
        told = self._told
        if told["state"] == "cancelled":
            return ProgramError(f"the job {self.id} was cancelled", None)
        return ProgramError(told["reason"] or "the job has not made what it should", told["exit_code"])

    def cancel(self) -> None:
        """Asks it to end. An adaptation ends with its last valid mesh among its results."""
        self._transport.json("POST", f"/v1/jobs/{self.id}/cancel")

    def log(self) -> str:
        """What it has printed on standard error: the last of it while it is at work."""
        _, text = self._transport.ask("GET", f"/v1/jobs/{self.id}/log")
        return text.decode(errors="replace")

    @property
    def printed(self) -> str:
        """What it has printed on standard output, once it has ended: figures, JSON with "json"."""
        found = self.results.get(_PRINTED)
        return found.text() if found else ""

    @property
    def results(self) -> dict[str, File]:
        """What it has made, by the names of files, once it has ended; {} before.

        Raises
        ------
        ServerError
            When the service does not answer, or has forgotten the job.
        """
        if self._results is None:
            if not self.state or not self._is_over:
                return {}
            self._results = self._listed()
        return self._results

    def _listed(self) -> dict[str, File]:
        listed = self._transport.json("GET", f"/v1/jobs/{self.id}/results")
        files: dict[str, File] = {}
        for told in listed:
            files[told["name"]] = File(self._transport, f"/v1/jobs/{self.id}/results/{quote(told['name'], safe='')}", told)
        for name, file in files.items():
            if not name.endswith(".names.json"):
                named = (f"{name}.names.json", str(Path(name).with_suffix(".names.json")))
                file._beside = tuple(files[other] for other in named if other in files)
        # What was made need not be sent again.
        self._transport.made.update(told["id"] for told in listed)
        return files

    def result(self, name: str) -> File:
        """A file that it has made.

        Raises
        ------
        InputError
            When it has made none of this name.
        """
        found = self.results.get(name)
        if found is None:
            made = ", ".join(self.results) or "none"
            raise InputError(f"job {self.id} has made no {name!r}; there are: {made}")
        return found

    def save(self, folder: str | os.PathLike[str] = ".") -> list[Path]:
        """Writes all that it has made to a folder, but for its log and what it has printed.

        Parameters
        ----------
        folder : path
            The folder. It is made where it is not there.

        Returns
        -------
        list of Path
        """
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        return [file.save(place) for name, file in self.results.items() if name not in (_LOG, _PRINTED)]

    def remove(self) -> None:
        """Has the service forget it, with its results.

        Raises
        ------
        ServerError
            When it has not ended.
        """
        results = self._results if self._results is not None else self.results
        self._transport.ask("DELETE", f"/v1/jobs/{self.id}")
        self._transport.made.difference_update(file.id for file in results.values())

    def __repr__(self) -> str:
        return f"<geo_adapt.Job {self.id}: {self.command}, {self._told['state']}>"


__all__ = ["File", "Job", "JobProgress"]
