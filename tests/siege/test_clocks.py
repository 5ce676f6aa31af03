"""A vehicle's computer whose clock is wrong works from its receiver's time."""

import contextlib
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from integration.test_buses import DBC, GROUP, TABLE, Sender, multicast_is_there
from lasting import MINUTES
from outlets import Talker, TcpOutlet
from street import VEHICLE, write_route
from wayline.bus import open_session
from wayline.messages import Pose
from wayline_cli.listener import Heard, Listener
from wayline_cli.local_system import LocalSystem, free_ports

SERVICES = ("gps-ingest", "can-ingest", "fusion", "eta")
LIBRARIES = [
    str(path) for path in Path("/usr/lib").glob("*/faketime/libfaketimeMT.so.1") if path.is_file()
]
WAIT_S = 40.0
NOW_NS = 5e9

pytestmark = [
    pytest.mark.skipif(
        not LIBRARIES, reason="no libfaketime (Debian: apt-get install libfaketime)"
    ),
    pytest.mark.skipif(
        not multicast_is_there(), reason="no multicast: python-can's udp_multicast is the bus here"
    ),
]


@pytest.fixture
def hears(tmp_path: Path, clock: str) -> Iterator[Listener]:
    """What is heard of a vehicle whose services live by another clock."""
    with contextlib.ExitStack() as stack:
        outlet = TcpOutlet()
        stack.callback(outlet.close)
        stack.callback(Talker(outlet.write).close)
        sender = Sender(*free_ports(1))
        stack.callback(sender.close)
        system = stack.enter_context(
            LocalSystem(
                tmp_path,
                vehicle_id=VEHICLE,
                routes=[str(write_route(tmp_path / "street.geojson"))],
                database_url=f"sqlite:///{tmp_path / 'wayline.db'}",
            )
        )
        (tmp_path / "wheels.dbc").write_text(DBC)
        with system.config.open("a") as config:
            config.write(f'[[nmea]]\nurl = "tcp://127.0.0.1:{outlet.port}"\n')
            config.write(TABLE.format(group=GROUP, port=sender.port))
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
        listener = Listener(session, VEHICLE, ("odometer", "pose", "health"))
        stack.callback(listener.close)
        listener.await_alive(*SERVICES, timeout_s=WAIT_S)
        yield listener
        assert all(system.is_running(service) for service in SERVICES)


LONG = pytest.mark.skipif(not MINUTES, reason="long: scripts/siege time")


def is_of_now(heard: Heard) -> bool:
    """Whether a message has the true time."""
    return abs(heard.message.t_ns - time.time_ns()) < NOW_NS


def has_wheels(heard: Heard) -> bool:
    """Whether a pose of now comes of the wheels, which contradict this receiver that stands."""
    wheels = isinstance(heard.message, Pose) and heard.message.mode in {"fused", "dead_reckoning"}
    return wheels and is_of_now(heard)


@pytest.mark.parametrize(
    "clock",
    ["@1970-01-01 00:01:00", pytest.param("-1h", marks=LONG), pytest.param("+1h", marks=LONG)],
)
def test_poses_have_the_receivers_time_whatever_the_computers(hears: Listener, clock: str) -> None:
    heard = hears.await_message("pose", is_of_now, timeout_s=WAIT_S)
    assert heard.source == "fusion"
    if clock != "+1h":
        hears.await_message("odometer", is_of_now, timeout_s=WAIT_S)
        hears.await_message("pose", has_wheels, timeout_s=WAIT_S)
    health = hears.await_message("health", lambda each: each.source == "fusion", timeout_s=WAIT_S)
    assert abs(health.message.t_ns - time.time_ns()) > 3_000e9
