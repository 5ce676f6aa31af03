"""Pure: keeps a source's time from running backwards when its clock is set back mid-log."""

SMALL_DISORDER_NS = 100_000_000
"""Frames of several channels may be logged this much out of order; that is no clock step."""


class SteadyClock:
    """Rebases times after a step back and undoes it when the clock returns (SPEC section 3)."""

    def __init__(self) -> None:
        self.steps = 0
        """How often the clock stepped back."""
        self._rebase_ns = 0
        self._last_ns = 0

    def steady(self, t_ns: int) -> int:
        """The time to use for a reading; never less than for the reading before."""
        if t_ns >= self._last_ns:
            self._rebase_ns, self._last_ns = 0, t_ns
            return t_ns
        if t_ns + self._rebase_ns < self._last_ns - SMALL_DISORDER_NS:
            self._rebase_ns = self._last_ns - t_ns
            self.steps += 1
        self._last_ns = max(self._last_ns, t_ns + self._rebase_ns)
        return self._last_ns
