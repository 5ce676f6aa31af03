"""Predictions from planned speeds and dwells."""

import pytest

from unit.eta.route_drives import SECOND_NS, SQUARE, START_NS, Metres, route_of
from wayline.messages import StopArrival
from wayline.route import Route
from wayline_eta.arrivals import Outlook, predict_arrivals
from wayline_eta.stands import Stand

LINE: list[Metres] = [(0, 0), (1000, 0), (3000, 0)]


def predicted(
    route: Route, total_m: float, *, std_m: float = 0.0, dwell_left_s: float = 0.0, age_s: int = 0
) -> list[StopArrival]:
    stand = Stand(dwell_left_s, dwell_left_s, dwell_left_s)
    outlook = Outlook(START_NS, total_m, total_m, std_m, stand)
    return list(predict_arrivals(route, outlook, START_NS + age_s * SECOND_NS))


def seconds(t_ns: int) -> float:
    return (t_ns - START_NS) / SECOND_NS


def test_travel_and_the_dwells_between_are_added_up() -> None:
    route = route_of(LINE, stops_m=[600.0, 1500.0, 2900.0], dwell_s=30.0)
    arrivals = predicted(route, 100.0)
    assert [seconds(a.arrival_ns) for a in arrivals] == pytest.approx([50, 170, 340], abs=0.01)
    assert [a.distance_m for a in arrivals] == pytest.approx([500, 1400, 2800], abs=0.1)
    arrivals = predicted(route, 600.1, dwell_left_s=12.0)
    assert [seconds(a.arrival_ns) for a in arrivals] == pytest.approx([102, 272], abs=0.1)


def test_a_loop_goes_on_into_the_next_lap_soonest_first() -> None:
    route = route_of(SQUARE, stops_m=[0.0, 600.0, 1500.0])
    arrivals = predicted(route, 2000.0 * 3 + 1000.0)
    assert [a.stop_id for a in arrivals] == ["s2", "s0", "s1"]
    assert [seconds(a.arrival_ns) for a in arrivals] == pytest.approx([50, 100, 160], abs=0.1)


def test_a_stop_that_the_route_serves_twice_appears_once_with_its_next_arrival() -> None:
    route = route_of(LINE, stops_m=[600.0, 1500.0])
    first, second = route.stops
    twice = Route(
        route_id="r",
        name="R",
        loop=False,
        line=route.line,
        speeds_mps=route.speeds_mps,
        stops=(first, second._replace(stop_id=first.stop_id)),
    )
    assert [a.distance_m for a in predicted(twice, 100.0)] == pytest.approx([500.0], abs=0.1)
    assert [a.distance_m for a in predicted(twice, 700.0)] == pytest.approx([800.0], abs=0.1)


def test_the_spread_is_that_of_the_published_trials() -> None:
    """27 s of standard deviation at 219 s from the end, 1.1 s near it (papers/000, table 3)."""
    line: list[Metres] = [(0, 0), (2200, 0)]
    route = route_of(line, stops_m=[2190.0])
    [far] = predicted(route, 0.0)
    assert seconds(far.late_ns) - seconds(far.arrival_ns) == pytest.approx(1.2816 * 27.2, abs=0.5)
    assert seconds(far.arrival_ns) - seconds(far.early_ns) == pytest.approx(1.2816 * 27.2, abs=0.5)
    [near] = predicted(route, 2180.0)
    assert seconds(near.late_ns) - seconds(near.arrival_ns) == pytest.approx(1.2816 * 1.1, abs=0.1)


def test_an_uncertain_place_widens_the_spread() -> None:
    route = route_of(LINE, stops_m=[600.0])
    [sure], [unsure] = predicted(route, 100.0), predicted(route, 100.0, std_m=100.0)
    assert sure.arrival_ns == unsure.arrival_ns
    # 7 s of the plan and 100 m at 10 m/s
    assert seconds(unsure.late_ns) == pytest.approx(50 + 1.2816 * (7**2 + 10**2) ** 0.5, abs=0.1)
    assert unsure.early_ns < sure.early_ns < sure.late_ns < unsure.late_ns


def test_what_an_old_outlook_puts_into_the_past_is_due_now() -> None:
    route = route_of(LINE, stops_m=[200.0, 2000.0])
    due, later = predicted(route, 100.0, age_s=60)
    assert due.early_ns == due.arrival_ns == due.late_ns == START_NS + 60 * SECOND_NS
    assert seconds(later.arrival_ns) == pytest.approx(190.0, abs=0.1)


def test_a_route_without_stops_has_no_arrivals() -> None:
    assert predicted(route_of(LINE), 100.0) == []
