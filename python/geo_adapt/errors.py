"""The exceptions of the package. All are of the class `Error`, and say what is wrong, where, and the remedy."""

from __future__ import annotations

from ._kernel import Error, FileError, InputError, MeshError, MetricError, ModelError

__all__ = ["Error", "FileError", "InputError", "MeshError", "MetricError", "ModelError", "ProgramError", "ServerError"]


class ProgramError(Error):
    """The program that does the work in a process of its own ended with an error.

    Attributes
    ----------
    code : int or None
        Its exit code: 2 for bad input, 3 for the end of memory; negative for a signal. None where a service has ended it.
    """

    def __init__(self, message: str, code: int | None) -> None:
        super().__init__(message)
        self.code = code


class ServerError(Error):
    """A service cannot be reached, or refuses.

    Attributes
    ----------
    status : int or None
        The status of HTTP: 401 and 403 for a token that is not good enough, 404 for what is not there, 429 for too much at once, 507 for no
        room. None where no answer came.
    """

    def __init__(self, message: str, status: int | None = None) -> None:
        super().__init__(message)
        self.status = status
