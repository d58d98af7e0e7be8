"""CAD models: read by OpenCASCADE in a process of its own, then at hand here."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _kernel, program
from .errors import InputError, ModelError
from .tensors import Floats

if TYPE_CHECKING:
    from .jobs import File

#: Endings of files with boundary representations.
SUFFIXES = (".step", ".stp", ".iges", ".igs", ".brep", ".egads")


@dataclass(frozen=True)
class Face:
    """A face of a model. Lengths are in the model's units; numbers count from 1.

    Attributes
    ----------
    number : int
        Its number, that of `TopExp::MapShapes` of OpenCASCADE. Triangles on it have it as their reference.
    kind : str
        Of its surface: "plane", "cylinder", "cone", "sphere", "torus", "bspline", ….
    center : ndarray, shape (3,)
        Centre of its area; on a curved face it lies beside it.
    point, normal : ndarray, shape (3,)
        A point of the face, and the unit normal there, out of the solid.
    area : float
        Its area.
    box : ndarray, shape (2, 3)
        Least and greatest corner of a box around it.
    name : str or None
        What it is called.
    edges : tuple of int
        Its edges.
    neighbours : tuple of int
        Faces beside it.
    """

    number: int
    kind: str
    center: Floats
    point: Floats
    normal: Floats
    area: float
    box: Floats
    name: str | None
    edges: tuple[int, ...]
    neighbours: tuple[int, ...]


@dataclass(frozen=True)
class Edge:
    """An edge of a model: its number, kind of curve, length, faces beside it, and vertices at its ends. All it lists is in `about`."""

    number: int
    kind: str
    name: str | None
    length: float | None
    faces: tuple[int, ...]
    vertices: tuple[int, ...]
    about: Mapping[str, Any]


@dataclass(frozen=True)
class Vertex:
    """A vertex of a model: its number, and its point, shape (3,)."""

    number: int
    point: Floats
    edges: tuple[int, ...]


class Closest(NamedTuple):
    """The nearest places of points on a model.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        The places.
    distances : ndarray, shape (n,)
        How far they are.
    faces : ndarray of int32, shape (n,)
        The faces that they are on, from 1.
    normals : ndarray, shape (n, 3)
        Unit normals there, out of the solid; zero where there is none (an apex).
    curvatures : ndarray, shape (n, 2)
        Principal curvatures there, in 1/length, the greater in size first.
    """

    points: Floats
    distances: Floats
    faces: npt.NDArray[np.int32]
    normals: Floats
    curvatures: Floats


def _brep(given: Any, path: Path) -> None:
    """Writes an object of cadquery or build123d as BREP, by its own OpenCASCADE: no pointer goes from kernel to kernel."""
    module = type(given).__module__.split(".")[0]
    if module == "cadquery":
        shape = given.combine().val() if hasattr(given, "vals") and len(given.vals()) > 1 else given
        shape = shape.val() if hasattr(shape, "val") else shape
        shape = shape.toCompound() if hasattr(shape, "toCompound") else shape
        shape.exportBrep(os.fspath(path))
    elif module == "build123d":
        shape = getattr(given, "part", given)
        __import__("build123d").export_brep(shape, os.fspath(path))
    else:
        raise InputError(f"model: {type(given).__name__} is no path, BREP bytes, nor an object of cadquery or build123d")
    if not path.is_file():
        raise ModelError(f"{type(given).__name__}: its kernel wrote no BREP")


class Model:
    """A CAD model.

    Parameters
    ----------
    source : path, bytes, or an object of cadquery or build123d
        A file (.step, .stp, .iges, .igs, .brep, .egads); or a BREP's bytes; or a `cadquery.Workplane`, `Shape` or `Assembly`, or a part or
        builder of build123d. Objects go through BREP bytes: their kernel and ours never meet.
    labels : mapping of str to sequence of int, optional
        Names of faces by their numbers from 1, beside those in the file.

    Attributes
    ----------
    path : Path
        The file that the program is given for this model.

    Raises
    ------
    ModelError
        When it is no readable model, also when OpenCASCADE crashes on it: it is read in a process of its own first.

    Notes
    -----
    Faces keep the order of `TopExp::MapShapes`; it is the same in the kernel of cadquery or build123d.

    Examples
    --------
    >>> import geo_adapt
    >>> model = geo_adapt.Model(geo_adapt.examples.cylinder())
    >>> [face.kind for face in model.faces]
    ['cylinder', 'plane', 'plane']
    >>> model.name({"wall": [1]})
    >>> model.faces[0].name, round(model.faces[0].area, 3)
    ('wall', 12.566)
    """

    def __init__(self, source: Any, labels: Mapping[str, Sequence[int]] | None = None) -> None:
        self._folder = program.folder()
        place = Path(self._folder.name)
        if isinstance(source, (str, os.PathLike)):
            given = Path(source)
            if given.suffix.lower() not in SUFFIXES:
                raise InputError(f"{given}: give a CAD model: {', '.join(SUFFIXES)}")
            if not given.is_file():
                raise ModelError(f"{given}: there is no such file")
            self.path = given.resolve()
            self._labels = _names_beside(given)
        else:
            self.path = place / "model.brep"
            self._labels = {}
            if isinstance(source, (bytes, bytearray, memoryview)):
                self.path.write_bytes(source)
            else:
                _brep(source, self.path)
        self._saved = place / "model.bin"
        program.read_model(self.path, self._saved, place / "answer.txt")
        self._load()
        if labels:
            self.name(labels)

    def _load(self) -> None:
        self._kernel = _kernel.Model(os.fspath(self._saved), json.dumps(self._labels))
        self._listed: dict[str, Any] | None = None

    def name(self, labels: Mapping[str, Sequence[int]]) -> None:
        """Gives faces names. Meshes that are made of the model or adapted on it have them.

        Parameters
        ----------
        labels : mapping of str to sequence of int
            ``{"inlet": [3], "wall": [1, 2]}``: numbers of faces, from 1.

        Raises
        ------
        InputError
            When a face is not there.
        """
        count = len(self.faces)
        faces = self._labels.setdefault("triangles", {})
        for called, numbers in labels.items():
            for number in numbers:
                if not 1 <= int(number) <= count:
                    raise InputError(f"{called!r}: face {number}: the model has the faces 1 to {count}")
                faces[str(int(number))] = {**faces.get(str(int(number)), {}), "name": str(called)}
        self._load()

    def _file(self, place: Path) -> Path:
        """A file of the model in a folder, with its names beside it, for the program."""
        if not self._labels:
            return self.path
        copy = place / f"model{self.path.suffix}"
        shutil.copyfile(self.path, copy)
        Path(f"{copy}.names.json").write_text(json.dumps(self._labels))
        return copy

    def _for_service(self) -> tuple[Path | File, bytes | None]:
        """What goes to a service: the file, or where it is there, and its names."""
        return self.path, json.dumps(self._labels).encode() if self._labels else None

    @property
    def _all(self) -> dict[str, Any]:
        if self._listed is None:
            with program.folder() as place:
                self._listed = json.loads(program.run(["model", self._file(Path(place)), "--json"]))
        return self._listed

    @property
    def faces(self) -> list[Face]:
        """Its faces, in their order: ``faces[0]`` is number 1."""
        return [
            Face(
                number=one["number"],
                kind=one["kind"],
                center=np.array(one["centre"], float),
                point=np.array(one["point"], float),
                normal=np.array(one["normal"], float),
                area=one["area"],
                box=np.array(one["bounds"], float),
                name=one["name"],
                edges=tuple(one["edges"]),
                neighbours=tuple(one["neighbours"]),
            )
            for one in self._all["faces"]
        ]

    @property
    def edges(self) -> list[Edge]:
        """Its edges."""
        return [
            Edge(
                number=one["number"],
                kind=one["kind"],
                name=one.get("name"),
                length=one.get("length"),
                faces=tuple(one["faces"]),
                vertices=tuple(v for v in one["vertices"] if v is not None),
                about=one,
            )
            for one in self._all["edges"]
        ]

    @property
    def vertices(self) -> list[Vertex]:
        """Its vertices."""
        return [
            Vertex(number=number, point=np.array(one["point"], float), edges=tuple(one["edges"]))
            for number, one in enumerate(self._all["vertices"], 1)
        ]

    @property
    def names(self) -> dict[str, list[int]]:
        """Names of faces, with their numbers from 1."""
        called: dict[str, list[int]] = {}
        for face in self.faces:
            if face.name:
                called.setdefault(face.name, []).append(face.number)
        return called

    @property
    def box(self) -> Floats:
        """Least and greatest corner of a box around it, shape (2, 3)."""
        return np.array(self._all["bounds"], float)

    @property
    def diagonal(self) -> float:
        """Length of the box's diagonal."""
        return float(self._all["diagonal"])

    def closest(self, points: npt.ArrayLike, face: int | None = None, threads: int | None = None) -> Closest:
        """The nearest places of points on the model's faces, with normals and curvatures there.

        Parameters
        ----------
        points : array_like, shape (n, 3)
            In the model's units.
        face : int, optional
            Looks on this face alone, from 1.
        threads : int, optional
            By default all cores.

        Returns
        -------
        Closest

        Raises
        ------
        InputError
            When points are of another shape or not finite, or the face is not there.

        Examples
        --------
        >>> import geo_adapt
        >>> model = geo_adapt.Model(geo_adapt.examples.cylinder())
        >>> near = model.closest([[3.0, 0.0, 1.0]])
        >>> near.points.round(9).tolist(), near.distances.round(9).tolist(), abs(near.curvatures).round(9).tolist()
        ([[1.0, 0.0, 1.0]], [2.0], [[1.0, 0.0]])
        """
        given = np.ascontiguousarray(points, dtype=np.float64)
        if given.ndim != 2 or given.shape[1] != 3:
            raise InputError(f"points: shape {given.shape}; give (n, 3)")
        return Closest(*self._kernel.closest(given, face, threads or 0))

    def write_brep(self, path: str | os.PathLike[str]) -> None:
        """Writes the model as a BREP of OpenCASCADE."""
        self._kernel.brep(os.fspath(path))

    def __repr__(self) -> str:
        return f"<geo_adapt.Model of {self.path.name}: {len(self.faces)} faces>"


def _names_beside(path: Path) -> dict[str, Any]:
    """The names file beside a model, which comes before the names in it."""
    for beside in (Path(f"{path}.names.json"), path.with_suffix(".names.json")):
        if beside.is_file():
            try:
                found = json.loads(beside.read_text(encoding="utf-8"))
            except ValueError as error:
                raise ModelError(f"{beside}: is no names file: {error}") from None
            return {kind: found[kind] for kind in ("triangles", "edges", "tetrahedra") if found.get(kind)}
    return {}
