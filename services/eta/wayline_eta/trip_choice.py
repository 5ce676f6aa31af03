"""Pure: which trip of the timetable a vehicle runs, told or found.

A trip or block that is told is believed. Else the patterns that a vehicle follows, which its place
and direction tell, have trips that it may be running; by time it is the one that is least off its
timetable. Lines that share a street are not told apart as long as it may be on either.
"""

from collections.abc import Sequence
from typing import NamedTuple

from wayline.messages import Pose
from wayline.timetable.runs import PatternPlace, Run, Runs
from wayline.tuning import Tuning
from wayline_eta.place_tracker import position_std_m
from wayline_eta.route_follower import RouteFollower

NEAR_M = 100.0
"""Patterns this near to a vehicle are looked at."""
EARLY_S, LATE_S = 300.0, 1_800.0
"""A vehicle farther off a trip's timetable runs another one."""
EARLY_COUNTS = 3.0
"""Late buses are usual, early ones are not: a second early counts as three late."""
FOLLOWED_M, FOLLOWED_FIXES = 400.0, 3
"""A vehicle that has left its line runs another one once it has followed that for so long, and as
many fixes have said so: what was reckoned between two of them goes astray."""
LEFT_FIXES = 2
"""So many fixes off its line, and a vehicle may be on another one."""
END_M = 60.0
"""A vehicle that has come so near to its last stop and goes on elsewhere has served it."""


class Followed(NamedTuple):
    """A run with its follower."""

    run: Run
    follower: RouteFollower


class Progressed(NamedTuple):
    """How far a vehicle has come, and how many fixes it has had."""

    travelled_m: float
    fixes: int


class TripChoice:
    """Of one vehicle."""

    def __init__(self, runs: Runs, tuning: Tuning) -> None:
        self._runs, self._tuning = runs, tuning
        self._followers: dict[PatternPlace, RouteFollower] = {}
        self._followed_since: dict[PatternPlace, Progressed] = {}
        self._now = Progressed(0.0, 0)
        self._left_since: Progressed | None = None
        """When the vehicle left the present run's line; None while it is on it."""
        self._assignment: str | None = None
        self._chain: Sequence[Run] = ()
        """The runs that follow each other: of the block, or the one trip."""
        self._current: Run | None = None
        self.is_certain = False
        """Whether it is known which line the vehicle runs."""
        self.rivals: Sequence[Run] = ()
        """The trips of other lines that it may be running as well."""

    @property
    def current(self) -> Followed | None:
        """The likeliest run; None where the vehicle follows nothing that is known."""
        run = self._current
        return None if run is None else Followed(run, self._followers[run.pattern_place])

    @property
    def next_run(self) -> Run | None:
        """What the vehicle runs after the present trip, where its block tells."""
        later = [run for run in self._chain if run is not self._current]
        if self._current is None or not self.is_certain:
            return None
        ends_ns = self._current.departs_ns
        return next((run for run in later if run.departs_ns > ends_ns), None)

    def assign(self, name: str | None, t_ns: int) -> None:
        """Take the trip or block that is told; one that nobody knows tells nothing."""
        if name is None or name == self._assignment:
            return
        self._assignment = name
        chain = self._runs.assigned(name, t_ns)
        if chain:
            self._chain = chain
            self._current, self.is_certain, self.rivals = None, True, ()

    def count_fix(self) -> None:
        """A receiver, or a report, has told a position."""
        self._now = self._now._replace(fixes=self._now.fixes + 1)

    def observe(
        self, pose: Pose, lat_deg: float, lon_deg: float, *, reported: bool = False
    ) -> None:
        """Take the next pose with its position in degrees; `reported` where it is a report's."""
        places = self._looked_at(lat_deg, lon_deg)
        for place in places:
            self._follower(place).observe(pose, lat_deg, lon_deg, reported=reported)
        for place in [each for each in self._followers if each not in places]:
            del self._followers[place]
        if self._current is not None and position_std_m(pose, None) > self._tuning.on_route_m:
            return  # reckoned between two fixes, too far to decide anything by
        self._note_followed(pose.distance_m)
        if self._chain:
            self._go_on(pose.t_ns)
        if not self._chain:
            self._find(pose.t_ns)

    def _note_followed(self, travelled_m: float) -> None:
        self._now = self._now._replace(travelled_m=travelled_m)
        self._followed_since = {
            place: self._followed_since.get(place, self._now)
            for place, follower in self._followers.items()
            if follower.on_route
        }

        current = self._current
        if current is None or current.pattern_place in self._followed_since:
            self._left_since = None
        elif self._left_since is None:
            self._left_since = self._now

    def _is_followed(self, place: PatternPlace) -> bool:
        """Whether the vehicle has been on a line for long enough to be sure of it."""
        since, now = self._followed_since.get(place), self._now
        return (
            since is not None
            and now.travelled_m - since.travelled_m >= FOLLOWED_M
            and now.fixes - since.fixes >= FOLLOWED_FIXES
        )

    def _looked_at(self, lat_deg: float, lon_deg: float) -> set[PatternPlace]:
        if self._chain:
            return {run.pattern_place for run in self._chain}
        near = set(self._runs.near(lat_deg, lon_deg, NEAR_M))
        return near if self._current is None else near | {self._current.pattern_place}

    def _follower(self, place: PatternPlace) -> RouteFollower:
        if place not in self._followers:
            routes = self._runs.line_of(place)
            assert routes is not None  # noqa: S101  # a run was made of it
            first = routes.of_timing(routes.some_timing, "")
            self._followers[place] = RouteFollower(first.route, self._tuning)
        return self._followers[place]

    def _go_on(self, t_ns: int) -> None:
        """Stay with the present run until it is served, then go on to the next."""
        if self._current is None:
            self._drive(min(self._chain, key=lambda run: self._misfit(run, t_ns)))
            return
        following = self.next_run
        if self._is_served(self._current) or self._goes_on_as(following):
            if following is not None and self._is_in_time(following, t_ns):
                self._drive(following)
            elif not self._assignment_holds() and self._has_left():
                self._chain, self._current, self.is_certain = (), None, False

    def _is_in_time(self, run: Run, t_ns: int) -> bool:
        """Whether a vehicle where it is may run a trip already."""
        total_m = self._followers[run.pattern_place].total_m
        return run.delay_s(total_m, t_ns) >= -EARLY_S or self._is_served_by(self._current)

    def _is_served_by(self, run: Run | None) -> bool:
        return run is not None and self._is_served(run)

    def _assignment_holds(self) -> bool:
        return self._assignment is not None

    def _has_left(self) -> bool:
        since = self._left_since
        return since is not None and self._now.fixes - since.fixes >= LEFT_FIXES

    def _goes_on_as(self, following: Run | None) -> bool:
        """Whether the vehicle is on the next trip's line and no longer on this one's."""
        current = self._current
        if following is None or current is None or not self._has_left():
            return False
        place = following.pattern_place
        return place != current.pattern_place and self._is_followed(place)

    def _is_served(self, run: Run) -> bool:
        follower = self._followers[run.pattern_place]
        last_m = float(run.trip_route.route.stop_distances_m[-1])
        near = follower.total_m >= last_m - END_M and not follower.on_route
        return near or (follower.on_route and follower.served_m >= last_m - 1.0)

    def _drive(self, run: Run) -> None:
        if self._current is not None and self._current.pattern_place == run.pattern_place:
            self._followers.pop(run.pattern_place)
        self._current, self._left_since = run, None
        self._follower(run.pattern_place).run_as(run.trip_route.route)

    def _misfit(self, run: Run, t_ns: int) -> float:
        """Seconds off the timetable, of a vehicle where it is; farther off the line is worse."""
        follower = self._followers[run.pattern_place]
        delay_s = run.delay_s(follower.total_m, t_ns)
        off_s = min(follower.offset_m, 10_000.0) / 10.0
        wait_s = 0.0
        if follower.total_m <= run.trip_route.route.stop_distances_m[0] + END_M:
            wait_s = max((run.departs_ns - t_ns) * 1e-9, 0.0)
        return max(delay_s, -EARLY_COUNTS * delay_s) + off_s + wait_s

    def _find(self, t_ns: int) -> None:
        """Among the lines that the vehicle follows, unless it is still on the one that it was."""
        current = self._current
        if current is not None and self.is_certain:
            if not self._has_left() and not self._is_served(current):
                return
            if self._is_served(current) and current.trip.block_id is not None:
                self._chain = self._runs.of_block(current, t_ns)
                self._go_on(t_ns)
                return
        best = self._best_of_lines(t_ns)
        if current is not None and self.is_certain:
            best = [run for run in best if self._is_followed(run.pattern_place)]
        if not best:
            return
        best.sort(key=lambda run: self._misfit(run, t_ns))
        kept = next((run for run in best if self._is_current(run)), best[0])
        self.is_certain, self.rivals = len(best) == 1, [run for run in best if run is not kept]
        if not self._is_current(kept):
            self._drive(kept)

    def _is_current(self, run: Run) -> bool:
        current = self._current
        return current is not None and run[:1] + run[2:4] == current[:1] + current[2:4]

    def _best_of_lines(self, t_ns: int) -> list[Run]:
        """Of every line that the vehicle follows the trip that fits best by time."""
        found: list[Run] = []
        for place, follower in self._followers.items():
            if not follower.on_route:
                continue
            fitting = [
                run
                for run in self._runs.of_pattern(place, t_ns)
                if -EARLY_S <= run.delay_s(follower.total_m, t_ns) <= LATE_S
                and (run.departs_ns - t_ns) * 1e-9 <= EARLY_S
            ]
            if fitting:
                found.append(min(fitting, key=lambda run: self._misfit(run, t_ns)))
        return found
