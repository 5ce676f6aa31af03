"""Pure: how often a source usually reports, learned from the times of its reports."""

import msgspec

REMEMBERED = 9
"""Intervals; their median is the usual one, whatever outages are among them."""
UNKNOWN_S = 1.0
"""Until a second report has come; most receivers tell one a second."""


class Cadence(msgspec.Struct, frozen=True, gc=False):
    """Of one source."""

    last_ns: int | None = None
    intervals_ns: tuple[int, ...] = ()
    usual_s: float = UNKNOWN_S
    """Median of the last intervals."""

    def noticed(self, t_ns: int) -> "Cadence":
        """With one more report; one that is no later than the last tells nothing."""
        if self.last_ns is None:
            return Cadence(t_ns)
        if t_ns <= self.last_ns:
            return self
        intervals_ns = (*self.intervals_ns, t_ns - self.last_ns)[-REMEMBERED:]
        usual_ns = sorted(intervals_ns)[(len(intervals_ns) - 1) // 2]
        return Cadence(t_ns, intervals_ns, usual_ns / 1e9)
