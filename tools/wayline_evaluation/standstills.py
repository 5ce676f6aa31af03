"""Pure: when a vehicle stood, and what a sensor said in these times."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from wayline_evaluation.estimates import Floats

MARGIN_S = 2.0
"""Left out at both ends: wheels below their dead zone still creep, receivers' filters settle."""
SHORTEST_S = 2.0
GAP_MAX_S = 3.5
"""Longer without a sample, nobody knows whether it stood; css-164's holes are up to 3 s."""
Values = TypeVar("Values", bound=np.generic)


class Span(NamedTuple):
    """A time, Unix seconds."""

    first_s: float
    last_s: float

    @property
    def length_s(self) -> float:
        """How long it is."""
        return self.last_s - self.first_s


def standstills(times_s: Floats, still: NDArray[np.bool_]) -> tuple[Span, ...]:
    """Times in which every sample says that the vehicle stands, less the margins."""
    return tuple(
        span
        for first_s, last_s in _stretches(times_s, still)
        if (span := Span(first_s + MARGIN_S, last_s - MARGIN_S)).length_s >= SHORTEST_S
    )


def _stretches(times_s: Floats, still: NDArray[np.bool_]) -> Iterator[tuple[float, float]]:
    breaks = np.diff(times_s) > GAP_MAX_S
    together = still[1:] & still[:-1] & ~breaks
    edges = np.flatnonzero(np.diff(together, prepend=False, append=False))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        yield float(times_s[first]), float(times_s[last])


def within(
    times_s: Floats, values: NDArray[Values], spans: Sequence[Span]
) -> Iterator[NDArray[Values]]:
    """The values in each of the spans; `times_s` in ascending order."""
    for span in spans:
        first, last = np.searchsorted(times_s, (span.first_s, span.last_s))
        yield values[first:last]


def windows(spans: Sequence[Span], length_s: float) -> Iterator[Span]:
    """Spans of that length, as many as fit: what drifts does so the more, the longer it lasts."""
    for span in spans:
        for number in range(int(span.length_s / length_s)):
            first_s = span.first_s + number * length_s
            yield Span(first_s, first_s + length_s)
