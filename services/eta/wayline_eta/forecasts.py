"""Pure: what was forecast of a vehicle's arrivals, kept until each has come."""

from collections.abc import Iterator
from typing import NamedTuple

from wayline_eta.ranges import span_of

EVERY_NS = 60_000_000_000
"""One forecast a minute of each stop is remembered."""
LONGEST_S = 3_600.0
"""Older forecasts are not compared: the vehicle has been elsewhere since."""
KEPT_MAX = 64
"""Forecasts of one stop."""


class Forecast(NamedTuple):
    """Of one arrival, as it was told."""

    made_ns: int
    arrival_ns: int
    early_width_ns: int
    """From the model's own p10 to its p50, before it was scaled; and on to its p90."""
    late_width_ns: int
    is_learned: bool = False
    """Somebody has driven the whole way there."""


class Came(NamedTuple):
    """A forecast whose arrival has come."""

    made_ns: int
    span: int
    """Of the minutes ahead, and whether it was learned (`ranges`)."""
    off: float
    """By how many of its half widths the arrival was late; negative: early."""


class Forecasts:
    """Of one vehicle on one route, by stop."""

    def __init__(self) -> None:
        self._made: dict[int, list[Forecast]] = {}
        self._last_ns = 0

    def is_due(self, t_ns: int) -> bool:
        """Whether a minute has passed since forecasts were last remembered."""
        return t_ns - self._last_ns >= EVERY_NS

    def make(self, stop: int, forecast: Forecast) -> None:
        """Remember a forecast of a stop."""
        self._last_ns = forecast.made_ns
        made = self._made.setdefault(stop, [])
        if len(made) == KEPT_MAX:
            del made[0]
        made.append(forecast)

    def arrive(self, stop: int, arrived_ns: int) -> Iterator[Came]:
        """Compare what was forecast of a stop with when the vehicle came there, one a span.

        Forecasts a minute apart are wrong alike, so of those that were made in the same span of
        minutes ahead the one in the middle tells enough.
        """
        spans: dict[int, list[Forecast]] = {}
        for made in self._made.pop(stop, ()):
            ahead_s = (arrived_ns - made.made_ns) * 1e-9
            if 0.0 < ahead_s < LONGEST_S:
                spans.setdefault(span_of(ahead_s, learned=made.is_learned), []).append(made)
        for span, alike in spans.items():
            made = alike[len(alike) // 2]
            off_ns = arrived_ns - made.arrival_ns
            width_ns = made.late_width_ns if off_ns >= 0 else made.early_width_ns
            yield Came(made.made_ns, span, off_ns / max(width_ns, 1))
