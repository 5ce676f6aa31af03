"""Pure: an output time that never goes back, whatever the receiver's clock does."""

from typing import NamedTuple

from wayline_gps_ingest.dates import SECOND_NS
from wayline_gps_ingest.late_reports import LateReports
from wayline_gps_ingest.latecomers import Latecomers

SOON_NS = 20 * SECOND_NS
"""A step back by less is waited for; more than GPS time is ahead of UTC."""
PERIOD_MAX_NS = SECOND_NS
"""Between fixes, as far as instants after a step back are concerned."""
UNFIXED_MAX_NS = 3600 * SECOND_NS
"""A receiver without a fix keeps time by itself; it is believed this far."""


class StepBack(NamedTuple):
    """A clock that stepped back, and how its instants go on after the last before it."""

    last_ns: int
    """The last instant before the step."""
    raw_ns: int
    """What the clock said first after it."""
    period_ns: int
    """Between fixes before the step."""

    def instant_ns(self, raw_ns: int) -> int:
        """Slowed down where the clock will soon have caught up, else moved on by a constant.

        What is slowed has reached one period after the last instant just when the clock has.
        """
        back_ns, period_ns = self.last_ns - self.raw_ns, self.period_ns
        since_ns = raw_ns - self.raw_ns + period_ns
        if back_ns > SOON_NS:
            return self.last_ns + since_ns
        return self.last_ns + since_ns * period_ns // (back_ns + 2 * period_ns)


class OnwardClock:
    """Keeps published instants from going back.

    After a step back instants go on (`StepBack`) until the clock has passed the last of them. A
    receiver that learns of a leap second steps back by seconds: the later times are the right
    ones, so those in between are pressed together and none after them is ahead of its time.
    Steps ahead are followed: those that do not last never come here (`wayline.times_ahead`).
    """

    def __init__(self) -> None:
        self._last_ns: int | None = None
        self._period_ns = PERIOD_MAX_NS
        self._step: StepBack | None = None
        self._latecomers = Latecomers()
        self._late_reports = LateReports()
        self.faults = 0
        """Instants that were dropped or moved because the clock stepped."""

    @property
    def last_ns(self) -> int | None:
        """The instant that was published last."""
        return self._last_ns

    @property
    def late(self) -> int:
        """Instants that were overtaken on their way, and dropped."""
        return self._latecomers.dropped + self._late_reports.dropped

    def is_overtaken(self, raw_ns: int) -> bool:
        """Whether later instants than this one came before it, though the clock did not step."""
        return self._latecomers.is_late(raw_ns)

    def is_late_report(self, raw_ns: int) -> bool:
        """Whether a position report came again, or after a later one."""
        return self._late_reports.is_late(raw_ns)

    def repeat_ns(self, raw_ns: int) -> int | None:
        """The instant of a repeated fix: the last one once more, else None."""
        return self._last_ns if self._stepped_ns(raw_ns) == self._last_ns else None

    def unfixed_ns(self, raw_ns: int) -> int | None:
        """The instant of an epoch without a fix, or None where it does not follow the last."""
        t_ns, last_ns = self._stepped_ns(raw_ns), self._last_ns
        if last_ns is not None and not 0 < t_ns - last_ns <= UNFIXED_MAX_NS:
            self.faults += 1
            return None
        self._last_ns = t_ns
        return t_ns

    def fixed_ns(self, raw_ns: int) -> int | None:
        """The instant of a fix, or None if it was told already."""
        if raw_ns == self._last_ns:
            self.faults += 1
            return None
        last_ns = self._last_ns
        if last_ns is None or raw_ns > last_ns:
            if last_ns is not None and self._step is None:
                self._period_ns = min(raw_ns - last_ns, PERIOD_MAX_NS)
            self._step = None
            self._last_ns = raw_ns
            return raw_ns
        self.faults += 1
        if self._stepped_ns(raw_ns) <= last_ns:
            self._step = StepBack(last_ns, raw_ns, self._period_ns)
        self._last_ns = max(self._stepped_ns(raw_ns), last_ns)
        return self._last_ns

    def _stepped_ns(self, raw_ns: int) -> int:
        """What the clock says, and after a step back what is made of it."""
        if self._step is None or self._last_ns is None or raw_ns > self._last_ns:
            return raw_ns
        return self._step.instant_ns(raw_ns)
