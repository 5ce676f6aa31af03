"""Every service of a vehicle dies again and again, and is back at work; `wayline up` starts it."""

import contextlib
import logging
import random
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from besieged import Besieged, await_true
from lasting import MINUTES
from outlets import Talker, TcpOutlet
from street import VEHICLE
from wayline.services import SERVICES

log = logging.getLogger(__name__)

TIMES = 20
LIFE_S = (0.2, 3.0)
"""Between a service's start and its death."""
BACK_S = 10.0

pytestmark = pytest.mark.skipif(
    not MINUTES, reason="long: scripts/siege kills; integration/test_faults.py kills each once"
)


@pytest.fixture
def vehicle(tmp_path: Path) -> Iterator[Besieged]:
    """A whole vehicle with a receiver; its CAN bus is silent."""
    with contextlib.ExitStack() as stack:
        outlet = TcpOutlet()
        stack.callback(outlet.close)
        stack.callback(Talker(outlet.write).close)
        besieged = Besieged(tmp_path, list(SERVICES), vehicle_id=VEHICLE)
        with besieged.system.config.open("a") as config:
            config.write(f'[[nmea]]\nurl = "tcp://127.0.0.1:{outlet.port}"\n')
            config.write('[[can]]\ninterface = "virtual"\nchannel = "siege"\ndbc = []\n')
        yield stack.enter_context(besieged)


def is_whole(besieged: Besieged) -> bool:
    """Whether every service but that of the silent bus lacks nothing."""
    return all(
        besieged.asked(service, "/readyz")[0] == 200
        for service in SERVICES
        if service != "can-ingest"
    )


@pytest.mark.parametrize("service", SERVICES)
def test_a_service_that_dies_twenty_times_is_back_each_time(
    vehicle: Besieged, service: str
) -> None:
    dice = random.Random(service)
    await_true(lambda: is_whole(vehicle), "all is well before")
    took_s = []
    for _ in range(TIMES):
        time.sleep(dice.uniform(*LIFE_S))
        killed_s = time.monotonic()
        vehicle.restart(service)
        await_true(lambda: is_whole(vehicle), f"all is well after {service} died", BACK_S)
        took_s.append(time.monotonic() - killed_s)
    log.info("%s: %d deaths, well again after at most %.1f s", service, TIMES, max(took_s))
    since_ns = time.time_ns()
    vehicle.await_later("pose", since_ns)
    vehicle.assert_stands()
