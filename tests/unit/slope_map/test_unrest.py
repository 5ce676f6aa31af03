"""How bendy a road is, by the slopes that torque told of it."""

import numpy as np
import pytest

from wayline.tuning import Tuning
from wayline_slope_map.slopes import NO_SLOPES, Slopes, Window
from wayline_slope_map.unrest import CALMEST_PCT_PER_M, curvature_std_pct_per_m

SPEED_MPS = 20.0
MOST = Tuning().curvature_std_pct_per_m


def told(amplitude_pct: float, wave_m: float, *, seconds: int = 1000, noise: float = 0.0) -> Slopes:
    """A slope that waves, told every half second with white noise."""
    times_s = np.arange(0.0, seconds, 0.5)
    travelled_m = SPEED_MPS * times_s
    slope = amplitude_pct / 100.0 * np.sin(2.0 * np.pi * travelled_m / wave_m)
    slope += np.random.default_rng(1).normal(0.0, noise, len(slope))
    windows = tuple(Window(0.5, 0.0, 0.01, goes_on=True, share_before=0.0) for _ in times_s)
    return Slopes(times_s, travelled_m, slope, np.full(len(slope), 0.005), windows)


@pytest.mark.parametrize("noise", [0.0, 0.005])
def test_a_waving_road_is_as_bendy_as_its_waves_say(noise: float) -> None:
    """3 % over 900 m: the slope changes by 0.021 % a metre at most, 0.015 in the mean."""
    found = curvature_std_pct_per_m(told(3.0, 900.0, noise=noise), Tuning())
    assert found == pytest.approx(0.0148, rel=0.3)


def test_noise_alone_makes_no_hills() -> None:
    found = curvature_std_pct_per_m(told(0.0, 900.0, noise=0.005), Tuning())
    assert found == CALMEST_PCT_PER_M


def test_what_is_configured_is_the_most_and_counts_where_nothing_was_told() -> None:
    assert curvature_std_pct_per_m(told(9.0, 300.0), Tuning()) == MOST
    assert curvature_std_pct_per_m(told(1.0, 900.0, seconds=60), Tuning()) == MOST
    assert curvature_std_pct_per_m(NO_SLOPES, Tuning()) == MOST
