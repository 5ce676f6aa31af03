"""Pure: instants that were overtaken on their way, told from a clock that stepped back."""

from collections import deque
from itertools import pairwise

from wayline_gps_ingest.cycle import LATE_MAX_NS

REMEMBERED = 512
"""Instants; more than a receiver tells in twice the time by which one may be late."""
KNOWN_FROM = 6
"""Instants between which the receiver's period is among the steps."""
SHARE_OF_PERIOD = 0.6
"""An instant that was overtaken lies nearly a period from those around it; after a step of the
clock it lies anywhere between two that are one period apart, so never this far from both."""


class Latecomers:
    """Knows an instant that was overtaken by the hole that its being late has left.

    A link or a logger brings sentences out of order by up to 2 s. Their instants are right, but
    later ones went out already; a clock that steps back fills no hole: it tells the same instants
    again, or some between them.
    """

    def __init__(self) -> None:
        self._told: deque[int] = deque(maxlen=REMEMBERED)
        self.dropped = 0
        """Instants that came too late."""

    def is_late(self, raw_ns: int) -> bool:
        """Whether an instant was overtaken; it is counted if so, and else remembered as told."""
        told = self._told
        if not told or raw_ns > told[-1]:
            told.append(raw_ns)
            return False
        if not (0 < told[-1] - raw_ns <= LATE_MAX_NS and self._fills_hole(raw_ns)):
            told.clear()
            told.append(raw_ns)
            return False
        self.dropped += 1
        self._remember(raw_ns)
        return True

    def _fills_hole(self, raw_ns: int) -> bool:
        """Whether an instant lies a period from its neighbours; anywhere while none is known."""
        told = self._told
        apart_ns = min(abs(each - raw_ns) for each in told)
        if len(told) < KNOWN_FROM:
            return apart_ns > 0
        period_ns = min(after - before for before, after in pairwise(told))
        return apart_ns >= SHARE_OF_PERIOD * period_ns

    def _remember(self, raw_ns: int) -> None:
        """The hole is filled: the same instant again would be a clock that stepped."""
        self._told = deque(sorted((*self._told, raw_ns)), maxlen=REMEMBERED)
