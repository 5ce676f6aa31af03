"""Pure: the Allan deviation, which shows over how long an average of a sensor's rate improves."""

import numpy as np

from wayline_simulator.journey import Floats


def allan_deviation(rates: Floats, rate_hz: float, clusters: list[int]) -> tuple[Floats, Floats]:
    """Averaging times in s and the overlapping Allan deviation at each, shape (m,).

    IEEE Std 952-1997 annex C with all overlapping pairs of clusters; `clusters` are lengths in
    samples, 2 n + 1 <= len(rates).
    """
    angles = np.concatenate(([0.0], np.cumsum(rates))) / rate_hz
    taus_s = np.asarray(clusters, dtype=np.float64) / rate_hz
    deviations = [
        np.sqrt(np.mean((angles[2 * n :] - 2.0 * angles[n:-n] + angles[: -2 * n]) ** 2) / 2.0)
        for n in clusters
    ]
    return taus_s, np.asarray(deviations) / taus_s


def cluster_lengths(count: int, a_decade: int = 8) -> list[int]:
    """Lengths for `allan_deviation` from one sample to a third of them, evenly on a log scale."""
    decades = np.log10(max(count // 3, 1))
    lengths = np.logspace(0.0, decades, int(decades * a_decade) + 1)
    return [int(length) for length in np.unique(np.round(lengths))]
