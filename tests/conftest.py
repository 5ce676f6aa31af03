"""What every test can ask for."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from postgres import Cluster, programs

settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    # chance does not decide whether a change is good; other runs explore
    settings.load_profile("ci")


@pytest.fixture
def recorded() -> Callable[[str], Path]:
    """A folder of recorded data, or skip with the reason."""

    def find(folder: str) -> Path:
        place = os.environ.get("WAYLINE_DATA")
        if not place:
            pytest.skip("WAYLINE_DATA: not set, recorded drives are not tested")
        path = Path(place) / folder
        if not path.is_dir():
            pytest.skip(f"WAYLINE_DATA: no folder {folder} in {place}")
        return path

    return find


@pytest.fixture(scope="session")
def postgres() -> Iterator[Cluster]:
    """A PostgreSQL of the tests' own, or skip with the reason."""
    found = programs()
    if found is None:
        pytest.skip("PostgreSQL: not installed (Debian: apt-get install postgresql)")
    cluster = Cluster(found)
    yield cluster
    cluster.close()


@pytest.fixture(params=["sqlite", "postgresql"])
def new_url(request: pytest.FixtureRequest, tmp_path: Path) -> Callable[[], str]:
    """Makes addresses of new, empty databases: what a store does it does on either kind."""
    if request.param == "sqlite":
        return lambda: f"sqlite:///{tmp_path / f'{len(list(tmp_path.iterdir()))}.db'}"
    cluster: Cluster = request.getfixturevalue("postgres")
    return cluster.new_url


@pytest.fixture
def database_url(new_url: Callable[[], str]) -> str:
    """The address of a new, empty database."""
    return new_url()
