"""The simulated loop, held against the equations that it stands for."""

import numpy as np
import pytest

from wayline_evaluation.estimates import Floats
from wayline_evaluation.tracking.fll import ratio_hz, stress_hz, thermal_jitter_hz
from wayline_evaluation.tracking.lock import LockLost, gained_db, lock_lost
from wayline_evaluation.tracking.loop import (
    LOST_HZ,
    SAMPLES_HZ,
    Told,
    frequency_errors_hz,
    lost,
    white_noise,
)

SETTLED = 500
"""Pairs, ten seconds."""


def still(seconds: float, runs: int) -> Told:
    """Carriers that do not move, and loops that are told nothing."""
    nothing = np.zeros((round(seconds * SAMPLES_HZ), runs))
    return Told(nothing, nothing)


def noise_for(told: Told, seed: int = 1) -> np.ndarray:
    samples, runs = told.doppler_hz.shape
    return white_noise(samples, runs, np.random.default_rng(seed))


def errors(told: Told, bandwidth_hz: float, cn0_dbhz: float) -> Floats:
    levels = np.array([ratio_hz(cn0_dbhz)])
    return frequency_errors_hz(told, bandwidth_hz, levels, noise_for(told))[:, 0]


@pytest.mark.parametrize("bandwidth_hz", [0.5, 1.2])
def test_the_jitter_of_a_strong_signal_is_that_of_equation_2(bandwidth_hz: float) -> None:
    """At 40 dB-Hz what both readings differ by is 0.5 %."""
    seen_hz = float(np.std(errors(still(60.0, 50), bandwidth_hz, 40.0)[SETTLED:]))
    assert seen_hz == pytest.approx(thermal_jitter_hz(bandwidth_hz, ratio_hz(40.0)), rel=0.05)


def test_a_constant_jerk_leaves_the_error_of_equation_3() -> None:
    """Without noise to speak of."""
    times_s = np.arange(20 * SAMPLES_HZ)[:, np.newaxis] / SAMPLES_HZ
    doppler_hz = 0.5 * 4.0 * np.square(times_s)
    told = Told(doppler_hz, np.zeros_like(doppler_hz))
    last_hz = float(errors(told, 1.2, 90.0)[-1, 0])
    assert last_hz == pytest.approx(stress_hz(360.0 * 4.0, 1.2), rel=0.02)


def test_an_aid_takes_the_stress_away() -> None:
    times_s = np.arange(20 * SAMPLES_HZ)[:, np.newaxis] / SAMPLES_HZ
    doppler_hz = 0.5 * 4.0 * np.square(times_s)
    assert abs(float(errors(Told(doppler_hz, doppler_hz), 0.1, 90.0)[-1, 0])) < 0.1


def test_a_jump_out_of_the_pull_in_range_loses_lock() -> None:
    told = still(20.0, 3)
    jumped_hz = told.doppler_hz.copy()
    jumped_hz[1000:] += LOST_HZ + 1.0
    levels = np.array([ratio_hz(60.0)])
    moved = Told(jumped_hz, told.aid_hz)
    assert lost(frequency_errors_hz(moved, 1.2, levels, noise_for(told))).all()
    assert not lost(frequency_errors_hz(told, 1.2, levels, noise_for(told))).any()


def test_the_same_seed_gives_the_same_loop() -> None:
    told = still(5.0, 4)
    levels = np.array([100.0])
    one, same = (frequency_errors_hz(told, 1.2, levels, noise_for(told, 7)) for _ in range(2))
    other = frequency_errors_hz(told, 1.2, levels, noise_for(told, 8))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


def test_fewer_lose_lock_the_stronger_the_signal() -> None:
    told = still(20.0, 60)
    found = lock_lost(told, 1.2, (6.0, 12.0, 15.0, 18.0, 24.0), noise_for(told))
    assert found.shares[0] == 1.0
    assert found.shares[-1] == 0.0
    assert found.half_dbhz is not None
    assert 12.0 < found.half_dbhz < 18.0


def curve(*shares: float) -> LockLost:
    levels = tuple(float(level) for level in range(10, 10 + len(shares)))
    return LockLost(cn0_dbhz=levels, shares=shares, half_dbhz=None, half_std_db=None)


def test_what_is_not_known_gains_nothing() -> None:
    assert gained_db(curve(1.0, 1.0), curve(1.0, 0.0)) is None
