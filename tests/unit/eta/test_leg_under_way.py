"""What is left of a leg, by how long its beginning has taken."""

import numpy as np
import pytest

from wayline_eta.experience import Expected
from wayline_eta.leg_under_way import LEAST, PROFILE_STD, rest_of_leg

WHOLE = Expected(1_000.0, 120.0**2)


def test_who_was_sooner_than_evenly_planned_meets_the_slow_part_later() -> None:
    """A part of what was gained is given back, and not more."""
    evenly = rest_of_leg(WHOLE, 0.5, 500.0)
    sooner = rest_of_leg(WHOLE, 0.5, 400.0)
    assert evenly.seconds == pytest.approx(500.0)
    assert 530.0 < sooner.seconds < 600.0


def test_who_has_begun_slowly_has_the_quick_part_before_it() -> None:
    assert rest_of_leg(WHOLE, 0.5, 600.0).seconds < 470.0


def test_a_jam_is_not_made_up_for() -> None:
    """Who is off by more than any road explains goes on as planned, at its own pace."""
    assert rest_of_leg(WHOLE, 0.5, 1_500.0).seconds == pytest.approx(500.0)


def test_the_rest_takes_its_share_where_nobody_saw_the_leg_begin() -> None:
    rest = rest_of_leg(WHOLE, 0.25, None)
    assert rest.seconds == pytest.approx(750.0)
    assert rest.variance_s2 == pytest.approx(0.75 * WHOLE.variance_s2)


@pytest.mark.parametrize("done", [0.0, 1e-6])
def test_at_the_beginning_the_whole_is_left(done: float) -> None:
    rest = rest_of_leg(WHOLE, done, 0.0)
    assert rest.seconds == pytest.approx(1_000.0, rel=1e-3)
    assert rest.variance_s2 == pytest.approx(WHOLE.variance_s2, rel=1e-3)


def test_the_end_is_never_made_up_for_at_once() -> None:
    """Nobody drives the last streets at twice their speed for being late."""
    assert rest_of_leg(WHOLE, 0.95, 1_200.0).seconds >= LEAST * 50.0


@pytest.mark.parametrize("done", [0.2, 0.5, 0.8])
def test_of_legs_as_they_are_modelled_it_tells_the_mean_and_the_spread(done: float) -> None:
    """Whole times vary, and the way between is a bridge: nothing else knows more."""
    random = np.random.default_rng(3)
    off = 0.12 * random.standard_normal(4_000)
    bridge = PROFILE_STD * (done * (1.0 - done)) ** 0.5 * random.standard_normal(4_000)
    gone_s = 1_000.0 * (done * (1.0 + off) + bridge)
    left_s = 1_000.0 * (1.0 + off) - gone_s
    told = [rest_of_leg(WHOLE, done, max(each, 0.0)) for each in gone_s.tolist()]
    errors_s = left_s - np.array([each.seconds for each in told])
    spread_s = np.array([each.variance_s2 for each in told]) ** 0.5
    assert abs(errors_s.mean()) < 6.0
    assert np.std(errors_s / spread_s) == pytest.approx(1.0, abs=0.08)
    evenly_s = (1.0 - done) * 1_000.0
    assert np.std(errors_s) < 0.85 * np.std(left_s - evenly_s)
