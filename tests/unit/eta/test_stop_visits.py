"""Which stops have been arrived at: stood at within 10 m, else passed."""

import pytest

from unit.eta.route_drives import SECOND_NS, SQUARE, Metres, route_of
from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.stop_visits import StopVisits, next_visits_m

LINE: list[Metres] = [(0, 0), (1000, 0)]


def visits(route: Route, *seen: tuple[float, float]) -> StopVisits:
    """After distances and speeds, one a second."""
    followed = StopVisits(route, Tuning())
    for second, (total_m, speed_mps) in enumerate(seen):
        followed.observe(total_m, speed_mps, second * SECOND_NS)
    return followed


@pytest.mark.parametrize(
    ("seen", "served"),
    [
        ([(480.0, 5.0), (491.0, 5.0)], False),  # near, but moving
        ([(480.0, 5.0), (485.0, 0.0)], False),  # standing, but not near
        ([(480.0, 5.0), (491.0, 0.0)], True),
        ([(480.0, 5.0), (500.5, 5.0)], True),  # passed
        ([(490.0, 5.0), (501.5, 3.0)], False),  # behind it, where it may still stand
        ([(490.0, 5.0), (501.5, 3.0), (503.0, 0.0)], True),
        ([(490.0, 5.0), (501.5, 3.0), (508.0, 3.0)], True),  # it has not
        ([(480.0, 5.0), (491.0, 0.0), (489.0, 0.0), (493.0, 1.0)], True),  # once and for all
        ([(520.0, 5.0)], True),  # behind at the first sight
        ([(520.0, 5.0), (100.0, 5.0)], False),  # a new trip
    ],
)
def test_a_stop_is_served_once(seen: list[tuple[float, float]], served: bool) -> None:
    route = route_of(LINE, stops_m=[500.0])
    assert (visits(route, *seen).served_m >= route.stops[0].distance_m) is served


def test_the_next_visit_of_a_loop_is_on_the_next_lap() -> None:
    route = route_of(SQUARE, stops_m=[0.0, 700.0])
    assert next_visits_m(route, 650.0) == pytest.approx([2000.0, 700.0], abs=0.1)
    assert next_visits_m(route, 4700.5) == pytest.approx([6000.0, 6700.0], abs=0.5)
    assert next_visits_m(route, -4.0) == pytest.approx([0.0, 700.0], abs=0.1)


def test_a_stop_that_was_reached_on_any_lap_is_not_the_next_one() -> None:
    """Its place on the lap and the sum of all laps are rounded differently."""
    line: list[Metres] = [(0, 0), (703.1, 0), (703.1, 499.7), (0, 499.7), (0, 0)]
    route = route_of(line, stops_m=[237.9, 1850.3])
    for lap in range(40):
        reached_m = route.stop_distances_m + lap * route.length_m
        for stop, place_m in enumerate(reached_m):
            again_m = next_visits_m(route, float(place_m))[stop]
            assert again_m == pytest.approx(place_m + route.length_m)


def test_a_dwell_runs_down_and_ends_with_driving_on() -> None:
    route = route_of(LINE, stops_m=[500.0], dwell_s=20.0)
    standing = visits(route, (490.0, 5.0), (498.0, 0.0), (499.0, 0.1))
    assert standing.dwell_left_s(6 * SECOND_NS) == pytest.approx(15.0)
    assert standing.dwell_left_s(60 * SECOND_NS) == 0.0
    standing.observe(503.0, 3.0, 8 * SECOND_NS)
    assert standing.dwell_left_s(8 * SECOND_NS) == 0.0
    standing.observe(504.0, 0.0, 9 * SECOND_NS)  # a queue behind the stop is no second dwell
    assert standing.dwell_left_s(9 * SECOND_NS) == 0.0
