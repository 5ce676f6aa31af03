"""Pure: a frequency lock loop on paper: equations 1 to 3 of papers/001.

The paper has them from P. Ward, Satellite signal acquisition and tracking, chapter 5 of
Understanding GPS, 1996. C/N0 is a ratio in Hz here: 30 dB-Hz are 1000 Hz.
"""

import math
from collections.abc import Callable
from typing import Literal

from scipy.optimize import brentq

Reading = Literal["inside", "outside"]
"""Where the bracket of equation 2 stands: under the root, or behind it. Print does not tell."""

INTEGRATION_S = 0.01
"""Of a pair's two correlations; the paper's figure 1."""
THRESHOLD_TURNS = 0.0833
"""As printed: a twelfth, so that three stds are a quarter of the pull-in range, 1 / (4 T)."""
STRESS_SHARE = 0.33
"""As printed: the stress is a bias, of which three stds' third counts."""
DAMPING = math.sqrt(2.0)
"""Ward's a2, twice the damping ratio of a second-order loop."""
BANDWIDTH_PER_RADPS = (1.0 + DAMPING**2) / (4.0 * DAMPING)
"""Noise bandwidth (Hz) over natural frequency (rad/s): Ward's 0.53."""
ORDER = 2
"""A loop of second order is stressed by jerk."""
WEAKEST_DBHZ, STRONGEST_DBHZ = -10.0, 90.0


def ratio_hz(cn0_dbhz: float) -> float:
    """C/N0 as a ratio."""
    return float(10.0 ** (0.1 * cn0_dbhz))


def natural_radps(bandwidth_hz: float) -> float:
    """Natural frequency of a second-order loop of a noise bandwidth."""
    return bandwidth_hz / BANDWIDTH_PER_RADPS


def thermal_jitter_hz(
    bandwidth_hz: float,
    cn0_hz: float,
    *,
    integration_s: float = INTEGRATION_S,
    factor: float = 1.0,
    reading: Reading = "inside",
) -> float:
    """One sigma of the frequency by thermal noise, equation 2.

    `factor` is the paper's F: 1 at high C/N0, 2 near the threshold.
    """
    linear = 4.0 * factor * bandwidth_hz / cn0_hz
    squaring = 1.0 + 1.0 / (integration_s * cn0_hz)
    root = math.sqrt(linear * squaring) if reading == "inside" else math.sqrt(linear) * squaring
    return root / (2.0 * math.pi * integration_s)


def stress_hz(jerk_degps3: float, bandwidth_hz: float) -> float:
    """Frequency error by dynamic stress, equation 3 with n = 2.

    The jerk is that along the line of sight, in degrees of carrier phase.
    """
    return jerk_degps3 / (360.0 * natural_radps(bandwidth_hz) ** ORDER)


def tracking_sigma_hz(thermal_hz: float, stress: float) -> float:
    """The left side of equation 1; `stress` in Hz."""
    return thermal_hz + STRESS_SHARE * stress


def threshold_hz(integration_s: float = INTEGRATION_S) -> float:
    """The right side of equation 1: a larger sigma loses lock."""
    return THRESHOLD_TURNS / integration_s


def threshold_dbhz(
    bandwidth_hz: float,
    stress: float,
    *,
    integration_s: float = INTEGRATION_S,
    factor: float = 1.0,
    reading: Reading = "inside",
) -> float | None:
    """C/N0 at which equation 1 just holds; None where the stress alone (Hz) breaks it."""
    allowed_hz = threshold_hz(integration_s) - STRESS_SHARE * stress
    if allowed_hz <= 0.0:
        return None

    def excess_hz(cn0_dbhz: float) -> float:
        jitter_hz = thermal_jitter_hz(
            bandwidth_hz,
            ratio_hz(cn0_dbhz),
            integration_s=integration_s,
            factor=factor,
            reading=reading,
        )
        return jitter_hz - allowed_hz

    return _root(excess_hz)


def _root(excess: Callable[[float], float]) -> float:
    return float(brentq(excess, WEAKEST_DBHZ, STRONGEST_DBHZ))


def allowed_bandwidth_hz(bandwidth_hz: float, jerk_ratio: float) -> float:
    """The narrowest bandwidth that an aid allows "without compromising on dynamics".

    That is where what the aid leaves of the jerk, `jerk_ratio`, stresses the loop as all of it does
    the loop of `bandwidth_hz` (equation 3). No aid widens a loop.
    """
    return bandwidth_hz * float(min(jerk_ratio, 1.0) ** (1.0 / ORDER))
