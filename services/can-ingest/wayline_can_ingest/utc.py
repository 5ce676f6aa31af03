"""Pure: how far the clock of a drive's buses is from UTC."""

from wayline.drive import CanMapping
from wayline_can_ingest.plan import FramePlan
from wayline_can_ingest.quantity import CLOCK, Latest

EARLIEST_S, LATEST_S = 946_684_800.0, 4_102_444_800.0
"""2000 and 2100: a clock that says anything else has not been set."""


class DriveClock:
    """A clock for all buses of a drive; the clock signal of one bus sets it."""

    def __init__(self, offset_ns: int | None) -> None:
        self.offset_ns = offset_ns
        """Added to times of frames; None until the clock signal has come."""

    @classmethod
    def of(cls, source: CanMapping) -> "DriveClock":
        """As a source's own configuration says."""
        return cls(None if source.clock else round(source.clock_offset_s * 1e9))


def clock_value_s(plan: FramePlan, data: bytes, latest: Latest) -> float | None:
    """UTC that a frame tells, None where it tells none."""
    for extractor in plan.extractors:
        if extractor.quantity == CLOCK:
            value = extractor.read(plan.decode(data), latest)
            if value is not None and EARLIEST_S <= float(value) <= LATEST_S:
                return float(value)
    return None
