"""Predictions from planned speeds and dwells."""

import pytest

from unit.eta.route_drives import SECOND_NS, SQUARE, START_NS, Metres, route_of
from wayline.messages import StopArrival
from wayline.route import Route
from wayline_eta.arrivals import Outlook, predict_visits, told_arrivals
from wayline_eta.lessons import as_planned
from wayline_eta.stands import Stand

LINE: list[Metres] = [(0, 0), (1000, 0), (3000, 0)]


def predicted(
    route: Route, total_m: float, *, std_m: float = 0.0, dwell_left_s: float = 0.0, age_s: int = 0
) -> list[StopArrival]:
    stand = Stand(dwell_left_s, dwell_left_s, dwell_left_s)
    outlook = Outlook(START_NS, total_m, total_m, std_m, stand)
    visits = predict_visits(as_planned(route), outlook, START_NS + age_s * SECOND_NS)
    return list(told_arrivals(route, visits))


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


def test_the_range_of_a_plan_that_nobody_drove_is_wide_far_away_and_narrow_near_by() -> None:
    line: list[Metres] = [(0, 0), (2200, 0)]
    route = route_of(line, stops_m=[2190.0])
    [far] = predicted(route, 0.0)
    late_s = seconds(far.late_ns) - seconds(far.arrival_ns)
    early_s = seconds(far.arrival_ns) - seconds(far.early_ns)
    assert 0.3 * 219.0 < early_s < late_s < 0.65 * 219.0
    [near] = predicted(route, 2180.0)
    assert seconds(near.late_ns) - seconds(near.arrival_ns) < 5.0


def test_an_uncertain_place_widens_the_range() -> None:
    route = route_of(LINE, stops_m=[600.0])
    [sure], [unsure] = predicted(route, 100.0), predicted(route, 100.0, std_m=100.0)
    assert sure.arrival_ns == unsure.arrival_ns
    assert unsure.early_ns < sure.early_ns < sure.late_ns < unsure.late_ns
    # 100 m at 10 m/s, beside what the plan may be off by
    plan_s, both_s = (seconds(each.late_ns) - 50.0 for each in (sure, unsure))
    assert both_s == pytest.approx((plan_s**2 + 12.8**2) ** 0.5, rel=0.15)


def test_what_an_old_outlook_puts_into_the_past_is_due_now() -> None:
    route = route_of(LINE, stops_m=[200.0, 2000.0])
    due, later = predicted(route, 100.0, age_s=60)
    assert due.early_ns == due.arrival_ns == due.late_ns == START_NS + 60 * SECOND_NS
    assert seconds(later.arrival_ns) == pytest.approx(190.0, abs=0.1)


def test_a_route_without_stops_has_no_arrivals() -> None:
    assert predicted(route_of(LINE), 100.0) == []
