"""What the probes and the page say is so: who lacks what, since when, and when it is back."""

import contextlib
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from besieged import WAIT_S, Besieged, await_true
from outlets import Talker, TcpOutlet
from street import VEHICLE

BACK_S = 10.0
SERVICES = ("gps-ingest", "can-ingest", "fusion", "eta", "slope-map", "dashboard")


@pytest.fixture
def outlet() -> Iterator[TcpOutlet]:
    """A receiver that can be refused: closed until it is opened."""
    outlet = TcpOutlet()
    outlet.close()
    talker = Talker(outlet.write)
    yield outlet
    talker.close()
    with contextlib.suppress(OSError):
        outlet.close()


@pytest.fixture
def vehicle(tmp_path: Path, outlet: TcpOutlet) -> Iterator[Besieged]:
    """A whole vehicle whose receiver is refused and whose bus is silent."""
    besieged = Besieged(tmp_path, SERVICES, vehicle_id=VEHICLE)
    with besieged.system.config.open("a") as config:
        config.write(f'[[nmea]]\nurl = "tcp://127.0.0.1:{outlet.port}"\n')
        config.write('[[can]]\ninterface = "virtual"\nchannel = "siege"\ndbc = []\n')
    with besieged:
        yield besieged


def missing(besieged: Besieged, service: str) -> dict[str, str]:
    """What a service says that it lacks, by subject; the probes agree with each other."""
    alive = besieged.get(service, "/livez")
    assert alive["ok"]
    found: dict[str, str] = {}

    def is_agreed() -> bool:
        nonlocal found
        status, ready = besieged.asked(service, "/readyz")
        found = {each["subject"]: each["what"] for each in ready["missing"]}
        assert (status == 200) is ready["ok"] is (not found)
        for subject in found:
            assert f"{subject}: " in ready["detail"]
            assert " since 20" in ready["detail"]
        again, whole = besieged.asked(service, "/healthz")
        return bool(again == status and whole["missing"] == ready["missing"])

    await_true(is_agreed, "the same answer of /readyz and /healthz")
    return found


def shown(besieged: Besieged) -> dict[str, Any]:
    """The services on the page, with those of the vehicle."""
    view = besieged.get("dashboard", "/v1/view")
    own = [each for vehicle in view["vehicles"] for each in vehicle.get("services") or ()]
    return {each["service"]: each for each in [*view["services"], *own]}


def test_a_service_that_waits_for_its_router_answers_for_itself(tmp_path: Path) -> None:
    besieged = Besieged(tmp_path, ("eta",))
    with besieged.system as system:
        system.start("eta")
        system.await_said("eta", "waiting for a router", WAIT_S)
        assert besieged.get("eta", "/livez")["ok"]
        status, ready = besieged.asked("eta", "/readyz")
        assert (status, [each["subject"] for each in ready["missing"]]) == (503, ["router"])
        assert "no router at tcp/127.0.0.1" in ready["detail"]
        assert besieged.get("eta", "/v1/routes")["routes"]
        system.start_router()
        await_true(lambda: missing(besieged, "eta").keys() == {"input"}, "the bus is joined")


def test_refused_receivers_silent_buses_and_a_dead_router_are_told(
    vehicle: Besieged, outlet: TcpOutlet
) -> None:
    await_true(lambda: "gps-ingest" in missing(vehicle, "gps-ingest"), "the receiver is refused")
    assert "refused" in missing(vehicle, "gps-ingest")["gps-ingest"]
    assert "silent" in missing(vehicle, "can-ingest")["can-ingest"]
    for service in ("fusion", "eta", "slope-map", "dashboard"):
        lacks_input = partial(lacks_only, vehicle, service, "input")
        await_true(lacks_input, f"{service} lacks its input alone")
    await_true(
        lambda: (
            [each["subject"] for each in shown(vehicle)["gps-ingest"]["missing"]] == ["gps-ingest"]
        ),
        "the page says so",
    )
    outlet.open()
    await_ready(vehicle)
    vehicle.system.kill("router")
    for service in SERVICES:
        await_missing(vehicle, service, "router")
    vehicle.system.start_router()
    await_ready(vehicle)
    vehicle.assert_stands()


def lacks_only(besieged: Besieged, service: str, subject: str) -> bool:
    """Whether a service says that one thing is missing and nothing else; it may still start."""
    return missing(besieged, service).keys() == {subject}


def await_missing(besieged: Besieged, service: str, subject: str) -> None:
    """Wait until a service says that something is missing."""
    await_true(lambda: subject in missing(besieged, service), f"{service} lacks {subject}", BACK_S)


def is_ready(besieged: Besieged, service: str) -> bool:
    """Whether a service says that it lacks nothing."""
    return not missing(besieged, service)


def await_ready(besieged: Besieged) -> None:
    """Wait until every service but that of the silent bus is ready."""
    ended_s = time.monotonic()
    for service in SERVICES:
        if service != "can-ingest":
            await_true(partial(is_ready, besieged, service), f"{service} ready")
    assert time.monotonic() - ended_s < BACK_S
