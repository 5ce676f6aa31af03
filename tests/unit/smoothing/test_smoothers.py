"""The paper's four smoothers, beside libraries, its own figures and naive sums."""

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from wayline_evaluation.smoothing.kalman import SPEED_VARIANCE_M2PS2, discrete_kalman, filtered
from wayline_evaluation.smoothing.kernel import nadaraya_watson, reference_bandwidth
from wayline_evaluation.smoothing.modified_kalman import BAD_SPEED_VARIANCE_M2PS2, modified_kalman
from wayline_evaluation.smoothing.spline import least_squares_spline

SECONDS = np.arange(60.0)
UNEVEN = np.sort(np.random.default_rng(5).uniform(0.0, 60.0, 61)) + np.arange(61.0) * 0.1
NOISE = np.random.default_rng(6).normal(size=(61, 2))


def test_a_spline_follows_what_is_quadratic() -> None:
    curve = 3.0 + 2.0 * UNEVEN - 0.01 * UNEVEN**2
    np.testing.assert_allclose(least_squares_spline(UNEVEN, curve), curve, atol=1e-8)


def test_a_spline_smooths_within_its_intervals_of_three_seconds() -> None:
    """One coefficient an interval is left for three samples: a third of the noise's variance."""
    noise = np.random.default_rng(7).normal(size=3_000)
    left = least_squares_spline(np.arange(3_000.0), noise)
    assert np.var(left) == pytest.approx(1.0 / 3.0, abs=0.03)


def test_a_spline_goes_on_behind_a_hole() -> None:
    times_s = np.concatenate((SECONDS, SECONDS + 400.0))
    line = np.column_stack((times_s, -times_s))
    np.testing.assert_allclose(least_squares_spline(times_s, line), line, atol=1e-8)


def test_a_kernel_weighs_by_time_as_equation_4_says() -> None:
    weights = np.exp(-0.5 * np.square((UNEVEN[:, np.newaxis] - UNEVEN) / 3.0))
    wanted = weights @ NOISE / weights.sum(axis=1, keepdims=True)
    np.testing.assert_allclose(nadaraya_watson(UNEVEN, NOISE), wanted, atol=2e-3)


def test_the_reference_rule_is_the_papers() -> None:
    assert reference_bandwidth(10.0, 880) == pytest.approx(1.06 * 10.0 * 880**-0.2, rel=1e-3)


def test_the_discrete_filter_is_filterpys() -> None:
    variances = np.random.default_rng(8).uniform(0.5, 3.0, 61)
    kalman = KalmanFilter(dim_x=1, dim_z=1)
    kalman.x, kalman.P = np.array([NOISE[0, 0]]), np.array([[variances[0]]])
    kalman.H = kalman.F = np.array([[1.0]])
    states = [NOISE[0, 0]]
    for step_s, value, variance in zip(np.diff(UNEVEN), NOISE[1:, 0], variances[1:], strict=True):
        kalman.predict(Q=np.array([[0.7 * step_s**2]]))
        kalman.update(value, R=variance)
        states.append(float(kalman.x[0]))
    np.testing.assert_allclose(filtered(UNEVEN, NOISE, variances, 0.7)[:, 0], states, atol=1e-12)


@pytest.mark.parametrize(
    ("good", "gain"), [(True, 0.618034), (False, 0.048766)], ids=["good", "bad"]
)
def test_gains_settle_where_the_papers_noise_has_them(*, good: bool, gain: float) -> None:
    """A step of 1 in the measurement moves the state by K."""
    times_s, step = np.arange(201.0), np.zeros(201)
    step[-1] = 1.0
    moved = modified_kalman(
        times_s,
        step,
        np.full(201, good),
        variance=SPEED_VARIANCE_M2PS2,
        bad_variance=BAD_SPEED_VARIANCE_M2PS2,
    )
    assert moved[-1] == pytest.approx(gain, abs=1e-5)


def test_the_modified_filter_is_the_discrete_one_where_all_is_good() -> None:
    plain = discrete_kalman(SECONDS, SECONDS, 4.0)
    modified = modified_kalman(
        SECONDS, SECONDS, np.ones(60, dtype=bool), variance=4.0, bad_variance=1e9
    )
    np.testing.assert_array_equal(modified, plain)
