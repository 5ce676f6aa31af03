"""What a vehicle did at the stops of its route, each once, seen and reckoned."""

from collections.abc import Iterable
from typing import Any

import pytest

from unit.eta.route_drives import SECOND_NS, SQUARE, Metres, route_of
from wayline.route import Route
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.stop_log import Happening, Seen, StopLog

LINE: list[Metres] = [(0, 0), (3000, 0)]
STOPS_M = [0.0, 500.0, 1000.0, 3000.0]

Told = tuple[str, int, Any, bool]


def told(happened: Iterable[Happening]) -> list[Told]:
    """Kind, stop, second, and whether it was reckoned."""
    return [
        (one.kind, one.stop, round(one.t_ns / SECOND_NS, 1), one.interpolated) for one in happened
    ]


def log_of(route: Route) -> StopLog:
    return StopLog(route, ExpectedMotion(route))


def seen(second: float, total_m: float, *, stands: bool = False, reported: bool = False) -> Seen:
    return Seen(round(second * SECOND_NS), total_m, stands, reported)


def after(log: StopLog, *sightings: Seen) -> list[Told]:
    return told(one for sighting in sightings for one in log.observe(sighting))


def drive(speeds_mps: list[float], from_m: float = 0.0) -> list[Seen]:
    at_m, sightings = from_m, []
    for second, speed_mps in enumerate(speeds_mps):
        sightings.append(seen(second, at_m, stands=speed_mps == 0.0))
        at_m += speed_mps
    return sightings


def test_a_stand_at_a_stop_is_an_arrival_and_a_departure() -> None:
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    happened = after(log, *drive([0.0] * 5 + [10.0] * 50 + [0.0] * 20 + [10.0] * 60))
    assert happened == [
        ("arrived", 0, 0.0, False),
        ("departed", 0, pytest.approx(5.0, abs=1.1), False),
        ("arrived", 1, 55.0, False),
        ("departed", 1, pytest.approx(75.0, abs=1.1), False),
        ("passed", 2, pytest.approx(125.0, abs=0.6), False),
    ]


def test_what_happened_before_the_first_sighting_is_not_told() -> None:
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    assert after(log, seen(0, 700.0), seen(1, 710.0)) == []


def test_passes_in_an_outage_are_reckoned_from_both_of_its_ends() -> None:
    """From 400 m to 1,100 m in 70 s by a plan of 10 m/s."""
    log = log_of(route_of(LINE, stops_m=STOPS_M, dwell_s=1.0))
    happened = after(log, seen(40, 400.0), seen(112, 1_100.0))
    assert happened == [
        ("passed", 1, pytest.approx(50.0, abs=0.5), True),
        ("passed", 2, pytest.approx(101.0, abs=0.5), True),
    ]


def test_a_stop_left_out_by_a_detour_is_skipped() -> None:
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    after(log, seen(40, 400.0))
    log.off_route()
    assert after(log, seen(100, 800.0), seen(101, 810.0)) == [("skipped", 1, 100.0, True)]


def test_a_vehicle_put_elsewhere_has_served_nothing_between() -> None:
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    assert after(log, seen(40, 400.0), seen(41, 2_900.0)) == [
        ("skipped", 1, 41.0, True),
        ("skipped", 2, 41.0, True),
    ]


def test_the_end_of_a_trip_that_turned_short_is_left_out_once() -> None:
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    after(log, seen(40, 700.0))
    assert told(log.finish(60 * SECOND_NS)) == [
        ("skipped", 2, 60.0, True),
        ("skipped", 3, 60.0, True),
    ]
    assert log.finish(61 * SECOND_NS) == []


def test_reports_arrive_when_the_vehicle_is_thought_to_have_come() -> None:
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    standing = Seen(70 * SECOND_NS, 505.0, stands=True, reported=True, stood_s=12.0)
    happened = after(log, seen(40, 350.0, reported=True), standing)
    assert happened == [("arrived", 1, 58.0, True)]
    [departed] = after(log, seen(100, 700.0, reported=True))
    assert departed == ("departed", 1, pytest.approx(84.0, abs=4.1), True)


def test_a_vehicle_that_stands_a_little_behind_a_stop_has_arrived_there() -> None:
    """Drivers stop metres beyond the pole, and places err by metres."""
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    slowing = [seen(50, 490.0), seen(51, 497.0), seen(52, 502.0)]
    standing = [seen(second, 504.0, stands=True) for second in range(53, 73)]
    assert after(log, *slowing, *standing, seen(73, 508.0), seen(75, 520.0)) == [
        ("arrived", 1, 53.0, False),
        ("departed", 1, pytest.approx(73.5, abs=0.6), False),
    ]


def test_a_stop_is_passed_when_its_place_was_though_it_is_told_soon_after() -> None:
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    assert after(log, seen(50, 490.0), seen(51, 502.0)) == []
    assert after(log, seen(52, 514.0)) == [("passed", 1, pytest.approx(50.8, abs=0.1), False)]
    after(log, seen(93, 990.0), seen(94, 1001.0))
    assert told(log.finish(95 * SECOND_NS)) == [
        ("passed", 2, pytest.approx(93.9, abs=0.1), False),
        ("skipped", 3, 95.0, True),
    ]


def test_noise_at_a_stop_is_no_second_arrival() -> None:
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    creeping = [seen(10 + at, 498.0 + at % 3, stands=at % 2 == 0) for at in range(20)]
    assert after(log, seen(9, 490.0), *creeping) == [("arrived", 1, 10.0, False)]


def test_two_bays_are_arrived_at_together_and_left_once() -> None:
    log = log_of(route_of(LINE, stops_m=[0.0, 500.0, 506.0, 3000.0]))
    happened = after(log, seen(45, 450.0), seen(50, 501.0, stands=True), seen(70, 560.0))
    assert [each[:2] for each in happened] == [("arrived", 1), ("arrived", 2), ("departed", 2)]


def test_the_laps_of_a_loop_have_their_own_events() -> None:
    log = log_of(route_of(SQUARE, stops_m=[0.0, 1000.0]))
    laps = [
        (one.kind, one.stop, one.lap)
        for sighting in drive([10.0] * 450, from_m=5.0)
        for one in log.observe(sighting)
    ]
    assert laps == [("passed", 1, 0), ("passed", 0, 1), ("passed", 1, 1), ("passed", 0, 2)]


def test_a_new_trip_on_the_line_begins_anew() -> None:
    log = log_of(route_of(LINE, stops_m=STOPS_M))
    first = after(log, *drive([10.0] * 305))
    again = [seen(900 + at, 10.0 * at - 5.0) for at in range(60)]
    assert [each[:2] for each in after(log, *again)] == [("passed", 0), ("passed", 1)]
    assert [each[1] for each in first] == [0, 1, 2, 3][-len(first) :]
