"""geo-adapt: anisotropic adaptation of tetrahedral meshes to a metric, on the real CAD model.

>>> import numpy as np, geo_adapt
>>> mesh = geo_adapt.examples.cube(6)
>>> u = np.tanh(20 * (mesh.points[:, 0] - 0.5))                  # stands for a solver's field
>>> m = geo_adapt.metric.multiscale(mesh, u, complexity=500)
>>> result = geo_adapt.adapt(mesh, m, order="medit")
>>> result.report["statistics"]["mean_ratios"]["min"] > 0.1
True

Node numbers count from 0 as in numpy; numbers of faces and references are those of files, where faces count from 1.
"""

from importlib.metadata import PackageNotFoundError as _NotFound
from importlib.metadata import version as _version

from . import _load as _load  # first
from . import errors, examples, metric, program
from .adapting import Adapter, Parents, Progress, Result, adapt
from .errors import Error, FileError, InputError, MeshError, MetricError, ModelError, ProgramError, ServerError
from .jobs import File, Job, JobProgress
from .looping import Cycle, Step, cycle
from .mesh import Mesh, read_sol, write_sol
from .model import Closest, Edge, Face, Model, Vertex
from .served import Adaptation, ServedModel
from .server import Server, connect
from .server_metric import ServerMetric
from .tensors import full, packed
from .work import bootstrap, classify, inspect, transfer

try:
    __version__ = _version("geo-adapt")
except _NotFound:  # from the sources
    __version__ = "0"

__all__ = [
    "Adaptation",
    "Adapter",
    "Closest",
    "Cycle",
    "Edge",
    "Error",
    "Face",
    "File",
    "FileError",
    "InputError",
    "Job",
    "JobProgress",
    "Mesh",
    "MeshError",
    "MetricError",
    "Model",
    "ModelError",
    "Parents",
    "ProgramError",
    "Progress",
    "Result",
    "ServedModel",
    "Server",
    "ServerError",
    "ServerMetric",
    "Step",
    "Vertex",
    "adapt",
    "bootstrap",
    "classify",
    "connect",
    "cycle",
    "errors",
    "examples",
    "full",
    "inspect",
    "metric",
    "packed",
    "program",
    "read_sol",
    "transfer",
    "write_sol",
]
