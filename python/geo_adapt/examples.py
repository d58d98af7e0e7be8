"""Small meshes and models for examples and tests, and a service on this machine."""

from __future__ import annotations

import itertools
import signal
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from . import program
from .errors import ProgramError
from .mesh import Mesh


def cube(n: int = 4) -> Mesh:
    """The unit cube of n³ cells, six tetrahedra each, about a diagonal (Kuhn).

    Parameters
    ----------
    n : int
        Cells along a side, at least 1.

    Returns
    -------
    Mesh
        Its sides are called "x=0", "x=1", …, of references 1 to 6.

    Examples
    --------
    >>> import geo_adapt
    >>> geo_adapt.examples.cube(2)
    <geo_adapt.Mesh: 27 points, 48 tetrahedra, 48 triangles, 6 named surfaces>
    """
    axis = np.arange(n + 1)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    steps = np.array([(n + 1) ** 2, n + 1, 1])
    corner = (np.stack(np.meshgrid(axis[:-1], axis[:-1], axis[:-1], indexing="ij"), axis=-1).reshape(-1, 3) @ steps)[:, None]
    tets = []
    for order in itertools.permutations(range(3)):
        path = np.concatenate([[0], np.cumsum(steps[list(order)])])
        # Odd permutations are mirrored.
        turned = path[[0, 2, 1, 3]] if np.linalg.det(np.eye(3)[list(order)]) < 0 else path
        tets.append(corner + turned)
    cells = np.concatenate(tets)
    points = grid / n
    faces = np.concatenate([cells[:, [1, 2, 3]], cells[:, [0, 3, 2]], cells[:, [0, 1, 3]], cells[:, [0, 2, 1]]])
    triangles, references, names = [], [], {}
    for number, (side, value) in enumerate(itertools.product(range(3), (0, n)), 1):
        on = faces[(grid[faces, side] == value).all(axis=1)]
        triangles.append(on)
        references.append(np.full(len(on), number, np.int32))
        names[f"{'xyz'[side]}={value // n}"] = [number]
    return Mesh(points, cells, np.concatenate(triangles), np.concatenate(references), names)


def cylinder() -> bytes:
    """The BREP of a cylinder of radius 1 and height 2 along z, for `Model`."""
    return (Path(__file__).parent / "data" / "cylinder.brep").read_bytes()


@contextmanager
def service(*options: str) -> Iterator[str]:
    """A service on this machine, on a free port and in a folder of its own, which ends and goes with the block.

    Parameters
    ----------
    *options : str
        Further ones of ``geo-adapt serve``: "--jobs=1".

    Yields
    ------
    str
        Its address, for `connect`.

    Raises
    ------
    ProgramError
        When it does not start, such as where the program has no ``serve``.

    Examples
    --------
    >>> import geo_adapt
    >>> with geo_adapt.examples.service() as url:
    ...     geo_adapt.connect(url).about()["owner"]
    'local'
    """
    with program.folder() as folder:
        place = [] if any(option.startswith("--data") for option in options) else ["--data", folder]
        words = [str(program.PATH), "serve", "--listen", "127.0.0.1:0", *place, *options]
        # A group of its own: Ctrl-C at the terminal is for this process, which ends it.
        with subprocess.Popen(words, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True) as process:
            assert process.stderr is not None
            said: list[str] = []
            url = None
            for line in process.stderr:
                said.append(line.decode(errors="replace"))
                if "listens at " in said[-1]:
                    url = said[-1].split("listens at ")[1].split(";")[0].strip()
                    break
            if url is None:
                process.wait()
                raise ProgramError(program.message("".join(said), process.returncode), process.returncode)
            # What it logs is read, lest it wait for that.
            reader = threading.Thread(target=process.stderr.read, daemon=True)
            reader.start()
            try:
                yield url
            finally:
                process.send_signal(signal.SIGTERM)
                try:
                    process.wait(20)
                except subprocess.TimeoutExpired:
                    process.kill()
                reader.join()
