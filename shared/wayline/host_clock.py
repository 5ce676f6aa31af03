"""The host's clock, as far as it is to be believed."""

import datetime as dt
import time
from typing import NamedTuple

from wayline import messages

EARLIEST_NS = int(dt.datetime(2026, 11, 1, tzinfo=dt.UTC).timestamp()) * 1_000_000_000
"""This program is younger; a clock without a battery starts in 1970 or at its last shutdown."""


def told_ns() -> int:
    """The host's Unix time for a message of its own; a clock before 1980 tells 1980."""
    return max(time.time_ns(), messages.EARLIEST_NS)


class HostTime(NamedTuple):
    """The host's Unix time, told so that no step of its clock makes a message older or newer."""

    earliest_ns: int
    latest_ns: int


class HostClock:
    """Unix time by two clocks, so that the step of one does no harm.

    The host's clock is read at the start and carried on by the monotonic one beside it. Ages go
    by the earlier of the two, what lies ahead by the later: neither a step forward nor a step
    back, nor its correction, ages or refuses a message.
    """

    def __init__(self) -> None:
        self._offset_ns: int | None = None

    def now(self) -> HostTime | None:
        """Nanoseconds since 1970; None while the clock is not plausible."""
        wall_ns = time.time_ns()
        if wall_ns < EARLIEST_NS:
            return None
        monotonic_ns = time.monotonic_ns()
        if self._offset_ns is None:
            self._offset_ns = wall_ns - monotonic_ns
        carried_ns = self._offset_ns + monotonic_ns
        return HostTime(min(wall_ns, carried_ns), max(wall_ns, carried_ns))
