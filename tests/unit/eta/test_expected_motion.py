"""How a vehicle goes on along its route by the plan."""

import numpy as np
import pytest

from unit.eta.route_drives import SQUARE, Metres, route_of
from wayline_eta.expected_motion import ExpectedMotion

LINE: list[Metres] = [(0, 0), (4000, 0)]


def test_planned_dwells_are_kept_and_leave_the_speeds_alone() -> None:
    motion = ExpectedMotion(route_of(LINE, stops_m=[0.0, 1000.0, 2000.0, 4000.0], dwell_s=30.0))
    assert motion.dwells_s == pytest.approx([30.0] * 4)
    assert motion.speed_mps(1500.0) == pytest.approx(10.0)
    assert not motion.is_untold


def test_running_times_without_dwells_hold_them() -> None:
    """100 s from a stop on are 20 s at it and 80 s of driving; of a leg of 30 s the stop has 10."""
    motion = ExpectedMotion(route_of(LINE, stops_m=[0.0, 1000.0, 1300.0, 4000.0]))
    assert motion.dwells_s == pytest.approx([20.0, 10.0, 20.0, 0.0], abs=0.01)
    assert motion.speed_mps(500.0) == pytest.approx(12.5, abs=0.01)
    assert motion.speed_mps(1200.0) == pytest.approx(15.0, abs=0.01)
    assert motion.is_untold


def test_who_leaves_the_first_stop_at_its_time_comes_to_the_second_at_its() -> None:
    leaves_ns = np.array([0.0, -np.inf, -np.inf])
    route = route_of(LINE, stops_m=[0.0, 1000.0, 4000.0])
    motion = ExpectedMotion(route, leaves_ns)
    assert motion.dwells_s == pytest.approx([0.0, 20.0, 0.0], abs=0.01)
    assert motion.driven_s(np.array([1000.0, 4000.0])) == pytest.approx([100.0, 380.0], abs=0.01)


def test_the_last_dwell_of_a_loop_is_in_the_time_back_to_its_first_stop() -> None:
    motion = ExpectedMotion(route_of(SQUARE, stops_m=[0.0, 1000.0]))
    assert motion.dwells_s == pytest.approx([20.0, 20.0], abs=0.01)
    assert motion.driven_s(np.array([2000.0])) == pytest.approx([160.0], abs=0.01)


def test_of_stops_at_one_place_the_last_has_the_dwell() -> None:
    motion = ExpectedMotion(route_of(LINE, stops_m=[0.0, 1000.0, 1000.0, 4000.0], dwell_s=30.0))
    assert motion.stop_dwells_s.tolist() == [30.0, 0.0, 30.0, 30.0]


def test_driven_seconds_go_on_over_laps_and_back() -> None:
    motion = ExpectedMotion(route_of(SQUARE, stops_m=[0.0, 700.0], dwell_s=10.0))
    totals_m = np.array([-5.0, 100.0, 2100.0, 5000.0])
    seconds = motion.driven_s(totals_m)
    assert seconds == pytest.approx([-0.5, 10.0, 210.0, 500.0], abs=0.01)
    assert motion.distance_at(seconds) == pytest.approx(totals_m, abs=0.01)


def test_the_next_stop_of_a_loop_may_be_on_the_next_lap() -> None:
    motion = ExpectedMotion(route_of(SQUARE, stops_m=[0.0, 700.0]))
    places_m, which = motion.next_stops(np.array([-5.0, 0.0, 699.0, 700.0, 2700.0]))
    assert places_m == pytest.approx([0.0, 700.0, 700.0, 2000.0, 4000.0], abs=0.1)
    assert which.tolist() == [0, 1, 1, 0, 0]


def test_an_open_route_has_no_stop_after_its_last() -> None:
    motion = ExpectedMotion(route_of(LINE, stops_m=[1000.0, 2000.0]))
    places_m, _ = motion.next_stops(np.array([500.0, 2000.0, 3000.0]))
    assert places_m.tolist() == [pytest.approx(1000.0, abs=0.1), np.inf, np.inf]


def test_a_stop_near_by_is_found_on_either_side() -> None:
    motion = ExpectedMotion(route_of(LINE, stops_m=[1000.0]))
    for near_m in (985.0, 1008.0):
        found = motion.stop_near(near_m, 20.0, 10.0)
        assert found is not None
        assert found[0] == pytest.approx(1000.0, abs=0.1)
    assert motion.stop_near(970.0, 20.0, 10.0) is None
    assert motion.stop_near(1012.0, 20.0, 10.0) is None
    assert ExpectedMotion(route_of(LINE)).stop_near(5.0, 20.0, 20.0) is None
