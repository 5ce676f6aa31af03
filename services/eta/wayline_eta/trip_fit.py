"""Pure: how well a trip on a day fits what a vehicle does, by its place and by the time."""

from collections.abc import Callable, Iterable
from operator import itemgetter
from typing import NamedTuple

from wayline.timetable.runs import LineKey, Run
from wayline_eta.route_follower import RouteFollower

EARLY_S, LATE_S = 300.0, 1_800.0
"""A vehicle farther off a trip's timetable runs another one."""
EARLY_COUNTS = 3.0
"""Late buses are usual, early ones are not: a second early counts as three late."""
CLOSE_S = 180.0
"""Patterns of one line whose trips fit by time alike within this are not told apart."""
END_M = 60.0
"""A vehicle so near to its last stop that goes on elsewhere has served it; one so near to its
first stop has not set out."""


class Followed(NamedTuple):
    """A run with its follower."""

    run: Run
    follower: RouteFollower

    @property
    def is_served(self) -> bool:
        """Whether the last stop has been."""
        follower = self.follower
        last_m = float(self.run.trip_route.route.stop_distances_m[-1])
        return follower.served_m >= last_m - (1.0 if follower.on_route else END_M)

    @property
    def is_before_start(self) -> bool:
        """Whether the vehicle is at the first stop, or not yet there."""
        first_m = float(self.run.trip_route.route.stop_distances_m[0])
        return self.follower.total_m <= first_m + END_M

    def misfit(self, t_ns: int) -> float:
        """Seconds off the timetable, of a vehicle where it is; farther off the line is worse."""
        delay_s = self.run.delay_s(self.follower.total_m, t_ns)
        off_s = min(self.follower.offset_m, 10_000.0) / 10.0
        wait_s = max(self.waits_s(t_ns), 0.0) if self.is_before_start else 0.0
        return max(delay_s, -EARLY_COUNTS * delay_s) + off_s + wait_s

    def waits_s(self, t_ns: int) -> float:
        """Until the first departure."""
        return (self.run.departs_ns - t_ns) * 1e-9

    def is_in_time(self, t_ns: int, waits_s: float = EARLY_S) -> bool:
        """Whether a vehicle may run it, which waits at most so long for its departure.

        Of a pattern's trips most are over, or still to come, wherever the vehicle is.
        """
        over_s = (t_ns - self.run.ends_ns) * 1e-9
        if over_s > LATE_S or self.waits_s(t_ns) > waits_s:
            return False
        return -EARLY_S <= self.run.delay_s(self.follower.total_m, t_ns) <= LATE_S


def is_same(run: Run, other: Run | None) -> bool:
    """Whether two runs are one: of one trip on one day, however they were made."""
    return other is not None and run[:1] + run[2:4] == other[:1] + other[2:4]


def likely(
    found: Iterable[Followed],
    misfit_of: Callable[[Followed], float],
    line_of: Callable[[Run], LineKey],
) -> list[Followed]:
    """Of every line (route and direction) all that fit nearly as well as its best, best first."""
    best: dict[LineKey, float] = {}
    kept: list[Followed] = []
    for misfit, each in sorted(((misfit_of(each), each) for each in found), key=itemgetter(0)):
        least = best.setdefault(line_of(each.run), misfit)
        if misfit <= least + CLOSE_S:
            kept.append(each)
    return kept
