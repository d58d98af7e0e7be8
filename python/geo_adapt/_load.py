"""Loads the library with its symbols for itself, whatever `sys.setdlopenflags` says: they are not for other packages."""

import os
import sys

_flags = sys.getdlopenflags()
sys.setdlopenflags(os.RTLD_NOW | os.RTLD_LOCAL)
try:
    from . import _kernel
finally:
    sys.setdlopenflags(_flags)

__all__ = ["_kernel"]
