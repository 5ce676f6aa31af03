"""What is left of an estimate where more than was measured cannot be."""

import numpy as np
import pytest
from scipy.special import erfc

from wayline.likelihood import Measurement
from wayline.vertical.bound import at_most


@pytest.mark.parametrize("noise_std", [0.05, 0.5])
@pytest.mark.parametrize("beyond_std", [0.01, 0.5, 2.0, 3.5])
def test_it_leaves_the_moments_of_a_normal_distribution_that_is_cut_off(
    beyond_std: float, noise_std: float
) -> None:
    """A slope of 0 +/- 0.4, which is at most so far below, to the noise of the bound."""
    known_std = 0.4
    bound = -beyond_std * float(np.hypot(known_std, noise_std))
    # the row of a torque: a lower slope is a positive innovation
    told = Measurement("torque", np.array([-bound]), np.array([[-1.0]]), np.array([[noise_std**2]]))
    expected = np.array([[known_std**2]])
    made = at_most(told, expected)
    gain = known_std**2 / (known_std**2 + made.R[0, 0])
    mean, variance = -gain * made.y[0], (1.0 - gain) * known_std**2

    slopes = np.linspace(-4.0, 4.0, 400_001)
    allowed = 0.5 * erfc((slopes - bound) / noise_std / np.sqrt(2.0))
    weights = np.exp(-0.5 * (slopes / known_std) ** 2) * allowed
    weights /= weights.sum()
    assert mean == pytest.approx(float(weights @ slopes), abs=1e-3)
    assert variance == pytest.approx(float(weights @ slopes**2) - mean**2, abs=1e-3)
