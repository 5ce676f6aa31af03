"""Pure: dates for times of day, and an output time that never goes back."""

import datetime as dt

SECOND_NS = 1_000_000_000
DAY_NS = 86_400 * SECOND_NS
EPOCH = dt.date(1970, 1, 1)


class Timeline:
    """Puts a day to times of day.

    The day comes from a date that the receiver sent with a fix, or from the `first_day` given for
    a log whose sentences carry none; from then on the instant nearest to the last one is meant,
    which follows midnight in either direction. Today's date is never taken.
    """

    def __init__(self, first_day: dt.date | None = None) -> None:
        self._first_day = first_day
        self._last_ns: int | None = None

    def instant_ns(self, time_ns: int, day: dt.date | None) -> int | None:
        """Unix time of a time of day, with the day sent beside it if any; None: day unknown."""
        if day is None and self._last_ns is None:
            day = self._first_day
        if day is not None:
            self._last_ns = (day - EPOCH).days * DAY_NS + time_ns
        elif self._last_ns is not None:
            self._last_ns = nearest_ns(time_ns, self._last_ns)
        return self._last_ns


def nearest_ns(time_ns: int, near_ns: int) -> int:
    """The instant with this time of day that is nearest to another."""
    return near_ns + (time_ns - near_ns + DAY_NS // 2) % DAY_NS - DAY_NS // 2


class SteadyClock:
    """Keeps published instants from going back, and one corrupt time from moving them ahead.

    A receiver that learns of a leap second steps back by seconds: what it says until its clock has
    passed the last instant is dropped, because the later times are the right ones. A clock that
    steps back further is not waited for: it is moved on by a constant, until it returns past
    the last instant by itself. A step ahead by a day and more must be confirmed by the next fix.
    """

    WAIT_NS = 20 * SECOND_NS
    """More than GPS time is ahead of UTC."""
    STEP_NS = SECOND_NS
    CONFIRM_NS = 60 * SECOND_NS
    UNFIXED_NS = 3600 * SECOND_NS
    """A receiver without a fix keeps time by itself; it is believed this far."""

    def __init__(self) -> None:
        self._last_ns: int | None = None
        self._offset_ns = 0
        self._doubted_ns: int | None = None
        self.faults = 0
        """Instants that were dropped or moved."""

    def repeat_ns(self, raw_ns: int) -> int | None:
        """The instant of a repeated fix: the last one once more, else None."""
        last_ns = self._last_ns
        return last_ns if raw_ns + self._offset_ns == last_ns else None

    def unfixed_ns(self, raw_ns: int) -> int | None:
        """The instant of an epoch without a fix, or None where it does not follow the last."""
        ahead_ns = raw_ns + self._offset_ns - (self._last_ns or 0)
        if self._last_ns is not None and not 0 < ahead_ns <= self.UNFIXED_NS:
            self.faults += 1
            return None
        self._last_ns = raw_ns + self._offset_ns
        return self._last_ns

    def fixed_ns(self, raw_ns: int) -> int | None:
        """The instant of a fix, or None if it is to be dropped."""
        if self._is_doubtful(raw_ns) or self._is_passing(raw_ns):
            self.faults += 1
            return None
        last_ns = self._last_ns
        if last_ns is None or raw_ns > last_ns:
            self._offset_ns = 0
        elif raw_ns + self._offset_ns <= last_ns:
            self._offset_ns = last_ns + self.STEP_NS - raw_ns
        self.faults += self._offset_ns != 0
        self._last_ns = raw_ns + self._offset_ns
        return self._last_ns

    def _is_doubtful(self, raw_ns: int) -> bool:
        """Whether an instant is more than a day ahead and not confirmed by the one before."""
        before_ns, self._doubted_ns = self._doubted_ns, None
        if self._last_ns is None or raw_ns - self._last_ns < DAY_NS:
            return False
        if before_ns is not None and 0 <= raw_ns - before_ns <= self.CONFIRM_NS:
            return False
        self._doubted_ns = raw_ns
        return True

    def _is_passing(self, raw_ns: int) -> bool:
        """Whether the clock stepped back by so little that it will soon be past the last."""
        if self._last_ns is None or self._offset_ns:
            return False
        return 0 <= self._last_ns - raw_ns <= self.WAIT_NS
