"""A vehicle's computer whose clock is wrong works from its receiver's time."""

import contextlib
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from lasting import MINUTES
from outlets import Talker, TcpOutlet
from street import VEHICLE, write_route
from wayline.bus import open_session
from wayline_cli.listener import Listener
from wayline_cli.local_system import LocalSystem

SERVICES = ("gps-ingest", "fusion", "eta")
LIBRARIES = [
    str(path) for path in Path("/usr/lib").glob("*/faketime/libfaketimeMT.so.1") if path.is_file()
]
WAIT_S = 40.0

pytestmark = pytest.mark.skipif(
    not LIBRARIES, reason="no libfaketime (Debian: apt-get install libfaketime)"
)


@pytest.fixture
def hears(tmp_path: Path, clock: str) -> Iterator[Listener]:
    """What is heard of a vehicle whose services live by another clock."""
    with contextlib.ExitStack() as stack:
        outlet = TcpOutlet()
        stack.callback(outlet.close)
        stack.callback(Talker(outlet.write).close)
        system = stack.enter_context(
            LocalSystem(
                tmp_path,
                vehicle_id=VEHICLE,
                routes=[str(write_route(tmp_path / "street.geojson"))],
                database_url=f"sqlite:///{tmp_path / 'wayline.db'}",
            )
        )
        with system.config.open("a") as config:
            config.write(f'[[nmea]]\nurl = "tcp://127.0.0.1:{outlet.port}"\n')
        system.start_router()
        faked = (
            "env",
            f"LD_PRELOAD={LIBRARIES[0]}",
            f"FAKETIME={clock}",
            "FAKETIME_DONT_FAKE_MONOTONIC=1",
        )
        for service in SERVICES:
            command = (*system.command(service), "--config", str(system.config))
            system.start_command(service, (*faked, *command))
        session = stack.enter_context(open_session(system.bus))
        listener = Listener(session, VEHICLE, ("gps_fix", "pose", "health"))
        stack.callback(listener.close)
        listener.await_alive(*SERVICES, timeout_s=WAIT_S)
        yield listener
        assert all(system.is_running(service) for service in SERVICES)


LONG = pytest.mark.skipif(not MINUTES, reason="long: scripts/siege time")


@pytest.mark.parametrize(
    "clock",
    ["@1970-01-01 00:01:00", pytest.param("-1h", marks=LONG), pytest.param("+1h", marks=LONG)],
)
def test_poses_have_the_receivers_time_whatever_the_computers(hears: Listener, clock: str) -> None:
    heard = hears.await_message("pose", lambda each: each.message.t_ns > 0, timeout_s=WAIT_S)
    assert abs(heard.message.t_ns - time.time_ns()) < 5e9
    health = hears.await_message("health", lambda each: each.source == "fusion", timeout_s=WAIT_S)
    assert abs(health.message.t_ns - time.time_ns()) > 3_000e9
