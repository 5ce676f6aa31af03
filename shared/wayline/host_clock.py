"""The host's clock, as far as it is to be believed."""

import datetime as dt
import time

EARLIEST_NS = int(dt.datetime(2026, 11, 1, tzinfo=dt.UTC).timestamp()) * 1_000_000_000
"""This program is younger; a clock without a battery starts in 1970 or at its last shutdown."""


class HostClock:
    """Unix time that makes nothing older by a step.

    The clock is read at the start and carried on by the monotonic one beside it, and the earlier
    of the two is told: a step forward of the one or a correction of the other ages no message.
    """

    def __init__(self) -> None:
        self._offset_ns: int | None = None

    def now_ns(self) -> int | None:
        """Nanoseconds since 1970; None while the clock is not plausible."""
        wall_ns = time.time_ns()
        if wall_ns < EARLIEST_NS:
            return None
        monotonic_ns = time.monotonic_ns()
        if self._offset_ns is None:
            self._offset_ns = wall_ns - monotonic_ns
        return min(wall_ns, self._offset_ns + monotonic_ns)
