"""What timetables in whole minutes may have meant."""

import numpy as np
import pytest
from numpy.typing import NDArray

from wayline.timetable.whole_minutes import meant_times

STOPS = 21
ALONGS_M = np.linspace(0.0, 8_000.0, STOPS)
NO_WAITS = np.zeros(STOPS, dtype=np.bool_)


Floats = NDArray[np.float64]


def every(seconds: float) -> Floats:
    return np.full(STOPS, seconds).cumsum() - seconds


def rounded(times_s: Floats) -> Floats:
    return np.asarray(60.0 * np.round(times_s / 60.0))


def test_legs_of_one_pace_are_told_at_one_and_two_minutes_and_meant_at_one_pace() -> None:
    exact_s = every(77.0)
    arrivals_s, departures_s = meant_times(ALONGS_M, rounded(exact_s), rounded(exact_s), NO_WAITS)
    assert departures_s == pytest.approx(exact_s, abs=30.0)
    assert np.diff(rounded(exact_s)).std() > 25.0
    assert np.diff(departures_s).std() < 10.0
    assert arrivals_s.tolist() == departures_s.tolist()


def test_stands_of_half_a_minute_are_told_as_one_or_none() -> None:
    comes_s = every(91.0)
    leaves_s = comes_s + np.pad(np.full(STOPS - 2, 25.0), 1)
    arrivals_s, departures_s = meant_times(ALONGS_M, rounded(comes_s), rounded(leaves_s), NO_WAITS)
    assert (departures_s - arrivals_s)[1:-1] == pytest.approx([25.0] * (STOPS - 2), abs=8.0)
    assert (departures_s - arrivals_s)[[0, -1]].tolist() == [0.0, 0.0]


def test_a_wait_stays_where_it_is_and_as_long() -> None:
    """Of ten minutes among stops without dwells, and of one where vehicles wait for their time."""
    comes_s = every(60.0)
    comes_s[11:] += 600.0
    leaves_s = comes_s.copy()
    leaves_s[10] += 600.0
    leaves_s[15] += 60.0
    comes_s[16:] += 60.0
    leaves_s[16:] += 60.0
    waits = NO_WAITS.copy()
    waits[15] = True
    arrivals_s, departures_s = meant_times(ALONGS_M, comes_s, leaves_s, waits)
    assert arrivals_s == pytest.approx(comes_s, abs=0.1)
    assert departures_s == pytest.approx(leaves_s, abs=0.1)


def test_no_time_is_moved_by_more_than_rounding_does() -> None:
    """A leg that takes eleven minutes, a queue's or a driver's rest, is not spread over others."""
    times_s = every(60.0)
    times_s[8:] += 600.0
    _, departures_s = meant_times(ALONGS_M, times_s, times_s, NO_WAITS)
    assert np.abs(departures_s - times_s).max() <= 30.0
    assert np.all(np.diff(departures_s) >= 0.0)


def test_times_to_the_second_and_times_that_are_not_told_stay() -> None:
    seconds_s = every(61.0)
    for told in meant_times(ALONGS_M, seconds_s, seconds_s, NO_WAITS):
        assert told.tolist() == seconds_s.tolist()
    times_s = rounded(every(77.0))
    times_s[[3, 4, 9]] = np.nan
    _, departures_s = meant_times(ALONGS_M, times_s, times_s, NO_WAITS)
    assert np.flatnonzero(np.isnan(departures_s)).tolist() == [3, 4, 9]
