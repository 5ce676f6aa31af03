"""The smoother, beside filterpy's."""

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray

from wayline.trip_distance.integrated_walk import RATE_STD, smoothed

Floats = NDArray[np.float64]
DENSITY = 0.7


def step(dt_s: float) -> tuple[Floats, Floats]:
    transition = np.array([[1.0, dt_s], [0.0, 1.0]])
    noise = np.array([[dt_s**3 / 3.0, dt_s**2 / 2.0], [dt_s**2 / 2.0, dt_s]])
    return transition, DENSITY**2 * noise


def by_filterpy(times_s: Floats, measured: Floats, stds: Floats) -> tuple[Floats, Floats]:
    """States and covariances of its filter and its Rauch-Tung-Striebel smoother."""
    kalman = KalmanFilter(dim_x=2, dim_z=1)
    kalman.x, kalman.P = np.zeros(2), np.eye(2) * RATE_STD**2
    kalman.H = np.array([[1.0, 0.0]])
    states, covariances, steps = [], [], [step(1.0)]
    for number, (value, std) in enumerate(zip(measured, stds, strict=True)):
        if number:
            steps.append(step(float(times_s[number] - times_s[number - 1])))
            kalman.predict(F=steps[-1][0], Q=steps[-1][1])
        kalman.update(None if np.isnan(value) else value, R=std**2)
        states.append(kalman.x.ravel().copy())
        covariances.append(kalman.P.copy())
    transitions, noises = zip(*steps, strict=True)
    found, spread, _, _ = kalman.rts_smoother(
        np.array(states), np.array(covariances), Fs=transitions, Qs=noises
    )
    return found, spread


def test_it_is_the_smoother_of_rauch_tung_and_striebel() -> None:
    """Steps of uneven length, a measurement missing; none is so far off as to be doubted."""
    random = np.random.default_rng(4)
    times_s = np.cumsum(random.uniform(0.5, 3.0, 120))
    stds = random.uniform(0.3, 0.5, 120)
    measured = 2.0 * np.sin(0.05 * times_s)
    measured[60] = np.nan
    mine = smoothed(times_s, measured, stds, DENSITY)
    states, covariances = by_filterpy(
        times_s, measured, stds / np.sqrt(np.maximum(mine.weights, 1e-9))
    )
    np.testing.assert_allclose(mine.values, states[:, 0], atol=1e-4)
    np.testing.assert_allclose(mine.rates, states[:, 1], atol=1e-4)
    one = np.zeros(120)
    one[60] = 1.0
    assert mine.std_of_sum(one) == pytest.approx(np.sqrt(covariances[60, 0, 0]), rel=1e-3)


def test_a_measurement_far_off_has_no_part_in_it() -> None:
    times_s = np.arange(60.0)
    measured = 0.5 * times_s
    measured[30] += 40.0
    mine = smoothed(times_s, measured, np.full(60, 0.1), DENSITY)
    np.testing.assert_allclose(mine.values, 0.5 * times_s, atol=0.02)
    assert mine.weights[30] < 1e-3
