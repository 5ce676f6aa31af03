"""When each vehicle of a fleet speaks; what the bare listeners answer; no speed is asserted."""

from collections import Counter
from itertools import pairwise

import pytest

from wayline.keys import message_key
from wayline_bench.fleet_bare import BareListener, Part
from wayline_bench.fleet_costs import Costs, core_shares
from wayline_bench.fleet_feeder import turns


def test_every_vehicle_speaks_once_a_tick_spread_evenly() -> None:
    spoken = list(turns(4, 3, arriving=False))
    assert Counter(turn.number for turn in spoken) == dict.fromkeys(range(4), 3)
    assert [turn.at_ticks for turn in spoken] == [quarter / 4 for quarter in range(12)]


def test_vehicles_arrive_one_after_another_and_stay() -> None:
    """So that no instant has to take in the whole fleet."""
    by_tick = [
        {turn.number for turn in turns(10, 5, arriving=True) if turn.tick == tick}
        for tick in range(5)
    ]
    assert [len(here) for here in by_tick] == [2, 4, 6, 8, 10]
    assert all(before < after for before, after in pairwise(by_tick))


def test_a_small_fleet_may_arrive_over_more_ticks_than_it_has_vehicles() -> None:
    last = [turn.number for turn in turns(3, 80, arriving=True) if turn.tick == 79]
    assert last == [0, 1, 2]


def test_a_bare_listener_counts_and_says_as_much_as_a_service() -> None:
    """Once a second of each vehicle, however often it tells its pose."""
    said: list[tuple[str, str, int]] = []
    listener = BareListener(
        Part(("pose", "gps_fix"), {"progress": 3, "arrivals": 5}, answers_every=2),
        lambda vehicle_id, topic, _, payload: said.append((vehicle_id, topic, len(payload))),
    )
    for vehicle_id in ("bus-1", "bus-1", "bus-2", "bus-1"):
        listener.take(message_key(vehicle_id, "pose", "fusion"))
    listener.take(message_key("bus-2", "gps_fix", "gps-ingest"))
    assert said == [("bus-1", "progress", 3), ("bus-1", "arrivals", 5)]
    assert listener.counts == {"pose": 4, "gps_fix": 1}


def test_core_shares_are_seconds_a_second() -> None:
    before = Costs({"router": 1.0, "eta": 2.0}, {})
    after = Costs({"router": 1.5, "eta": 2.0}, {})
    assert core_shares(before, after, 5.0) == pytest.approx({"router": 0.1, "eta": 0.0})
