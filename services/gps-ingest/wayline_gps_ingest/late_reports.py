"""Pure: reports that come again, or after later ones, told from a clock that stepped back."""

STEPPED_AFTER = 4
"""So many reports in a row before the newest, each later than the one before: a clock stepped."""


class LateReports:
    """Knows a report that is no news: trackers send some twice, and hand old ones in later."""

    def __init__(self) -> None:
        self._newest_ns = 0
        self._late_ns = 0
        """The last one before the newest."""
        self._in_a_row = 0
        self.dropped = 0

    def is_late(self, t_ns: int) -> bool:
        """Whether a report tells nothing of now."""
        if t_ns <= self._newest_ns:
            goes_on = t_ns > self._late_ns
            self._in_a_row = self._in_a_row + 1 if goes_on else int(t_ns < self._newest_ns)
            self._late_ns = t_ns
            if self._in_a_row < STEPPED_AFTER:
                self.dropped += 1
                return True
        self._newest_ns, self._late_ns, self._in_a_row = t_ns, 0, 0
        return False
