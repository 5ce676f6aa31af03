"""Poison under a vehicle's own keys: nothing else notices, not even after a restart."""

import itertools
import time

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from besieged import Besieged, Bus
from lasting import lasting_s
from poison import NOT_UTF8, PAYLOADS, damaged
from street import VEHICLE
from wayline.messages import TOPICS

EVIL = "mallory"
PACE_S = 0.005


SAID = st.sampled_from(list(TOPICS)).flatmap(
    lambda topic: st.tuples(st.just(topic), damaged(topic))
)


ATTACK = settings(
    max_examples=150,
    database=None,
    deadline=None,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)


def attack(besieged: Besieged) -> None:
    """Some damaged payloads of all topics, of two vehicles."""
    vehicles = itertools.cycle((EVIL, "eve"))

    @ATTACK
    @given(SAID)
    def put(said: tuple[str, bytes]) -> None:
        topic, payload = said
        besieged.put_payload(payload, topic, next(vehicles))
        time.sleep(PACE_S)

    put()


def test_poison_of_one_vehicle_is_noticed_by_nobody_else(besieged: Besieged, bus: Bus) -> None:
    bad_before = {service: besieged.health(service).bad_input for service in besieged.services}
    for topic, payload in itertools.product(TOPICS, PAYLOADS.values()):
        besieged.put_payload(payload, topic, EVIL)
        # deep payloads are long
        time.sleep(PACE_S)
    for topic, payload in NOT_UTF8.items():
        besieged.put_payload(payload, topic, EVIL)
    ends_s = time.monotonic() + lasting_s(1.0)
    while time.monotonic() < ends_s:
        attack(besieged)
        besieged.assert_stands()
    assert_all_goes_on(besieged, bus)
    for service, before in bad_before.items():
        assert besieged.health(service).bad_input > before + 10
    # the bus keeps the last value of slow topics for whoever comes later
    for service in besieged.services if lasting_s(0.0) else ("eta",):
        besieged.restart(service)
    bus.await_known()
    assert_all_goes_on(besieged, bus)


def assert_all_goes_on(besieged: Besieged, bus: Bus) -> None:
    """The honest bus is answered for, and so are all vehicles together."""
    bus.await_known()
    besieged.assert_stands()
    names = [each["vehicle_id"] for each in besieged.get("eta", "/v1/vehicles")["vehicles"]]
    assert VEHICLE in names
    arrivals = besieged.get("eta", f"/v1/vehicles/{VEHICLE}/arrivals")["arrivals"]
    assert arrivals
    assert not arrivals[0]["stale"]
    view = besieged.get("dashboard", "/v1/view")
    assert VEHICLE in [each["vehicle_id"] for each in view["vehicles"]]
    besieged.get("slope-map", f"/v1/vehicles/{VEHICLE}/lookahead")
