"""The program `geo-adapt` in this package: on the PATH as a console script, and started for what only it does."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from .errors import ModelError, ProgramError

__all__ = ["PATH", "run"]

PATH = Path(__file__).parent / "bin" / "geo-adapt"
"""Where the program lies. It is linked with the OpenCASCADE libraries of this package."""

#: First argument of the process that reads a CAD model for another one.
_READ = "read-model-and-exit"


def main() -> None:
    """The console script: this process becomes the program."""
    os.execv(PATH, ["geo-adapt", *sys.argv[1:]])


def folder() -> tempfile.TemporaryDirectory[str]:
    """A private folder for files between this process and the program; it goes with the object."""
    return tempfile.TemporaryDirectory(prefix="geo-adapt-python-")


def options(**given: object) -> list[str]:
    """Options of the program, of what is not None: ``far_field="box:10"`` is ``--far-field=box:10``."""
    words: list[str] = []
    for name, value in given.items():
        if value is None or value is False:
            continue
        word = f"--{name.replace('_', '-')}"
        words.append(word if value is True else f"{word}={value}")
    return words


def run(arguments: Sequence[str | os.PathLike[str]]) -> str:
    """Runs the program and waits for it. Ctrl-C ends it too.

    Parameters
    ----------
    arguments : sequence of str or path
        What would be typed after ``geo-adapt``.

    Returns
    -------
    str
        What it printed on standard output.

    Raises
    ------
    ProgramError
        When it ends with an exit code other than 0, with its message.

    Examples
    --------
    >>> import geo_adapt
    >>> geo_adapt.program.run(["--version"]).split()[0]
    'geo-adapt'
    """
    command = [os.fspath(word) for word in (PATH, *arguments)]
    # A group of its own: a Ctrl-C at the terminal reaches this process alone, which hands it on and waits.
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, start_new_session=True
    ) as process:
        try:
            out, said = process.communicate()
        except BaseException:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(0.5)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
            raise
    if process.returncode != 0:
        raise ProgramError(message(said.decode(errors="replace"), process.returncode), process.returncode)
    return out.decode(errors="replace")


def message(said: str, code: int) -> str:
    """The error in what the program said on standard error."""
    mark = "geo-adapt: error: "
    if mark in said:
        return said[said.index(mark) + len(mark) :].strip()
    if code < 0:
        return f"the program was ended by signal {-code} ({signal.Signals(-code).name})"
    return said.strip() or f"the program ended with exit code {code}"


def read_model(path: Path, target: Path, answer: Path) -> None:
    """Has the program read a CAD model, in a process of its own, and save it in OpenCASCADE's binary form.

    A damaged file can crash OpenCASCADE or keep it for ever: neither harms this process. ``GEO_ADAPT_CAD_TIME_LIMIT`` is the
    time that it may take, s, by default 600.
    """
    given = os.environ.get("GEO_ADAPT_CAD_TIME_LIMIT") or "600"
    try:
        limit = float(given)
    except ValueError:
        raise ModelError(f"GEO_ADAPT_CAD_TIME_LIMIT={given}: give a positive number of seconds") from None
    try:
        done = subprocess.run(
            [PATH, _READ, answer, path, target],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            timeout=limit,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise ModelError(
            f"{path}: reading it took more than {limit:g} s and was ended: a damaged file can keep OpenCASCADE for ever; if it is "
            "just large, set GEO_ADAPT_CAD_TIME_LIMIT to more seconds"
        ) from None
    if done.returncode == 2 and answer.is_file():
        raise ModelError(f"{path}: {answer.read_text(errors='replace')}")
    if done.returncode == 3:
        raise ModelError(f"{path}: reading it takes more memory than there is: free some, or raise its limit (ulimit -v)")
    if done.returncode != 0:
        raise ModelError(
            f"{path}: is damaged: OpenCASCADE crashes on it; export it again from the program that made it"
        )
    if not target.is_file():
        raise ModelError(f"{path}: what was read could not be written to {target.parent}: free some room there")
