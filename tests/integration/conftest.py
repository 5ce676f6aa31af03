"""Real processes around a real router, for the tests that need them."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import zenoh

from street import VEHICLE, Receiver, write_route
from wayline.bus import open_session
from wayline.services import SERVICES
from wayline_cli.listener import Listener
from wayline_cli.local_system import LocalSystem

START_S = 40.0
"""Six Pythons that start at once on two busy cores."""
HEARD = ("gps_fix", "pose", "fusion_status", "progress", "arrivals", "horizon", "health")


def make_system(folder: Path, **options: object) -> LocalSystem:
    """A vehicle on its street: nothing runs yet."""
    return LocalSystem(
        folder,
        vehicle_id=VEHICLE,
        routes=[str(write_route(folder / "street.geojson"))],
        database_url=f"sqlite:///{folder / 'wayline.db'}",
        **options,
    )


@pytest.fixture
def live_system(tmp_path: Path) -> Iterator[Callable[..., LocalSystem]]:
    """Makes systems whose processes end with the test."""
    systems: list[LocalSystem] = []

    def make(**options: object) -> LocalSystem:
        folder = tmp_path / f"system-{len(systems)}"
        folder.mkdir()
        systems.append(make_system(folder, **options))
        return systems[-1]

    yield make
    for system in systems:
        system.close()


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LocalSystem]:
    """A router and all six services, alive, for the tests of a module that leave them so."""
    with make_system(tmp_path_factory.mktemp("running")) as system:
        system.start_router()
        for service in SERVICES:
            system.start(service)
        with open_session(system.bus) as session:
            listener = Listener(session, VEHICLE, [])
            listener.await_alive(*SERVICES, timeout_s=START_S)
            listener.close()
        yield system


@pytest.fixture
def session(running: LocalSystem) -> Iterator[zenoh.Session]:
    """A client of the running system."""
    with open_session(running.bus) as opened:
        yield opened


@pytest.fixture
def listener(session: zenoh.Session) -> Iterator[Listener]:
    """Hears what the running system says of its vehicle."""
    hears = Listener(session, VEHICLE, HEARD)
    yield hears
    hears.close()


@pytest.fixture(scope="module")
def receiver(running: LocalSystem) -> Iterator[Receiver]:
    """A vehicle of the running system that began two minutes ago."""
    with open_session(running.bus) as opened:
        sends = Receiver(opened, time.time_ns() // 10**9 * 10**9 - 120 * 10**9)
        yield sends
        sends.close()
