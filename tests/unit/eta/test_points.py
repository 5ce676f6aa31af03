"""How the points of the along filter go from stand to stand."""

import numpy as np
import pytest

from unit.eta.route_drives import SECOND_NS, Metres, route_of
from wayline_eta.along_filter import AlongFilter
from wayline_eta.draws import POINTS, Draws
from wayline_eta.expected_motion import RATE_MPS2, ExpectedMotion
from wayline_eta.point_motion import PointMotion
from wayline_eta.points import BETWEEN, Floats, Leg, Points, made_leg

LINE: list[Metres] = [(0, 0), (6_000, 0)]
STOPS_M = [500.0 * number for number in range(13)]


def motion() -> ExpectedMotion:
    """Ten metres a second, a stop each 500 m."""
    return ExpectedMotion(route_of(LINE, stops_m=STOPS_M, dwell_s=20.0))


def on(leg: Leg) -> Points:
    ones = np.ones(len(leg.rates))
    return Points(leg, leg.comes_s + 20.0, np.full(len(ones), BETWEEN), ones, 0.0 * ones)


def leg_of(rate: float, to_m: float = 1_500.0, *, rolling: bool = False) -> Leg:
    each: list[Floats] = [np.array([value]) for value in (1_000.0, to_m, 0.0, rate)]
    return made_leg(motion(), *each, rolling=rolling)


@pytest.mark.parametrize("rolling", [False, True])
def test_a_leg_is_driven_from_its_begin_to_its_end_at_its_rate(rolling: bool) -> None:
    """500 m at 12 m/s, and what speeding up and braking take beside."""
    leg = leg_of(1.2, rolling=rolling)
    changes = (1 if rolling else 2) * 12.0 / RATE_MPS2 / 2.0
    assert leg.comes_s[0] == pytest.approx(500.0 / 12.0 + changes, abs=0.01)
    points = on(leg)
    at_s = np.arange(0.0, float(leg.comes_s[0]) + 5.0, 0.1)
    places_m = np.array([points.places_m(each, motion())[0] for each in at_s.tolist()])
    speeds_mps = np.array(
        [
            points.speeds_mps(each, points.places_m(each, motion()), motion())[0]
            for each in at_s.tolist()
        ]
    )
    assert (places_m[0], places_m[-1]) == (1_000.0, 1_500.0)
    assert np.diff(places_m) / 0.1 == pytest.approx(speeds_mps[:-1], abs=0.3)
    assert speeds_mps.max() == pytest.approx(12.0)
    assert points.stands(float(at_s[-1])).all()


def test_a_way_too_short_for_its_speed_is_driven_at_less() -> None:
    leg = leg_of(1.2, to_m=1_010.0)
    points, half_s = on(leg), float(leg.comes_s[0]) / 2.0
    assert points.places_m(half_s, motion())[0] == pytest.approx(1_005.0, abs=0.01)
    speeds_mps = points.speeds_mps(half_s, points.places_m(half_s, motion()), motion())
    assert speeds_mps[0] == pytest.approx((10.0 * RATE_MPS2) ** 0.5)


def test_at_the_hurried_speed_a_leg_takes_the_time_that_is_planned() -> None:
    """From stop to stop, with speeding up and braking in it."""
    leg = leg_of(float(motion().hurries[3]))
    assert leg.comes_s[0] == pytest.approx(50.0, abs=0.1)


@pytest.mark.parametrize("speed_mps", [6.0, 14.0])
def test_a_reported_speed_is_that_of_the_leg(speed_mps: float) -> None:
    """Also of a vehicle that has driven as planned until then; the next stop is far enough."""
    along = AlongFilter(motion(), 0, 1_050.0, 5.0, 10.0)
    along.report(10 * SECOND_NS, 1_150.0, 5.0, moves=True, speed_mps=speed_mps)
    begins_m = along.at(10 * SECOND_NS).total_m
    moved_m = along.at(20 * SECOND_NS).total_m - begins_m
    assert moved_m == pytest.approx(10.0 * speed_mps, rel=0.12)


def test_some_pass_a_stop_and_some_stand_before_it() -> None:
    """Three in four stand there."""
    goes = PointMotion(motion(), 0, Draws())
    standing = on(
        Leg(*(np.full(POINTS, each) for each in (1e3, 1e3, 0.0, 1.0, 0.0, 0.0, 0.0, 1e2, 1e2)))
    )
    ends_m = goes.gone_on(standing, 20.0).leg.ends_m
    shares = [np.mean(ends_m < 1_499.0), np.mean(ends_m == 1_500.0), np.mean(ends_m > 1_501.0)]
    assert shares == pytest.approx([0.1, 0.76, 0.14], abs=0.04)
