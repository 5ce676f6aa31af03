"""Pure: what is left of an estimate where more than was measured cannot be.

Brakes take what nobody measures, so the slope is at most what the torque would make it. Cut off
there, a normal distribution has another mean, below the bound, and a smaller variance (Kotz and
Johnson 1970); both are what a measurement would leave that is farther off, and noisier. Taken for
a measurement of the bound itself it would hold the slope to it: that the brakes took nothing.
"""

import math

from scipy.special import erfcx

from wayline.likelihood import Floats, Measurement


def at_most(measurement: Measurement, expected: Floats) -> Measurement:
    """A measurement of one number that is an upper bound, passed by its innovation (y > 0).

    `expected` is H P H'. The measurement that is made of it leaves the mean and the variance of the
    normal distribution cut off at the noisy bound.
    """
    known, noise = float(expected[0, 0]), float(measurement.R[0, 0])
    std = math.sqrt(known + noise)
    beyond = float(measurement.y[0]) / std
    hazard = math.sqrt(2.0 / math.pi) / float(erfcx(beyond / math.sqrt(2.0)))
    taken = hazard * (hazard - beyond)
    return measurement._replace(
        y=measurement.y * 0.0 + std * hazard / taken,
        R=measurement.R * 0.0 + std**2 / taken - known,
    )
