"""Pure: a distance counter that wraps and restarts, as a distance that only grows."""

FASTEST_MPS = 100.0
"""No road vehicle is faster: a counter that steps by more than this was not driven."""
SLACK_M = 50.0
"""A counter's steps and a late reading: 10 of the coarsest steps, 5 m."""
SILENT_NS = 10_000_000_000
"""A unit that has not counted this long gives way to another one with the same message."""


class Unwrapped:
    """Takes the wraps out of a counter (16 and 32 bit alike).

    A step that the vehicle cannot have driven, through the wrap or not, is a unit that restarted
    or read its memory late: its count holds from there, but the distance never falls. Two units
    may send the same message: one at a time is read.
    """

    def __init__(self, span_m: float) -> None:
        self._span_m = span_m
        self._unit: int | None = None
        self._t_ns = 0
        self._counted_m = 0.0
        self._added_m = 0.0
        """What wraps and restarts have taken from the count."""

    def distance_m(self, counted_m: float, t_ns: int, unit: int) -> float | None:
        """The cumulative distance when a unit has counted so far; None for one not read."""
        if self._unit is None:
            self._unit, self._counted_m = unit, counted_m
        elif unit != self._unit:
            if t_ns - self._t_ns <= SILENT_NS:
                return None
            self._unit = unit
        self._added_m = self._added(counted_m, t_ns)
        self._counted_m, self._t_ns = counted_m, t_ns
        return counted_m + self._added_m

    def _added(self, counted_m: float, t_ns: int) -> float:
        """What to add from now on: one more span after a wrap; after a restart what is missing."""
        step_m = counted_m - self._counted_m
        elapsed_s = max(t_ns - self._t_ns, 0) * 1e-9
        farthest_m = FASTEST_MPS * elapsed_s + SLACK_M
        if 0.0 <= step_m <= farthest_m:
            return self._added_m
        if 0.0 <= step_m + self._span_m <= farthest_m:
            return self._added_m + self._span_m
        return max(self._counted_m + self._added_m - counted_m, 0.0)
