"""Pure: which departure a vehicle waits for that is at the end of a trip, or at its first one's.

A vehicle that is ready leaves at its time, or soon after it has come, and never early; the first
departure that the timetable leaves time for is its own, unless it lets that go.
"""

from collections.abc import Iterator
from typing import NamedTuple

from wayline.geo import step_between
from wayline.timetable.runs import Run, Runs
from wayline_eta.lines_followed import LinesFollowed
from wayline_eta.route_follower import RouteFollower
from wayline_eta.trip_fit import EARLY_S, LATE_S, Followed

LAYOVER_S = 1_800.0
"""A vehicle that has ended a trip waits at most so long for the next one to be told of it."""
TERMINAL_M = 100.0
"""Trips that begin within this of a place begin there."""
TURN_S = 60.0
"""A late vehicle is ready again so long after its arrival."""
SET_OUT_EARLY_COUNTS = 10.0
"""Of a vehicle that sets out: a second early counts as so many late."""


class Waiting(NamedTuple):
    """A vehicle at a terminal, in degrees."""

    lat_deg: float
    lon_deg: float
    came_ns: int | None = None
    """At the end of a trip; None for a vehicle that came from elsewhere."""
    planned_ns: int = 0
    """When that trip should have ended."""

    def off_s(self, run: Run, t_ns: int, early_counts: float = 1.0) -> float:
        """Between an instant and that at which the vehicle sets out for a trip, if it is this."""
        ready_ns = run.departs_ns
        if self.came_ns is not None:
            ready_ns = max(ready_ns, self.came_ns + round(TURN_S * 1e9))
        off_s = (t_ns - ready_ns) * 1e-9
        return max(off_s, -early_counts * off_s)

    def departures(
        self, lines: LinesFollowed, runs: Runs, t_ns: int, early_counts: float = 1.0
    ) -> Iterator[Followed]:
        """Of every line that begins there the likeliest departure; none for one that is away."""
        for place in list(lines):
            if not self._is_where_begins(lines[place]):
                continue
            fitting = [run for run in runs.of_pattern(place, t_ns) if self._may_be(run, t_ns)]
            if fitting:
                best = min(fitting, key=lambda run: self.off_s(run, t_ns, early_counts))
                yield Followed(best, lines[place])

    def _is_where_begins(self, follower: RouteFollower) -> bool:
        """Whether a line begins at this terminal, and the vehicle is still near to it."""
        first = follower.route.stops[0]
        step = step_between(self.lat_deg, self.lon_deg, first.lat_deg, first.lon_deg)
        return step.distance_m <= TERMINAL_M and follower.offset_m <= TERMINAL_M

    def _may_be(self, run: Run, t_ns: int) -> bool:
        """Whether a trip is not over yet, and none that left before the vehicle can have come."""
        waits_s = (run.departs_ns - t_ns) * 1e-9
        most_s = EARLY_S if self.came_ns is None else LAYOVER_S
        ready_ns = self.planned_ns + round(TURN_S * 1e9)
        return run.departs_ns >= ready_ns and -LATE_S <= waits_s <= most_s
