"""A whole agency in one gps-ingest: from its feed's address to each vehicle's key on the bus."""

import time
from collections.abc import Iterator

import pytest
import zenoh

from agency import AgencyServer, Answer, Bus, agency_server, payload_of
from loops import WAIT_S, Run
from wayline.errors import InputError
from wayline.live_sources import LiveAvl, LiveNmea
from wayline.messages import GpsFix
from wayline.settings import Settings
from wayline_cli.listener import Heard, Listener
from wayline_gps_ingest.__main__ import live


@pytest.fixture
def server() -> Iterator[AgencyServer]:
    with agency_server() as started:
        yield started


def test_an_agency_s_vehicles_come_onto_the_bus_each_under_its_key(
    server: AgencyServer, run: Run, session: zenoh.Session
) -> None:
    told_s = int(time.time())
    server.answer = lambda _: Answer(
        payload_of([Bus("Bus 1", told_s=told_s, trip_id="t1"), Bus("2", told_s=told_s)], told_s)
    )
    settings = Settings(vehicles=("*",), avl=(LiveAvl(url=server.url, every_s=1.0),))
    running = run(live(settings), settings)
    ears = {name: Listener(session, name, ["gps_fix"]) for name in ("bus-1", "2")}
    for ear in ears.values():
        ear.await_message("gps_fix", timeout_s=WAIT_S)
    health = running.await_health(lambda health: "2 vehicles" in (health.detail or ""))
    for ear in ears.values():
        ear.close()
    (first,) = ears["bus-1"].heard("gps_fix")
    assert isinstance(first, Heard)
    assert first.source == "gps-ingest"
    assert isinstance(first.message, GpsFix)
    assert (first.message.t_ns, first.message.assignment) == (told_s * 10**9, "t1")
    assert health.bad_input == 0
    assert running.home == "_fleet"


def test_a_receiver_needs_a_vehicle_to_ride_on() -> None:
    with pytest.raises(InputError, match="no vehicle is named"):
        live(Settings(vehicles=("*",), nmea=(LiveNmea(url="udp://:10110"),)))
