"""Pure: figures of any sensor's samples."""

from collections.abc import Iterable, Sequence

import msgspec
import numpy as np
from scipy.stats import median_abs_deviation

from wayline_evaluation.estimates import Floats
from wayline_simulator.allan import allan_deviation, cluster_lengths

THIRD_DIFFERENCES = 20.0
"""Variance of white noise's third differences over its own: 1 + 9 + 9 + 1."""
STEP_DECIMALS = 6
"""Finer, values differ by the arithmetic of their conversion."""


class Quantiles(msgspec.Struct, frozen=True, kw_only=True):
    """The unit is in the name of what holds this."""

    p5: float
    p50: float
    p95: float


class AllanPoint(msgspec.Struct, frozen=True, kw_only=True):
    """How much averages over so long a time differ from one to the next."""

    tau_s: float
    deviation_degps: float


def quantiles_of(values: Floats) -> Quantiles | None:
    """Quantiles of the values that are known; None where none is."""
    known = values[~np.isnan(values)]
    if not len(known):
        return None
    p5, p50, p95 = (float(value) for value in np.percentile(known, [5, 50, 95]))
    return Quantiles(p5=p5, p50=p50, p95=p95)


def rate_of(series: Iterable[Floats]) -> float:
    """Samples a second, of the times of several drives; batches on one instant count."""
    spans = [(len(times_s) - 1, times_s[-1] - times_s[0]) for times_s in series if len(times_s) > 1]
    return sum(count for count, _ in spans) / sum(float(span_s) for _, span_s in spans)


def step_of(values: Floats) -> float | None:
    """The smallest difference between values that occur; None of fewer than two."""
    steps = np.diff(np.unique(np.round(values[~np.isnan(values)], STEP_DECIMALS)))
    return float(np.min(steps)) if len(steps) else None


def spread_of(pieces: Sequence[Floats]) -> float:
    """Std about each piece's own mean, all pooled; pieces are not empty."""
    return float(
        np.sqrt(np.mean(np.concatenate([(piece - piece.mean()) ** 2 for piece in pieces])))
    )


def lag_1_of(pieces: Sequence[Floats]) -> float | None:
    """Correlation of neighbours about each piece's own mean; None where nothing varies."""
    centred = [piece - piece.mean() for piece in pieces]
    power = sum(float(piece @ piece) for piece in centred)
    return sum(float(piece[1:] @ piece[:-1]) for piece in centred) / power if power else None


def roughness_of(third_differences: Floats) -> float | None:
    """Std of the white noise that has such third differences, whatever a few of them are."""
    known = third_differences[~np.isnan(third_differences)]
    if not len(known):
        return None
    return float(median_abs_deviation(known, scale="normal") / np.sqrt(THIRD_DIFFERENCES))


def allan_of(pieces: Sequence[Floats], rate_hz: float) -> tuple[AllanPoint, ...]:
    """Pooled over pieces, each with as many pairs as it has; a third of the longest is the end."""
    lengths = cluster_lengths(max(len(piece) for piece in pieces))
    points = []
    for cluster in lengths:
        long = [piece for piece in pieces if len(piece) >= 3 * cluster]
        pairs = [len(piece) - 2 * cluster + 1 for piece in long]
        squares = [allan_deviation(piece, rate_hz, [cluster])[1][0] ** 2 for piece in long]
        if long:
            deviation = float(np.sqrt(np.average(squares, weights=pairs)))
            points.append(AllanPoint(tau_s=cluster / rate_hz, deviation_degps=deviation))
    return tuple(points)
