"""Pure: what a simulated sensor's statistics ought to be, from its model alone."""

import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_simulator.gps import GpsModel
from wayline_simulator.gyro import GyroModel

DITHERED = 0.5
"""From a noise of so many steps on, rounding adds white noise of a twelfth of a step squared."""


def allan_model(model: GyroModel, taus_s: Floats) -> Floats | None:
    """Allan deviation in deg/s: angle random walk, rounding, and the wandering bias.

    IEEE Std 952-1997 annex C. None where noise is too small beside the steps: what rounding makes
    of it depends on where the bias lies between two of them.
    """
    if model.noise_deg_per_sqrt_s * np.sqrt(model.rate_hz) < DITHERED * model.resolution_degps:
        return None
    rounding = model.resolution_degps**2 / 12.0 / model.rate_hz
    share = taus_s / model.bias_wander_time_s
    settled = (3.0 - 4.0 * np.exp(-share) + np.exp(-2.0 * share)) / (2.0 * share)
    wander = 2.0 * model.bias_wander_std_degps**2 / share * (1.0 - settled)
    return np.asarray(np.sqrt((model.noise_deg_per_sqrt_s**2 + rounding) / taus_s + wander))


def correlation_model(model: GpsModel, lags_s: Floats) -> Floats:
    """Autocorrelation of the error of a horizontal axis at lags above 0, under an open sky."""
    wander_m2 = model.position_wander_std_m**2
    share = wander_m2 / (wander_m2 + model.position_white_std_m**2)
    return np.asarray(share * np.exp(-lags_s / model.position_wander_time_s))
