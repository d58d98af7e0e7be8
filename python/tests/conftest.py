"""What the tests share: a cylinder, its mesh, and the program run as from a shell."""

import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import geo_adapt
import pytest


@pytest.fixture(autouse=True, scope="session")
def ctrl_c() -> Iterator[None]:
    """What a shell starts in the background ignores SIGINT, and Python with it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="session")
def step() -> Path:
    return Path(__file__).parents[2] / "geometry" / "cylinder.step"


@pytest.fixture(scope="session")
def model(step: Path) -> geo_adapt.Model:
    return geo_adapt.Model(step)


@pytest.fixture(scope="session")
def url() -> Iterator[str]:
    """A service of this program, with all that is default."""
    if subprocess.run([geo_adapt.program.PATH, "serve", "--help"], capture_output=True, check=False).returncode != 0:
        pytest.skip("the program has no `serve`")
    with geo_adapt.examples.service() as url:
        yield url


@pytest.fixture(scope="session")
def server(url: str) -> geo_adapt.Server:
    return geo_adapt.connect(url)


@pytest.fixture(scope="session")
def mesh(model: geo_adapt.Model) -> geo_adapt.Mesh:
    return geo_adapt.bootstrap(model)


@pytest.fixture
def typed(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs the program in a folder of its own, as typed."""

    def run(*words: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [geo_adapt.program.PATH, *map(str, words)], cwd=tmp_path, check=True, capture_output=True, text=True
        )

    return run
