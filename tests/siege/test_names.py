"""Made-up names of services, sources and vehicles: nobody's page swells by them."""

import contextlib
import urllib.request

import zenoh

from besieged import Besieged, Bus, await_true
from poison import NOW_NS
from wayline.bus import open_session
from wayline.codec import encode
from wayline.keys import FLEET, alive_key, message_key
from wayline.messages import Health

EVIL = "mallory"
NAMES = 5_000
SNAPSHOT_MAX_BYTES = 60_000


def snapshot_bytes(besieged: Besieged) -> int:
    url = f"{besieged.system.url('dashboard')}/v1/view"
    with urllib.request.urlopen(url, timeout=10) as answer:
        return len(answer.read())


def make_up(session: zenoh.Session, vehicle_id: str, number: int) -> None:
    """A service's health under a name of its own, and one name more within."""
    health = Health(
        t_ns=NOW_NS,
        service=f"inner-{number:0100}",
        version="0",
        started_ns=NOW_NS,
        detail="x" * 250,
    )
    session.put(message_key(vehicle_id, "health", f"made-up-{number}"), encode(health))
    session.put(message_key(vehicle_id, "health", "eta"), encode(health))


def test_five_thousand_names_do_not_swell_the_page(besieged: Besieged, bus: Bus) -> None:
    bad_input = besieged.health("dashboard").bad_input
    with open_session(besieged.system.bus) as session, contextlib.ExitStack() as stack:
        for number in range(NAMES):
            for vehicle_id in (EVIL, FLEET):
                make_up(session, vehicle_id, number)
            if number < 500:
                token = session.liveliness().declare_token(alive_key(EVIL, f"made-up-{number}"))
                stack.callback(token.undeclare)
        await_true(
            lambda: besieged.health("dashboard").bad_input >= bad_input + NAMES, "names refused"
        )
        bus.await_known()
        assert snapshot_bytes(besieged) < SNAPSHOT_MAX_BYTES
        view = besieged.get("dashboard", "/v1/view")
        shared = {each["service"] for each in view["services"]}
        assert shared >= {"eta", "slope-map", "dashboard"}
        assert len(shared) <= 16
    besieged.assert_stands()
