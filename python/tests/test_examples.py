"""The examples in the docstrings are true."""

import doctest
import importlib
import pkgutil

import pytest

import geo_adapt

NAMES = sorted(module.name for module in pkgutil.iter_modules(geo_adapt.__path__) if not module.name.startswith("_"))


@pytest.mark.parametrize("name", ["", *NAMES])
def test_examples(name, request):
    if name == "accessor":
        pytest.importorskip("pyvista")
    if name == "views":
        pytest.importorskip("meshio")
    if name in ("examples", "server", "server_metric"):
        # Their examples start the service.
        request.getfixturevalue("url")
    module = importlib.import_module(f"geo_adapt.{name}" if name else "geo_adapt")
    assert doctest.testmod(module).failed == 0


def test_all_that_is_public_has_an_example():
    """Functions and classes with parameters; what only holds values has none."""
    holders = {
        "Adaptation", "Closest", "Cycle", "Edge", "Face", "File", "Job", "JobProgress", "Parents", "Progress", "Result", "ServedModel", "Server",
        "ServerMetric", "Step", "Vertex",
    }
    for name in set(geo_adapt.__all__) - holders:
        thing = getattr(geo_adapt, name)
        if callable(thing) and not (isinstance(thing, type) and issubclass(thing, Exception)):
            assert thing.__doc__ and (">>>" in thing.__doc__ or name == "write_sol"), name
