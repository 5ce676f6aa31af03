"""Pure: which trip of the timetable a vehicle runs, told or found.

A trip or block that is told is believed. Else the patterns that a vehicle follows, which its place
and direction tell, have trips that it may be running; by time it is the one that is least off its
timetable. Lines that share a street are not told apart as long as it may be on either.

After its last stop comes the block's next trip. Where there are no blocks it is the next departure
from there on that the timetable leaves time for, and until the vehicle sets out it may become the
one after.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence

from wayline.messages import Pose
from wayline.timetable.runs import PatternPlace, Run, Runs
from wayline.tuning import Tuning
from wayline_eta.departures import LAYOVER_S, SET_OUT_EARLY_COUNTS, Waiting
from wayline_eta.lines_followed import LinesFollowed, Progressed
from wayline_eta.place_tracker import position_std_m
from wayline_eta.trip_fit import Followed, is_same, likely

NEAR_M = 100.0
"""Patterns this near to a vehicle are looked at."""
FOLLOWED_M, FOLLOWED_FIXES = 400.0, 3
"""A vehicle that has left its line runs another one once it has followed that for so long, and as
many fixes have said so: what was reckoned between two of them goes astray."""
TURNED_M = 100.0
"""Where it drives back along its own line, and two fixes have said so: it has turned round."""
LEFT_FIXES = 2
"""So many fixes behind the first one off its line, and a vehicle may be on another one."""
ASK_AGAIN_NS = 600 * 1_000_000_000
"""Between two looks at what the assigned trip or block runs."""
JOINED_M = 50.0
"""So far along a line, and it counts beside others: a vehicle that stands may point anywhere."""


class TripChoice:
    """Of one vehicle."""

    def __init__(self, runs: Runs, tuning: Tuning) -> None:
        self._runs, self._tuning = runs, tuning
        self._lines = LinesFollowed(runs, tuning)
        self._left_since: Progressed | None = None
        """When the vehicle left the present run's line; None while it is on it."""
        self._assignment: str | None = None
        self._is_assigned, self._ask_again_ns = False, 0
        """Whether a feed knows it, and when to look again."""
        self._chain: Sequence[Run] = ()
        """The runs that follow each other: of the block, or the one trip."""
        self._current: Run | None = None
        self._has_set_out = True
        """Whether the vehicle has left the present run's first stop."""
        self._waiting: Waiting | None = None
        """Since its last trip has ended; None where none has."""
        self._departed: dict[PatternPlace, Run] = {}
        """The trips that it may have set out for, by line."""
        self._at_deg = (0.0, 0.0)
        self.is_certain = False
        """Whether it is known which line the vehicle runs."""
        self.rivals: Sequence[Run] = ()
        """The trips of other lines that it may be running as well."""

    @property
    def current(self) -> Followed | None:
        """The likeliest run; None where the vehicle follows nothing that is known."""
        return None if self._current is None else self._followed(self._current)

    @property
    def next_run(self) -> Run | None:
        """What the vehicle runs after the present trip, where its block tells."""
        later = [run for run in self._chain if run is not self._current]
        if self._current is None or not self.is_certain:
            return None
        ends_ns = self._current.departs_ns
        return next((run for run in later if run.departs_ns > ends_ns), None)

    def assign(self, name: str | None, t_ns: int) -> None:
        """Take the trip or block that is told; one that nobody knows tells nothing.

        It is asked for again now and then: the runs of the next day come into sight.
        """
        is_news = name != self._assignment
        if name is None or not (is_news or t_ns >= self._ask_again_ns):
            return
        self._assignment, self._ask_again_ns = name, t_ns + ASK_AGAIN_NS
        chain = self._runs.assigned(name, t_ns)
        if is_news:
            self._is_assigned = False
        if not chain:
            return
        is_known = self._is_assigned and any(is_same(run, self._current) for run in chain)
        self._chain, self._is_assigned = chain, True
        if not is_known:
            self._current, self.is_certain, self.rivals = None, True, ()

    def count_fix(self) -> None:
        """A receiver, or a report, has told a position."""
        self._lines.count_fix()

    def observe(
        self, pose: Pose, lat_deg: float, lon_deg: float, *, reported: bool = False
    ) -> None:
        """Take the next pose with its position in degrees; `reported` where it is a report's."""
        self._at_deg = lat_deg, lon_deg
        self._lines.observe(self._looked_at(), pose, lat_deg, lon_deg, reported=reported)
        if self._current is not None and position_std_m(pose, None) > self._tuning.on_route_m:
            return  # reckoned between two fixes, too far to decide anything by
        self._lines.note(pose.distance_m, by_report=reported)
        self._note_left()
        if self._chain:
            self._go_on(pose.t_ns)
        if not self._chain:
            self._find(pose.t_ns)

    def _note_left(self) -> None:
        current = self._current
        if current is None or self._lines.is_on(current.pattern_place):
            self._left_since = None
        elif self._left_since is None:
            self._left_since = self._lines.began

    def _looked_at(self) -> set[PatternPlace]:
        own = {run.pattern_place for run in self._chain}
        if self._current is not None:
            own.add(self._current.pattern_place)
        if self._chain and (self._is_assigned or not self._has_left):
            return own
        return own.union(self._runs.near(*self._at_deg, NEAR_M))

    def _followed(self, run: Run) -> Followed:
        return Followed(run, self._lines[run.pattern_place])

    @property
    def _has_left(self) -> bool:
        """Whether fixes lie off the present line, or drive it the wrong way."""
        return self._is_away or self._has_turned

    @property
    def _is_away(self) -> bool:
        return self._off_fixes >= LEFT_FIXES and self._is_beside

    @property
    def _has_turned(self) -> bool:
        """Also of a vehicle that stands turned round at a terminal."""
        return self._off_fixes >= 1 and self._lines.is_settled and not self._is_beside

    @property
    def _off_fixes(self) -> int:
        """Fixes since the one that showed the vehicle off the present line."""
        since = self._left_since
        return 0 if since is None else self._lines.now.fixes - since.fixes

    @property
    def _is_beside(self) -> bool:
        current = self._current
        limit_m = self._tuning.off_route_m
        return current is not None and self._lines[current.pattern_place].offset_m > limit_m

    def _is_followed(self, place: PatternPlace) -> bool:
        """Whether the vehicle has been on another line for long enough to be sure of it."""
        since = self._left_since
        if since is not None and self._has_turned:
            advanced_m = since.advanced_m(self._lines.now, place)
            return advanced_m >= TURNED_M and self._lines.is_followed(place, TURNED_M, 1)
        return self._lines.is_followed(place, FOLLOWED_M, FOLLOWED_FIXES)

    def _go_on(self, t_ns: int) -> None:
        """Stay with the present run until it is served, then go on to the next."""
        if self._current is None:
            fits = min(map(self._followed, self._chain), key=lambda each: each.misfit(t_ns))
            self._drive(fits.run)
            return
        current, following = self._followed(self._current), self.next_run
        if following is not None and self._is_now(following, current, t_ns):
            self._drive(following)
        elif not self._is_assigned and self._has_left and self._has_ended(current, following, t_ns):
            self._forget()

    def _is_now(self, following: Run, current: Followed, t_ns: int) -> bool:
        """Whether the next trip of the chain is under way."""
        place = following.pattern_place
        if current.is_served:
            return True
        goes_on = self._has_left and place != current.run.pattern_place and self._is_followed(place)
        return goes_on and self._followed(following).is_in_time(t_ns, LAYOVER_S)

    def _has_ended(self, current: Followed, following: Run | None, t_ns: int) -> bool:
        """Whether a block that was found is driven no longer: it is over, or was another's."""
        if following is None and current.is_served:
            return True
        return bool(self._others(current, t_ns))

    def _forget(self) -> None:
        self._chain, self._current, self.is_certain, self.rivals = (), None, False, ()
        self._waiting, self._departed = None, {}

    def _find(self, t_ns: int) -> None:
        """Among the lines that the vehicle follows, unless it is still on the one that it was."""
        if self._current is None:
            self._choose(self._under_way(t_ns), lambda each: each.misfit(t_ns))
            return
        current = self._followed(self._current)
        if self.is_certain and current.is_served:
            self._end(current, t_ns)
        elif not self._has_set_out:
            self._wait(current, t_ns)
        elif not self.is_certain:
            self._choose(self._under_way(t_ns), lambda each: each.misfit(t_ns))
        elif self._has_left:
            self._choose(self._others(current, t_ns), lambda each: each.misfit(t_ns))

    def _others(self, current: Followed, t_ns: int) -> list[Followed]:
        """Trips of lines that the vehicle has followed for long instead of the present one."""
        place = current.run.pattern_place
        return [
            each
            for each in self._under_way(t_ns)
            if each.run.pattern_place != place and self._is_followed(each.run.pattern_place)
        ]

    def _end(self, current: Followed, t_ns: int) -> None:
        """Go on with the block; without one with what departs from there."""
        if current.run.trip.block_id is not None:
            self._chain = self._runs.of_block(current.run, t_ns)
            self._go_on(t_ns)
            return
        last = current.run.trip_route.route.stops[-1]
        waiting = Waiting(last.lat_deg, last.lon_deg, t_ns, current.run.ends_ns)
        self._waiting, self._departed = waiting, {}
        departing = list(waiting.departures(self._lines, self._runs, t_ns))
        if departing:
            self._choose(departing, lambda each: waiting.off_s(each.run, t_ns))
        elif self._has_left:
            self._forget()

    def _wait(self, current: Followed, t_ns: int) -> None:
        """Until the vehicle sets out its trip may turn out to be a later one, or none."""
        first = current.run.trip_route.route.stops[0]
        waiting = self._waiting or Waiting(first.lat_deg, first.lon_deg)
        if current.follower.on_route and not current.is_before_start:
            early_counts = SET_OUT_EARLY_COUNTS
            departing = waiting.departures(self._lines, self._runs, t_ns, early_counts)
            self._departed = {each.run.pattern_place: each.run for each in departing}
            self._has_set_out, self._waiting = True, None
            self._choose(self._under_way(t_ns), lambda each: each.misfit(t_ns))
        elif self._is_away:
            self._forget()
        else:
            departing = waiting.departures(self._lines, self._runs, t_ns)
            self._choose(departing, lambda each: waiting.off_s(each.run, t_ns))

    def _choose(self, found: Iterable[Followed], misfit_of: Callable[[Followed], float]) -> None:
        """The likeliest; certain where no other line is as likely. Of none nothing changes."""
        best = likely(found, misfit_of, self._runs.line_key)
        if not best:
            return
        kept = next((each for each in best if is_same(each.run, self._current)), best[0])
        self.rivals = [each.run for each in best if each is not kept]
        self.is_certain = not self.rivals
        if not is_same(kept.run, self._current):
            self._drive(kept.run)

    def _drive(self, run: Run) -> None:
        before = self._current
        is_next = before is not None and self._followed(before).is_served
        self._lines.drive(run, afresh=is_next)
        self._current, self._left_since = run, None
        if run.pattern_place not in self._departed:
            self._departed = {}
        self._has_set_out = not self._followed(run).is_before_start

    def _under_way(self, t_ns: int) -> Iterator[Followed]:
        """Of every line that the vehicle follows the trip that it set out for, or fits by time."""
        on = [place for place in self._lines if self._is_joined(place)]
        if departed := [self._departed[place] for place in on if place in self._departed]:
            yield from map(self._followed, departed)
            return
        for place in on:
            trips = map(self._followed, self._runs.of_pattern(place, t_ns))
            fitting = [each for each in trips if each.is_in_time(t_ns) and not each.is_served]
            if fitting:
                yield min(fitting, key=lambda each: each.misfit(t_ns))

    def _is_joined(self, place: PatternPlace) -> bool:
        """Whether a line counts: no longer followed than the present one it has to be driven."""
        if not self._lines[place].on_route:
            return False
        current = self._current
        as_long = current is None or self._lines.is_as_long(place, current.pattern_place)
        return as_long or self._lines.is_followed(place, JOINED_M, 0)
