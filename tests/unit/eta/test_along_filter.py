"""How far along its route a vehicle is that reports seldom, on drives of known motion."""

from collections.abc import Sequence

import numpy as np
import pytest

from unit.eta.route_drives import SECOND_NS, SQUARE, Metres, route_of
from wayline_eta.along_filter import Along, AlongFilter
from wayline_eta.expected_motion import ExpectedMotion

LINE: list[Metres] = [(0, 0), (20_000, 0)]
STOPS_M = [500.0 * number for number in range(41)]


def bus(seed: int, *, pace: float = 1.0, dwells_s: tuple[float, float] = (20.0, 40.0)) -> list[int]:
    """Distance in metres at every second: 10 m/s from stop to stop, a dwell at each."""
    random, at_m, places_m = np.random.default_rng(seed), 0.0, []
    for stop_m in STOPS_M[1:]:
        while at_m < stop_m:
            at_m = min(at_m + 10.0 * pace, stop_m)
            places_m.append(at_m)
        places_m += [at_m] * round(random.uniform(*dwells_s))
    return [round(place_m) for place_m in places_m]


def followed(
    truth: Sequence[float], every_s: int, *, planned_s: float = 30.0, seed: int = 1
) -> list[Along]:
    """What is expected at every second, of a vehicle that is seen to 8 m every so often."""
    random = np.random.default_rng(seed)
    motion = ExpectedMotion(route_of(LINE, stops_m=STOPS_M, dwell_s=planned_s))
    along = AlongFilter(motion, 0, truth[0], 10.0, 0.0)
    told = []
    for second, place_m in enumerate(truth):
        if second % every_s == 0 and second:
            seen_m = place_m + random.normal(0.0, 8.0)
            along.report(second * SECOND_NS, seen_m, 8.0, moves=None)
        told.append(along.at(second * SECOND_NS))
    return told


@pytest.mark.parametrize(("every_s", "bar_m"), [(30, 60.0), (60, 120.0)])
@pytest.mark.parametrize("pace", [0.8, 0.95])
def test_a_city_bus_is_followed_between_its_reports(
    every_s: int, bar_m: float, pace: float
) -> None:
    """Stands of 20 to 40 s, slower than planned by as much as buses are: p95 along the route."""
    errors_m: list[float] = []
    for seed in (1, 2, 3):
        truth = bus(seed, pace=pace)
        told = followed(truth, every_s, seed=seed)
        errors_m += [abs(one.total_m - place_m) for one, place_m in zip(told, truth, strict=True)]
    assert np.quantile(errors_m, 0.95) < bar_m
    assert np.median(errors_m) < 20.0


def test_dwells_that_are_not_planned_are_learned() -> None:
    """30 s at each stop where the plan has none: expected at 20, then as they are."""
    truth = bus(1, dwells_s=(30.0, 30.0))
    errors_m = [
        abs(one.total_m - place_m)
        for one, place_m in zip(followed(truth, 30, planned_s=0.0), truth, strict=True)
    ]
    later = errors_m[len(errors_m) // 2 :]
    assert np.quantile(later, 0.95) < 60.0


def test_its_std_is_honest() -> None:
    truth = bus(4)
    told = followed(truth, 30)
    sigmas = [abs(a.total_m - m) / max(a.std_m, 5.0) for a, m in zip(told, truth, strict=True)]
    assert np.mean(np.array(sigmas) <= 2.0) > 0.85


def test_a_vehicle_that_stands_between_stops_is_left_where_it_stands() -> None:
    """And the longer it has stood, the longer it is expected to."""
    motion = ExpectedMotion(route_of(LINE, stops_m=STOPS_M, dwell_s=30.0))
    along = AlongFilter(motion, 0, 700.0, 10.0, 0.0)
    told = {}
    for second in range(631):
        if second % 30 == 0 and second:
            along.report(second * SECOND_NS, 750.0, 10.0, moves=None)
        told[second] = along.at(second * SECOND_NS)
    assert all(abs(told[second].total_m - 750.0) < 25.0 for second in range(200, 631))
    assert told[600].stood_s > 200.0
    assert told[600].stand.left_s > told[120].stand.left_s > 0.0


def test_a_report_far_from_all_that_was_expected_is_believed() -> None:
    motion = ExpectedMotion(route_of(LINE, stops_m=STOPS_M, dwell_s=30.0))
    along = AlongFilter(motion, 0, 700.0, 10.0, 0.0)
    along.report(30 * SECOND_NS, 9_750.0, 10.0, moves=None)
    assert along.at(30 * SECOND_NS).total_m == pytest.approx(9_750.0, abs=20.0)


def test_told_speeds_say_whether_it_stands() -> None:
    """At a stop, where it would be taken to stand as often as not."""
    motion = ExpectedMotion(route_of(LINE, stops_m=STOPS_M, dwell_s=30.0))
    moving, standing = (AlongFilter(motion, 0, 300.0, 10.0, 0.0) for _ in range(2))
    moving.report(20 * SECOND_NS, 525.0, 10.0, moves=True)
    standing.report(20 * SECOND_NS, 510.0, 10.0, moves=False)
    assert moving.at(25 * SECOND_NS).total_m > 540.0
    assert standing.at(25 * SECOND_NS).total_m == pytest.approx(500.0, abs=5.0)
    assert standing.at(25 * SECOND_NS).stand.left_s > 0.0


def test_it_goes_on_over_the_laps_of_a_loop() -> None:
    motion = ExpectedMotion(route_of(SQUARE, stops_m=[0.0, 1000.0], dwell_s=10.0))
    along = AlongFilter(motion, 0, 1_500.0, 10.0, 0.0)
    assert along.at(100 * SECOND_NS).total_m == pytest.approx(2_400.0, abs=120.0)


def test_an_open_route_is_not_left_behind_its_end() -> None:
    motion = ExpectedMotion(route_of(LINE, stops_m=STOPS_M, dwell_s=30.0))
    along = AlongFilter(motion, 0, 19_900.0, 10.0, 0.0)
    ended = along.at(300 * SECOND_NS)
    assert ended.total_m == pytest.approx(20_000.0, abs=0.1)
    assert ended.speed_mps == ended.stand.late_s == 0.0


def test_it_is_the_same_whatever_was_asked_between() -> None:
    """Nothing is left to chance, and asking twice for an instant changes nothing."""
    motion = ExpectedMotion(route_of(LINE, stops_m=STOPS_M, dwell_s=30.0))
    twins = [AlongFilter(motion, 0, 700.0, 10.0, 0.0) for _ in range(2)]
    for second in range(1, 30):
        assert twins[0].at(second * SECOND_NS) == twins[1].at(second * SECOND_NS)
    assert twins[0].at(29 * SECOND_NS) == twins[0].at(29 * SECOND_NS)
