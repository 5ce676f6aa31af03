"""Pure: how wide a range of arrivals must be to hold what it says, by how earlier ones held.

A forecast's range is made from variances that are models. Each forecast is compared with what
came: how many of its half widths the arrival was early or late. The 10 % and 90 % quantiles of
those, by minutes ahead, scale the next ones (split conformal prediction; Vovk 2005), beside some
made-up ones that a true model would give.
"""

import bisect
from collections import deque
from typing import NamedTuple

MINUTES = (3.0, 6.0, 10.0, 15.0)
"""Ends of the spans of minutes ahead that are scaled alike."""
SPANS = len(MINUTES) + 1
KINDS = 2 * SPANS
"""Forecasts by the plan are wrong by other shares of their ranges than those that were learned."""
REMEMBERED = 600
"""Forecasts of each span; older ones are forgotten."""
BELIEVED = 6
"""So many made-up ones stand beside them."""
SHARE = 0.1
"""Of arrivals before the range, and of those after it."""
LEAST, MOST = 0.25, 6.0


class Scale(NamedTuple):
    """What half widths are multiplied by."""

    early: float = 1.0
    late: float = 1.0


def span_of(ahead_s: float, *, learned: bool) -> int:
    """Which span an arrival so far ahead is of; the learned ones come after the planned ones."""
    return bisect.bisect_right(MINUTES, ahead_s / 60.0) + learned * SPANS


class Ranges:
    """Of the arrivals on the legs of one plan."""

    def __init__(self) -> None:
        self._off = [deque[float](maxlen=REMEMBERED) for _ in range(KINDS)]
        self._ranked: list[list[float]] = [[] for _ in range(KINDS)]

    def learn(self, span: int, off: float) -> None:
        """Take a forecast that came: by how many half widths late (negative: early)."""
        offs, ranked = self._off[span], self._ranked[span]
        if len(offs) == REMEMBERED:
            del ranked[bisect.bisect_left(ranked, offs[0])]
        offs.append(off)
        bisect.insort(ranked, off)

    def scales(self) -> list[Scale]:
        """What the ranges of each span are to be scaled by: the planned ones, then the learned."""
        return list(map(_scale, self._ranked))


def _scale(ranked: list[float]) -> Scale:
    """By the forecasts of one span that have come, in rising order."""
    held = len(ranked) / (len(ranked) + BELIEVED)
    return Scale(
        _bounded(held * -_quantile(ranked, SHARE) + 1.0 - held),
        _bounded(held * _quantile(ranked, 1.0 - SHARE) + 1.0 - held),
    )


def _quantile(ranked: list[float], share: float) -> float:
    return ranked[min(int(share * len(ranked)), len(ranked) - 1)] if ranked else 0.0


def _bounded(scale: float) -> float:
    return min(max(scale, LEAST), MOST)
