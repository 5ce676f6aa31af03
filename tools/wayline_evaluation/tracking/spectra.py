"""Pure: spectra of what loops track (figure 9 of papers/001)."""

import msgspec
import numpy as np
from scipy.signal import welch

from wayline_evaluation.estimates import Floats
from wayline_evaluation.tracking.loop import PAIR_S

SEGMENT_S = 20.0


class Spectrum(msgspec.Struct, frozen=True, kw_only=True):
    """One-sided power spectral density of a tracked carrier's offset, mean over runs."""

    bandwidth_hz: float
    frequencies_hz: tuple[float, ...]
    density_hz2_per_hz: tuple[float, ...]
    power_hz2: float


def spectrum_of(errors_hz: Floats, bandwidth_hz: float) -> Spectrum:
    """By Welch's method, of errors of shape (pairs, runs)."""
    segment = min(round(SEGMENT_S / PAIR_S), len(errors_hz))
    frequencies_hz, densities = welch(errors_hz, fs=1.0 / PAIR_S, nperseg=segment, axis=0)
    return Spectrum(
        bandwidth_hz=bandwidth_hz,
        frequencies_hz=tuple(frequencies_hz.tolist()),
        density_hz2_per_hz=tuple(np.mean(densities, axis=1).tolist()),
        power_hz2=float(np.mean(np.square(errors_hz))),
    )
