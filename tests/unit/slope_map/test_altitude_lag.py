"""Altitudes that a receiver filters are of an instant before, which hills tell."""

import numpy as np
import pytest

from wayline.line import Floats
from wayline_slope_map.altitude_lag import lag_s

TIMES_S = np.arange(0.0, 1_200.0)
RANDOM = np.random.default_rng(11)


def hills_m(times_s: Floats) -> Floats:
    """Hills of a minute and less, as a main road at 80 km/h has them."""
    return 12.0 * np.sin(times_s / 14.0) + 7.0 * np.sin(times_s / 9.0 + 1.0) + 0.02 * times_s


def wandering_m(std_m: float, time_s: float) -> Floats:
    """An error of a receiver that varies slowly."""
    kept = np.exp(-1.0 / time_s)
    error_m = np.zeros(len(TIMES_S))
    for i in range(1, len(error_m)):
        drawn = RANDOM.standard_normal()
        error_m[i] = kept * error_m[i - 1] + std_m * np.sqrt(1.0 - kept**2) * drawn
    return error_m


@pytest.mark.parametrize("lag", [1.5, 6.0, 12.0])
def test_a_lag_is_found_beneath_a_slow_error(lag: float) -> None:
    alt_m = hills_m(TIMES_S - lag) + wandering_m(3.0, 120.0)
    assert lag_s(TIMES_S, alt_m, hills_m) == pytest.approx(lag, abs=0.4)


def test_a_first_order_lag_counts_as_its_time() -> None:
    alt_m = np.empty(len(TIMES_S))
    alt_m[0] = hills_m(TIMES_S[:1])[0]
    for i, true_m in enumerate(hills_m(TIMES_S[1:]), start=1):
        alt_m[i] = alt_m[i - 1] + (true_m - alt_m[i - 1]) / 5.0
    assert lag_s(TIMES_S, alt_m, hills_m) == pytest.approx(4.0, abs=0.5)


def test_a_few_altitudes_that_are_far_out_make_no_lag_of_their_own() -> None:
    alt_m = hills_m(TIMES_S - 4.0) + wandering_m(1.0, 120.0)
    alt_m[300:340] += 30.0
    assert lag_s(TIMES_S, alt_m, hills_m) == pytest.approx(4.0, abs=0.5)


@pytest.mark.parametrize(
    "alt_m",
    [
        pytest.param(hills_m(TIMES_S) + wandering_m(3.0, 120.0), id="a receiver without a lag"),
        pytest.param(np.full(len(TIMES_S), 55.0) + wandering_m(3.0, 40.0), id="no hills in it"),
        pytest.param(hills_m(TIMES_S - 40.0), id="beyond what receivers do"),
    ],
)
def test_what_is_not_sure_is_no_lag(alt_m: Floats) -> None:
    assert lag_s(TIMES_S, alt_m, hills_m) == pytest.approx(0.0, abs=0.3)


def test_fixes_too_seldom_to_tell_have_no_lag() -> None:
    times_s = np.arange(0.0, 1_200.0, 30.0)
    assert lag_s(times_s, hills_m(times_s - 5.0), hills_m) == 0.0
