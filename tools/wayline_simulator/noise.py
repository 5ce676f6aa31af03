"""Pure: the random processes that sensors' errors are made of."""

import math

import numpy as np
from scipy.signal import lfilter

from wayline_simulator.journey import Floats


def gauss_markov(
    shape: int | tuple[int, ...],
    step_s: float,
    std: float,
    time_s: float,
    random: np.random.Generator,
) -> Floats:
    """First-order Gauss-Markov processes along the first axis, stationary from the first sample.

    Their autocorrelation falls to 1 / e in `time_s` (IEEE Std 952-1997, annex B).
    """
    decay = math.exp(-step_s / time_s)
    driven = std * random.standard_normal(shape)
    driven[1:] *= math.sqrt(1.0 - decay * decay)
    values: Floats = lfilter([1.0], [1.0, -decay], driven, axis=0)
    return values


def random_steps(
    times_s: Floats, std: float, every_s: float, random: np.random.Generator
) -> Floats:
    """A level that is drawn anew from N(0, std) at the instants of a Poisson process.

    `times_s` in ascending order; the level lasts `every_s` on average.
    """
    span_s = float(times_s[-1] - times_s[0]) if len(times_s) else 0.0
    changes = np.sort(random.uniform(0.0, span_s, random.poisson(span_s / every_s)))
    levels = std * random.standard_normal(len(changes) + 1)
    return levels[np.searchsorted(changes, times_s - times_s[:1], side="right")]


def in_steps(values: Floats, step: float) -> Floats:
    """The nearest whole multiples of a resolution."""
    return np.round(values / step) * step
