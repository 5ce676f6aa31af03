"""Pure: a second-order frequency lock loop on noisy correlations, many at a time.

A correlation lasts 10 ms, so there are 100 a second, and two of them fill a bit of the navigation
message. Across bits the phase may flip: a pair lies within one, and the loop closes 50 times a
second. That is what Ward derives equation 2 of papers/001 for. The cross product of a pair,
over the signal's power, is the frequency's error; its slope turns round at 1 / (4 T), where
equation 1 has lock end.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_evaluation.estimates import Floats
from wayline_evaluation.tracking.fll import DAMPING, INTEGRATION_S, natural_radps

Complexes = NDArray[np.complex128]

SAMPLES_HZ = round(1.0 / INTEGRATION_S)
PAIR_S = 2.0 * INTEGRATION_S
LOST_HZ = 1.0 / (4.0 * INTEGRATION_S)
"""An error beyond pulls the loop away from the signal."""


def white_noise(samples: int, runs: int, random: np.random.Generator) -> Complexes:
    """Of correlations, one sigma of 1 in phase and in quadrature; shape (samples, runs)."""
    noise: Complexes = random.standard_normal((samples, runs)) + 1j * random.standard_normal(
        (samples, runs)
    )
    return noise


class Told(NamedTuple):
    """Carrier frequencies 100 times a second, shape (samples, runs), Hz."""

    doppler_hz: Floats
    """Of the signal."""
    aid_hz: Floats
    """What the receiver is told of it; 0 where it is told nothing."""


def frequency_errors_hz(
    told: Told, bandwidth_hz: float, cn0_hz: Floats, noise: Complexes
) -> Floats:
    """True minus tracked frequency at each pair, shape (pairs, levels, runs).

    `cn0_hz` holds the levels as ratios; all levels and runs begin in lock.
    """
    residual_hz = told.doppler_hz - told.aid_hz
    pairs = len(residual_hz) // 2
    middle_hz = 0.5 * (residual_hz[0 : 2 * pairs : 2] + residual_hz[1 : 2 * pairs : 2])
    amplitude = np.sqrt(2.0 * cn0_hz * INTEGRATION_S)[:, np.newaxis]
    to_hz = 1.0 / (2.0 * math.pi * INTEGRATION_S * np.square(amplitude))
    radps = natural_radps(bandwidth_hz)
    rate_gain, gain = radps**2 * PAIR_S, DAMPING * radps
    tracked_hz = np.repeat(middle_hz[:1], len(cn0_hz), axis=0)
    rate_hzps = np.zeros_like(tracked_hz)
    errors_hz = np.empty((pairs, *tracked_hz.shape))
    for pair in range(pairs):
        error_hz = np.subtract(middle_hz[pair], tracked_hz, out=errors_hz[pair])
        seen = amplitude * np.sinc(error_hz * INTEGRATION_S)
        first = seen + noise[2 * pair]
        second = seen * np.exp(2j * math.pi * INTEGRATION_S * error_hz) + noise[2 * pair + 1]
        measured_hz = to_hz * (first.conj() * second).imag
        rate_hzps += rate_gain * measured_hz
        tracked_hz = tracked_hz + (rate_hzps + gain * measured_hz) * PAIR_S
    return errors_hz


def in_lock(errors_hz: Floats) -> NDArray[np.bool_]:
    """Whether lock has held from the first pair to each, in the shape of the errors."""
    return np.logical_and.accumulate(np.abs(errors_hz) <= LOST_HZ, axis=0)


def lost(errors_hz: Floats) -> NDArray[np.bool_]:
    """Whether lock was lost at any pair, shape (levels, runs)."""
    beyond: NDArray[np.bool_] = np.any(np.abs(errors_hz) > LOST_HZ, axis=0)
    return beyond
