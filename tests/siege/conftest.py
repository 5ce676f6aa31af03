"""Real processes around a real router, and an honest vehicle that all must go on for."""

from collections.abc import Iterator

import pytest

from besieged import Besieged, Bus

SERVICES = ("fusion", "eta", "slope-map", "history", "dashboard")


@pytest.fixture(scope="session")
def besieged(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Besieged]:
    """The services of a fleet, for the tests that leave them alive."""
    with Besieged(tmp_path_factory.mktemp("besieged"), SERVICES) as system:
        yield system


@pytest.fixture
def bus(besieged: Besieged) -> Iterator[Bus]:
    """The honest vehicle on its way, known to all."""
    with Bus(besieged) as driving:
        driving.await_known()
        yield driving
