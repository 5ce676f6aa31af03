"""Pure: dates for times of day."""

import datetime as dt

SECOND_NS = 1_000_000_000
DAY_NS = 86_400 * SECOND_NS
EPOCH_ORDINAL = dt.date(1970, 1, 1).toordinal()


ERA_NS = 1024 * 7 * DAY_NS
"""GPS counts weeks to 1024; an old receiver's date then starts again 19.6 years in the past."""


class Dates:
    """Puts a day to times of day.

    The day comes from a date that the receiver sent with a fix, or from the `first_day` given for
    a log whose sentences carry none; from then on the instant nearest to the last one is meant,
    which follows midnight in either direction. Today's date is never taken.

    A date that is whole eras of the week counter before the sentence's receipt, or before the last
    fix, is moved on by them; nothing is changed where the two do not agree to the day.
    """

    def __init__(self, first_day: dt.date | None = None) -> None:
        self._first_day = first_day
        self._last_ns: int | None = None

    def instant_ns(
        self, time_ns: int, dated_ns: int | None, received_ns: int | None = None
    ) -> int | None:
        """Unix time of a time of day, None where no day is known.

        `dated_ns` is the instant of the sentence beside it that carried a date, where one did: its
        time may be another one's, and midnight between them.
        """
        if dated_ns is None and self._last_ns is None and self._first_day is not None:
            dated_ns = instant_of(self._first_day, time_ns)
        if dated_ns is not None:
            told_ns = nearest_ns(time_ns, dated_ns)
            self._last_ns = in_era_of(in_era_of(told_ns, received_ns), self._last_ns)
        elif self._last_ns is not None:
            self._last_ns = nearest_ns(time_ns, self._last_ns)
        return self._last_ns


def instant_of(day: dt.date, time_ns: int | None) -> int:
    """Unix time of a day's time; noon, from which the day is near, where the time is not known."""
    days = day.toordinal() - EPOCH_ORDINAL
    return days * DAY_NS + (DAY_NS // 2 if time_ns is None else time_ns)


def nearest_ns(time_ns: int, near_ns: int) -> int:
    """The instant with this time of day that is nearest to another."""
    return near_ns + (time_ns - near_ns + DAY_NS // 2) % DAY_NS - DAY_NS // 2


def in_era_of(t_ns: int, known_ns: int | None) -> int:
    """An instant moved on by whole eras where that brings it to the day of a known one."""
    if known_ns is None:
        return t_ns
    eras, rest_ns = divmod(known_ns - t_ns + DAY_NS, ERA_NS)
    return t_ns + eras * ERA_NS if eras > 0 and rest_ns < 2 * DAY_NS else t_ns
