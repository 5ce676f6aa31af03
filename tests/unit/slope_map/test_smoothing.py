"""A run smoothed backwards finds the grade, without lag, whatever a sensor throws in."""

import numpy as np
import pytest

from wayline.line import Floats
from wayline.tuning import Tuning
from wayline_slope_map.altitudes import Measured
from wayline_slope_map.slopes import NO_SLOPES
from wayline_slope_map.smoothing import Sensed, Smoothed, smooth

TUNING = Tuning()
NOTHING = Measured(*(np.empty(0),) * 4, np.empty(0, dtype=np.intp))
SPEED_MPS = 15.0
TIMES_S = np.arange(0.0, 200.0)
ASKED_S = np.arange(10.5, 190.0, 1.5)


def crest_m(distance_m: Floats) -> Floats:
    """Up at 4 %, over a crest 200 m long around 1500 m, down at 4 %."""
    away_m = np.abs(distance_m - 1500.0)
    outside = -0.04 * (away_m - 50.0)
    return 120.0 + np.where(away_m > 100.0, outside, -0.04 * away_m**2 / 200.0)


def crest_grade_pct(distance_m: Floats) -> Floats:
    return np.clip(-4.0 * (distance_m - 1500.0) / 100.0, -4.0, 4.0)


def measured(alt_m: Floats, std_m: float, times_s: Floats = TIMES_S) -> Measured:
    receiver = np.zeros(len(alt_m), dtype=np.intp)
    return Measured(times_s, times_s * SPEED_MPS, alt_m, np.full(len(alt_m), std_m), receiver)


def asked(gps: Measured, barometer: Measured = NOTHING) -> Smoothed:
    smoothed = smooth(Sensed(gps, barometer, NO_SLOPES), ASKED_S, ASKED_S * SPEED_MPS, TUNING)
    assert smoothed is not None
    return smoothed


def test_clean_altitudes_give_the_grade_at_its_place_without_a_time_shift() -> None:
    smoothed = asked(NOTHING, measured(crest_m(TIMES_S * SPEED_MPS), 0.1))
    truth_pct = crest_grade_pct(ASKED_S * SPEED_MPS)
    shifts = range(-5, 6)
    misfits = [
        np.std(smoothed.grade_pct[5:-5] - np.roll(truth_pct, shift)[5:-5]) for shift in shifts
    ]
    assert shifts[int(np.argmin(misfits))] == 0
    assert np.max(np.abs(smoothed.grade_pct - truth_pct)) < 1.0


def test_one_wild_altitude_hardly_moves_the_grade() -> None:
    alt_m = crest_m(TIMES_S * SPEED_MPS)
    wild_m = alt_m.copy()
    wild_m[100] += 70.0
    moved_pct = asked(measured(wild_m, 4.0)).grade_pct - asked(measured(alt_m, 4.0)).grade_pct
    assert 0.0 < np.max(np.abs(moved_pct)) < 1.0


def test_a_receiver_that_wanders_together_is_not_averaged_away() -> None:
    """Two hundred fixes within three minutes are worth three or four, not two hundred."""
    smoothed = asked(measured(crest_m(TIMES_S * SPEED_MPS), 4.0))
    assert smoothed.alt_std_m[0] > 2.0
    receiver = np.zeros(200, dtype=np.intp)
    standing = Measured(TIMES_S, np.zeros(200), np.full(200, 50.0), np.full(200, 4.0), receiver)
    at_rest = smooth(
        Sensed(standing, NOTHING, NO_SLOPES), np.array([100.0]), np.array([0.0]), TUNING
    )
    assert at_rest is not None
    assert at_rest.alt_std_m[0] > 1.5


def test_a_barometer_far_off_gives_its_shape_and_gps_the_height() -> None:
    truth_m = crest_m(TIMES_S * SPEED_MPS)
    smoothed = asked(measured(truth_m[::5], 4.0, TIMES_S[::5]), measured(truth_m - 180.0, 0.5))
    gps_only = asked(measured(truth_m[::5], 4.0, TIMES_S[::5]))
    assert smoothed.alt_m == pytest.approx(crest_m(ASKED_S * SPEED_MPS), abs=1.0)
    assert np.mean(smoothed.grade_std_pct) < 0.7 * np.mean(gps_only.grade_std_pct)


def test_where_nothing_was_measured_the_std_grows() -> None:
    tunnel = (TIMES_S < 60.0) | (TIMES_S > 140.0)
    smoothed = asked(measured(crest_m(TIMES_S * SPEED_MPS)[tunnel], 4.0, TIMES_S[tunnel]))
    inside = (ASKED_S > 80.0) & (ASKED_S < 120.0)
    outside = (ASKED_S > 20.0) & (ASKED_S < 40.0)
    assert np.min(smoothed.grade_std_pct[inside]) > 1.5 * np.max(smoothed.grade_std_pct[outside])


def test_one_altitude_says_nothing() -> None:
    one = measured(np.array([100.0]), 4.0, np.array([5.0]))
    assert smooth(Sensed(one, NOTHING, NO_SLOPES), ASKED_S, ASKED_S * SPEED_MPS, TUNING) is None
