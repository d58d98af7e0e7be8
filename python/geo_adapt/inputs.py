"""What goes up to a service with a job: meshes, fields and models as files, each with a name of its own."""

from __future__ import annotations

import copy
import io
import os
import re
import warnings
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, BinaryIO, Union

import numpy as np
import numpy.typing as npt

from . import program
from .errors import FileError, InputError
from .jobs import File
from .mesh import Mesh, write_sol
from .model import SUFFIXES, Model, _brep
from .tensors import Floats
from .transport import Transport, digest_of

#: What may be given as a file.
Source = Union[Mesh, Model, File, str, "os.PathLike[str]", bytes, bytearray, memoryview, npt.ArrayLike]

_MESHB = (".mesh", ".meshb")


class Inputs:
    """The files of a job that is to be asked for, by their names.

    Names that begin as one of `written` are for what the job writes. What a job has made is there, but is no upload: where one is wanted it is
    sent all the same.
    """

    def __init__(self, transport: Transport, written: Collection[str] = (), are_uploads: bool = False) -> None:
        self._transport = transport
        self._written = {name.partition(".")[0] for name in written}
        self._are_uploads = are_uploads
        self.ids: dict[str, str] = {}

    def free(self, name: str) -> str:
        """A name like this that no file has yet, and that the service takes."""
        plain = re.sub(r"[^0-9A-Za-z._+()=,-]", "_", name).lstrip(".-")[-100:] or "file"
        stem, dot, ending = plain.partition(".")
        found, number = plain, 2
        while found in self.ids or found.partition(".")[0] in self._written:
            found, number = f"{stem}-{number}{dot}{ending}", number + 1
        return found

    def add(self, given: Source, usual: str) -> str:
        """Takes a file in: its name in the job. `usual` is that of what has no name of its own."""
        return self.put(self.free(_called(given, usual)), given)

    def put(self, name: str, given: Source) -> str:
        """Takes a file in under a name."""
        if isinstance(given, File):
            self.ids[name] = given.id
            for other in given._beside:
                self.ids.setdefault(_beside(name, other.name.removeprefix(given.name) == ".names.json"), other.id)
            return name
        if isinstance(given, Model):
            file, labels = given._for_service()
            self.put(name, file)
            if labels is not None:
                self.ids[f"{name}.names.json"] = self.send(io.BytesIO(labels), f"{name}.names.json")
            return name
        if isinstance(given, (str, os.PathLike)):
            self._put_path(name, Path(given))
            return name
        if isinstance(given, (bytes, bytearray, memoryview)):
            self.ids[name] = self.send(io.BytesIO(bytes(given)), name)
            return name
        with program.folder() as folder:
            path = Path(folder) / name
            if isinstance(given, Mesh):
                _write(given, path)
            elif type(given).__module__.split(".")[0] in ("cadquery", "build123d"):
                _brep(given, path)
            else:
                write_sol(path, *_columns(given, name))
            self._put_path(name, path)
        return name

    def _put_path(self, name: str, path: Path) -> None:
        """A file, and the one with its names beside it."""
        if path.is_dir():
            raise InputError(f"{path}: a folder cannot be sent; make one file of it with `geo-adapt convert`")
        try:
            with open(path, "rb") as file:
                self.ids[name] = self.send(file, name)
        except OSError as error:
            raise FileError(f"{path}: {error.strerror or error}") from None
        # part.names.json is that of a mesh, also of the BREP that is written with one; part.step.names.json that of a model.
        is_model = path.suffix.lower() in SUFFIXES and path.suffix.lower() != ".brep"
        places = [(True, Path(f"{path}.names.json")), *([] if is_model else [(False, path.with_suffix(".names.json"))])]
        for is_long, beside in places:
            if path.suffix and beside.is_file():
                target = _beside(name, is_long)
                if target not in self.ids:
                    with open(beside, "rb") as file:
                        self.ids[target] = self.send(file, target)
                return

    def send(self, file: BinaryIO, name: str) -> str:
        """The id of contents that the service has, now or since long."""
        digest = digest_of(file)
        is_made = digest in self._transport.made and not self._are_uploads
        if not is_made and not self._transport.has(digest):
            self._transport.upload(file, name)
        return digest


def _called(given: Source, usual: str) -> str:
    """What a file is called, where it has a name."""
    if isinstance(given, (File, Model)):
        return given.name if isinstance(given, File) else given.path.name
    if isinstance(given, (str, os.PathLike)):
        return Path(given).name
    return usual


def _beside(name: str, is_long: bool) -> str:
    """The names file of a file: the one of its whole name, or of its stem."""
    return f"{name}.names.json" if is_long else str(Path(name).with_suffix(".names.json"))


def _write(mesh: Mesh, path: Path) -> None:
    """Writes a mesh: in libMeshb's format without its fields, which go as files of their own."""
    bare = copy.copy(mesh)
    if path.suffix.lower() in _MESHB:
        bare.fields = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        bare.write(path)


def _columns(given: Any, name: str) -> list[Floats]:
    """Fields, of an array or of several."""
    if Path(name).suffix.lower() not in (".sol", ".solb"):
        raise InputError(f"{name}: an array goes to the service as .sol or .solb; give bytes, a path or a mesh for another format")
    several = isinstance(given, (list, tuple)) and len(given) > 0 and np.ndim(given[0]) > 0 and isinstance(given[0], np.ndarray)
    try:
        return [np.asarray(one, dtype=np.float64) for one in (given if several else [given])]
    except (TypeError, ValueError):
        raise InputError(f"{name}: {type(given).__name__} is no mesh, model, path, array or bytes") from None


def plain(value: object) -> Any:
    """A value as JSON has it: numpy's numbers as Python's, paths as text, infinity as the program reads it."""
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    if isinstance(value, (np.integer, np.floating, np.bool_)):
        value = value.item()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    if value is None or isinstance(value, (str, int, float)):
        return value
    raise InputError(f"arguments: {value!r} is neither text nor number")
