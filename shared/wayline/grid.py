"""Pure: the grid of instants on which periodic outputs lie (SPEC section 2)."""

from collections.abc import Iterator

from wayline.inputs import Tick

LONGEST_GAP_NS = 600_000_000_000
"""A longer silence (a parked vehicle, a clock set right) is skipped, not filled with ticks."""


class TickGrid:
    """Yields the ticks that a stream of measurement times makes due, each once, in order."""

    def __init__(self, period_ns: int) -> None:
        self._period_ns = period_ns
        self._next_ns: int | None = None

    def before(self, t_ns: int) -> Iterator[Tick]:
        """Ticks earlier than a message, to be handled before it."""
        if self._next_ns is None or t_ns - self._next_ns > LONGEST_GAP_NS:
            self._next_ns = -(-t_ns // self._period_ns) * self._period_ns
        while self._next_ns < t_ns:
            yield self._advance(self._next_ns)

    def at(self, t_ns: int) -> Iterator[Tick]:
        """The tick at a message's own instant, to be handled after it."""
        if self._next_ns == t_ns:
            yield self._advance(t_ns)

    def _advance(self, due_ns: int) -> Tick:
        self._next_ns = due_ns + self._period_ns
        return Tick(due_ns)
