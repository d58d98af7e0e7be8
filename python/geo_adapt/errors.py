"""The exceptions of the package. All are of the class `Error`, and say what is wrong, where, and the remedy."""

from ._kernel import Error, FileError, InputError, MeshError, MetricError, ModelError

__all__ = ["Error", "FileError", "InputError", "MeshError", "MetricError", "ModelError", "ProgramError"]


class ProgramError(Error):
    """The program that does the work in a process of its own ended with an error.

    Attributes
    ----------
    code : int
        Its exit code: 2 for bad input, 3 for the end of memory; negative for a signal.
    """

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code
