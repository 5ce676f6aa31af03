"""Pure: how far the clock of a drive's buses is from UTC."""

from wayline.drive import CanMapping
from wayline.messages import LATEST_NS
from wayline.times_ahead import AHEAD_NS, Timed, TimesAhead
from wayline_can_ingest.plan import FramePlan
from wayline_can_ingest.quantity import CLOCK, Latest

EARLIEST_S, LATEST_S = 946_684_800.0, 4_102_444_800.0
"""2000 and 2100: a clock that says anything else has not been set."""


NEVER_NS = LATEST_NS + 1


class DriveClock:
    """A clock for all buses of a drive; the clock signal of one bus sets it.

    What the signal tells first may be nonsense: times far ahead of those of the frames wait for
    others that agree (`wayline.times_ahead`), as far as these are Unix time, from `clock_from_ns`
    on. What it tells counts from then on, so the first ones may wait in any case (`doubts_start`).
    """

    def __init__(
        self, offset_ns: int | None, *, doubts_start: bool = False, clock_from_ns: int = NEVER_NS
    ) -> None:
        self.offset_ns = offset_ns
        """Added to times of frames; None until the clock signal has come."""
        self._clock_from_ns = clock_from_ns
        self._ahead = TimesAhead[int](doubts_start=doubts_start)

    @classmethod
    def of(
        cls, source: CanMapping, *, doubts_start: bool = False, clock_from_ns: int = NEVER_NS
    ) -> "DriveClock":
        """As a source's own configuration says."""
        offset_ns = None if source.clock else round(source.clock_offset_s * 1e9)
        return cls(offset_ns, doubts_start=doubts_start, clock_from_ns=clock_from_ns)

    def hear(self, told_ns: int, frame_ns: int) -> None:
        """Take what the signal tells in a frame, both Unix ns, the latter by the frame's clock."""
        receipt_ns = frame_ns if frame_ns >= self._clock_from_ns else None
        self._set(self._ahead.take(told_ns, told_ns - frame_ns, receipt_ns))

    def settle(self) -> bool:
        """Make the best of what was told where nothing more will be; whether that is anything."""
        self._set(self._ahead.finish())
        return self.offset_ns is not None

    def _set(self, believed: list[Timed[int]]) -> None:
        if believed:
            _, last_ns = believed[-1]
            alike = [offset_ns for _, offset_ns in believed if abs(offset_ns - last_ns) <= AHEAD_NS]
            # a time is told late by up to its last digit and the frame's way, never early
            self.offset_ns = max(alike)


def clock_value_s(plan: FramePlan, data: bytes, latest: Latest) -> float | None:
    """UTC that a frame tells, None where it tells none."""
    for extractor in plan.extractors:
        if extractor.quantity == CLOCK:
            value = extractor.read(plan.decode(data), latest)
            if value is not None and EARLIEST_S <= float(value) <= LATEST_S:
                return float(value)
    return None
