"""Pure: how good predicted arrivals were, by how far ahead they were made.

The error is when the vehicle came minus when it was said to. A range holds where it came within it.
Yardsticks, with the time to go in minutes: the ETA Accuracy Benchmark, by the actual time to go;
MBTA's table and Cal-ITP's bounds, by the predicted one. What is scored are sums, so that those of
vehicles, lines and days add up to what all their predictions would give.
"""

from collections.abc import Iterable, Sequence
from functools import reduce
from typing import NamedTuple, TypeAlias

import msgspec
import numpy as np
from numpy.typing import NDArray

SPANS_MIN = ((0.0, 3.0), (3.0, 6.0), (6.0, 10.0), (10.0, 15.0), (15.0, 30.0))
BENCHMARK_MIN = ((-0.5, 1.5), (-1.0, 2.5), (-1.0, 3.5), (-1.5, 4.5))
"""Of the first four spans; later ones have none."""
MBTA_SPANS_MIN = ((0.0, 3.0), (3.0, 6.0), (6.0, 12.0), (12.0, 30.0))
MBTA_MIN = ((-1.0, 1.0), (-1.5, 2.0), (-2.5, 3.5), (-4.0, 6.0))
"""Of its own spans."""

Floats: TypeAlias = NDArray[np.float64]
Flags: TypeAlias = NDArray[np.bool_]


class Prediction(NamedTuple):
    """One arrival as it was told once, and when it came; in seconds from when it was told."""

    predicted_s: float
    early_s: float
    late_s: float
    actual_s: float | None
    """None: it never came."""


class SpanSums(msgspec.Struct, frozen=True):
    """Of the predictions so many minutes before the arrival."""

    count: int = 0
    error_s: float = 0.0
    absolute_s: float = 0.0
    square_s2: float = 0.0
    in_benchmark: int = 0
    in_cal_itp: int = 0
    held: int = 0

    def plus(self, other: "SpanSums") -> "SpanSums":
        """Of both."""
        mine, others = msgspec.structs.astuple(self), msgspec.structs.astuple(other)
        return SpanSums(*(one + two for one, two in zip(mine, others, strict=True)))


class MbtaSums(msgspec.Struct, frozen=True):
    """Of the predictions that gave so many minutes."""

    count: int = 0
    good: int = 0

    def plus(self, other: "MbtaSums") -> "MbtaSums":
        """Of both."""
        return MbtaSums(self.count + other.count, self.good + other.good)


class Sums(msgspec.Struct, frozen=True, kw_only=True):
    """What adds up over vehicles, lines and days."""

    predictions: int = 0
    ghosts: int = 0
    """Predictions of arrivals that never came."""
    arrivals: int = 0
    """Stops that vehicles came to."""
    on_route_s: int = 0
    told_s: int = 0
    """Of the seconds on a route, those with a prediction."""
    spans: tuple[SpanSums, ...] = (SpanSums(),) * len(SPANS_MIN)
    mbta: tuple[MbtaSums, ...] = (MbtaSums(),) * len(MBTA_SPANS_MIN)

    def plus(self, other: "Sums") -> "Sums":
        """Of both."""
        return Sums(
            predictions=self.predictions + other.predictions,
            ghosts=self.ghosts + other.ghosts,
            arrivals=self.arrivals + other.arrivals,
            on_route_s=self.on_route_s + other.on_route_s,
            told_s=self.told_s + other.told_s,
            spans=tuple(one.plus(two) for one, two in zip(self.spans, other.spans, strict=True)),
            mbta=tuple(one.plus(two) for one, two in zip(self.mbta, other.mbta, strict=True)),
        )


NOTHING = Sums()


class SpanScore(msgspec.Struct, frozen=True, kw_only=True):
    """Of the predictions so many minutes ahead; null where there are none."""

    from_min: float
    to_min: float
    count: int
    mean_s: float | None
    mean_absolute_s: float | None
    std_s: float | None
    benchmark_share: float | None
    """In the ETA Accuracy Benchmark's bounds; null beyond 15 minutes."""
    cal_itp_share: float | None
    held_share: float | None
    """Within the range from p10 to p90."""


class MbtaScore(msgspec.Struct, frozen=True, kw_only=True):
    """Of the predictions that gave so many minutes, those in MBTA's bounds."""

    from_min: float
    to_min: float
    count: int
    share: float | None


class Score(msgspec.Struct, frozen=True, kw_only=True):
    """How good predictions were; null where there are none."""

    predictions: int
    arrivals: int
    """Stops that vehicles came to."""
    told_share: float | None
    """Of the seconds on the route, those with a prediction."""
    ghost_share: float | None
    """Of the predictions, those of arrivals that never came."""
    spans: tuple[SpanScore, ...]
    """By the minutes that it took."""
    benchmark_share: float | None
    """The mean of the first four spans."""
    mbta: tuple[MbtaScore, ...]
    """By the minutes that were told."""
    mbta_share: float | None
    """Of all predictions in MBTA's spans."""


def sums_of(predictions: Sequence[Prediction]) -> Sums:
    """The sums of some predictions."""
    rows = [each for each in predictions if each.actual_s is not None]
    columns = np.array(rows, dtype=np.float64).reshape(-1, 4).T
    predicted_s, early_s, late_s, actual_s = columns
    errors_s = actual_s - predicted_s
    held = (early_s <= actual_s) & (actual_s <= late_s)
    cal_itp = _in_cal_itp(errors_s, np.maximum(predicted_s / 60.0, 0.0))
    bounds = (*BENCHMARK_MIN, None)
    return Sums(
        predictions=len(predictions),
        ghosts=len(predictions) - len(rows),
        spans=tuple(
            _span_sums(errors_s[at], held[at], cal_itp[at], bound)
            for at, bound in zip(_within(actual_s, SPANS_MIN), bounds, strict=True)
        ),
        mbta=tuple(
            MbtaSums(int(at.sum()), int(_in_bounds(errors_s[at], bound).sum()))
            for at, bound in zip(_within(predicted_s, MBTA_SPANS_MIN), MBTA_MIN, strict=True)
        ),
    )


def _within(ahead_s: Floats, spans_min: Iterable[tuple[float, float]]) -> list[Flags]:
    return [(ahead_s >= 60.0 * low) & (ahead_s < 60.0 * high) for low, high in spans_min]


def _in_bounds(errors_s: Floats, bounds_min: tuple[float, float]) -> Flags:
    low_min, high_min = bounds_min
    return np.asarray((errors_s >= 60.0 * low_min) & (errors_s <= 60.0 * high_min))


def cal_itp_bounds_s(ahead_min: Floats) -> tuple[Floats, Floats]:
    """How early and how late a vehicle may be that was told to come in so many minutes."""
    return -60.0 * np.log(ahead_min + 1.3), 60.0 * np.log(ahead_min + 1.5)


def _in_cal_itp(errors_s: Floats, ahead_min: Floats) -> Flags:
    earliest_s, latest_s = cal_itp_bounds_s(ahead_min)
    return np.asarray((errors_s > earliest_s) & (errors_s < latest_s))


def _span_sums(
    errors_s: Floats, held: Flags, cal_itp: Flags, benchmark: tuple[float, float] | None
) -> SpanSums:
    return SpanSums(
        count=len(errors_s),
        error_s=float(np.sum(errors_s)),
        absolute_s=float(np.sum(np.abs(errors_s))),
        square_s2=float(np.sum(errors_s**2)),
        in_benchmark=0 if benchmark is None else int(_in_bounds(errors_s, benchmark).sum()),
        in_cal_itp=int(cal_itp.sum()),
        held=int(held.sum()),
    )


def added(sums: Iterable[Sums]) -> Sums:
    """All of them."""
    return reduce(Sums.plus, sums, NOTHING)


def score_of(sums: Sums) -> Score:
    """What sums say."""
    bounds = (*BENCHMARK_MIN, None)
    spans = tuple(
        _span_score(span, each, has_benchmark=bound is not None)
        for span, each, bound in zip(SPANS_MIN, sums.spans, bounds, strict=True)
    )
    shares = [each.benchmark_share for each in spans if each.benchmark_share is not None]
    return Score(
        predictions=sums.predictions,
        arrivals=sums.arrivals,
        told_share=_share(sums.told_s, sums.on_route_s),
        ghost_share=_share(sums.ghosts, sums.predictions),
        spans=spans,
        benchmark_share=_share(sum(shares), len(shares)),
        mbta=tuple(
            MbtaScore(
                from_min=low, to_min=high, count=each.count, share=_share(each.good, each.count)
            )
            for (low, high), each in zip(MBTA_SPANS_MIN, sums.mbta, strict=True)
        ),
        mbta_share=_share(
            sum(each.good for each in sums.mbta), sum(each.count for each in sums.mbta)
        ),
    )


def _span_score(span: tuple[float, float], sums: SpanSums, *, has_benchmark: bool) -> SpanScore:
    count, mean_s = sums.count, _share(sums.error_s, sums.count)
    std_s = None
    if mean_s is not None:
        std_s = max(sums.square_s2 / count - mean_s**2, 0.0) ** 0.5
    return SpanScore(
        from_min=span[0],
        to_min=span[1],
        count=count,
        mean_s=mean_s,
        mean_absolute_s=_share(sums.absolute_s, count),
        std_s=std_s,
        benchmark_share=_share(sums.in_benchmark, count) if has_benchmark else None,
        cal_itp_share=_share(sums.in_cal_itp, count),
        held_share=_share(sums.held, count),
    )


def _share(part: float, whole: int) -> float | None:
    return part / whole if whole else None
