"""Pure: poses of one vehicle into progress and arrivals on the trip of a timetable that it runs."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

import msgspec

from wayline.core import Record, Sleep, Store
from wayline.inputs import Tick
from wayline.messages import (
    TEXT_MAX,
    Arrivals,
    GpsFix,
    Message,
    Pose,
    Progress,
    StopArrival,
    StopEvent,
)
from wayline.node import Node
from wayline.timetable.runs import PatternPlace, Run, Runs
from wayline.tuning import Tuning
from wayline_eta import stop_events, trip_arrivals
from wayline_eta.arrivals import Outlook
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.forecaster import Forecaster
from wayline_eta.lessons import Lessons, lessons_by
from wayline_eta.records import Learned
from wayline_eta.scoring import Scoring
from wayline_eta.sightings import LeftOut, Sighting, Sightings
from wayline_eta.stop_events import StopEvents
from wayline_eta.trip_choice import TripChoice
from wayline_eta.trip_fit import Followed, is_same

SECOND_NS = 1_000_000_000

RunKey = tuple[PatternPlace, str, int]


def timetable_node(
    runs: Runs,
    tuning: Tuning,
    assignment: str | None,
    lessons: Lessons | None = None,
    store: Store | None = None,
    *,
    left_out: LeftOut | None = None,
) -> Node:
    """A core with its name; `assignment` is the trip or block that is known without reports.

    The poses that fusion makes of a fix come after it, and ticks wait for them.
    """
    core = TimetableEtaCore(runs, tuning, assignment, lessons, left_out)
    return Node("eta", core, store, timeless=frozenset({GpsFix}))


class TimetableEtaCore:
    """One vehicle's trip, progress and arrivals once a second, from poses and reports.

    Nothing comes while no trip is known or found. `lessons` are what all vehicles have learned,
    this one adds to them; without, it learns for itself.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({Pose, GpsFix})
    period_ns: ClassVar[int | None] = SECOND_NS

    def __init__(
        self,
        runs: Runs,
        tuning: Tuning,
        assignment: str | None = None,
        lessons: Lessons | None = None,
        left_out: LeftOut | None = None,
    ) -> None:
        self._lessons = lessons or lessons_by(runs.feeds)
        self._scoring = Scoring(self._lessons.scored)
        self._following: dict[RunKey, Forecaster] = {}
        """Of the block's next trip, once it is told of."""
        self._forecaster: Forecaster | None = None
        self._forecast_of: RunKey | None = None
        """The run that it is of."""
        self._choice = TripChoice(runs, tuning)
        self._tuning, self._configured = tuning, assignment
        self._sightings = Sightings(tuning, left_out)
        self._events = StopEvents()
        self._pose: Pose | None = None
        self._is_stale = False
        """Whether it has been told that the pose is old."""

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record | Sleep]:
        """Take a pose, a report with an assignment, a tick or the end; nothing else is read."""
        return self._scoring.add_to(self._say(message, source), message)

    def _say(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record | Sleep]:
        if isinstance(message, GpsFix):
            self._sightings.take_fix(message, source)
            self._choice.assign(message.assignment, message.t_ns)
            if message.valid:
                self._choice.count_fix()
        elif isinstance(message, Pose):
            self._take(self._sightings.take_pose(message))
        elif isinstance(message, Tick) and message.t_ns % SECOND_NS == 0:
            self._take(self._sightings.pass_time(message.t_ns))
            return [*self._happened(), *self._tell(message.t_ns, message.age_ns)]
        return ()

    def _take(self, seen: Sequence[Sighting]) -> None:
        for pose, reported in seen:
            if pose.lat_deg is None or pose.lon_deg is None:
                continue
            self._choice.assign(self._configured, pose.t_ns)
            self._pose, self._is_stale = pose, False
            before, following = self._choice.current, self._choice.next_run
            self._choice.observe(pose, pose.lat_deg, pose.lon_deg, reported=reported)
            self._note(before, following, pose.t_ns)

    def _note(self, before: Followed | None, following: Run | None, t_ns: int) -> None:
        """What happened at stops: to the end of the trip before, then on the present one."""
        now, known = self._choice.current, self._choice.is_certain
        if before is not None:
            self._note_of(before, known=known)
        if now is None or (before is not None and is_same(now.run, before.run)):
            return
        if following is not None and is_same(now.run, following):
            self._events.finish(t_ns)
        self._note_of(now, known=known)

    def _note_of(self, followed: Followed, *, known: bool) -> None:
        run = followed.run
        told = stop_events.of_run(run)
        self._events.note(followed.follower, _key(run), told, known=known)

    def _happened(self) -> Iterator[StopEvent | Learned]:
        """What the vehicle did at stops, of the trip before, then of this; and what that taught."""
        for event in self._events.take():
            current = self._choice.current
            if current is not None and event.trip_id == current.run.trip.trip_id:
                yield from self._forecaster_of(current.run).observe(event)
            elif self._forecaster is not None and self._is_forecast(event):
                yield from self._forecaster.observe(event)
            else:
                yield event

    def _is_forecast(self, event: StopEvent) -> bool:
        """Whether an event is of the trip whose arrivals were forecast last."""
        return self._forecast_of is not None and event.trip_id == self._forecast_of[1]

    def _forecaster_of(self, run: Run) -> Forecaster:
        if self._forecaster is None or self._forecast_of != _key(run):
            self._forecast_of = _key(run)
            begun = self._following.pop(_key(run), None)
            self._forecaster = begun or self._made_for(run)
        return self._forecaster

    def _made_for(self, run: Run) -> Forecaster:
        scope = f"feed {run.pattern_place[0]}"
        return Forecaster(
            run.trip_route.route,
            self._lessons,
            scope=scope,
            plan=f"{scope}|{run.pattern.route_id}",
            sequences=run.trip_route.sequences,
            motion=ExpectedMotion(run.trip_route.route, run.leaves_ns),
        )

    def _tell(self, t_ns: int, pose_age_ns: int) -> list[Message | Sleep]:
        pose, current = self._pose, self._choice.current
        if pose is None or current is None:
            return []
        age_s = (t_ns - pose.t_ns + pose_age_ns) * 1e-9
        if age_s > self._sightings.forgotten_after_s:
            self._pose = None
            return [self._arrivals(current, t_ns, pose.t_ns, (), stale=True)]
        stale = age_s > self._sightings.stale_after_s
        if stale and self._is_stale:
            return []
        self._is_stale = stale
        stops = self._stops(current, t_ns)
        arrivals = self._arrivals(current, t_ns, pose.t_ns, stops, stale=stale)
        progress = None if stale else self._progress(current, t_ns)
        return [arrivals] if progress is None else [progress, arrivals]

    def _trip_id(self, run: Run) -> str | None:
        return run.trip.trip_id if self._choice.is_certain else None

    def _headsign(self, run: Run) -> str | None:
        told = run.trip.headsign[:TEXT_MAX] or None
        return told if self._choice.is_certain else None

    def _direction_id(self, run: Run) -> int | None:
        """Null as long as it may be the other one."""
        told = run.pattern.direction_id
        rivals = () if self._choice.is_certain else self._choice.rivals
        return told if all(rival.pattern.direction_id == told for rival in rivals) else None

    def _progress(self, current: Followed, t_ns: int) -> Progress | None:
        progress, run = current.follower.progress(t_ns), current.run
        if progress is None:
            return None
        known = self._choice.is_certain and progress.on_route and run.is_exact
        return msgspec.structs.replace(
            progress,
            route_id=run.pattern.route_id,
            trip_id=self._trip_id(run),
            direction_id=self._direction_id(run),
            delay_s=run.delay_s(progress.distance_m, t_ns) if known else None,
        )

    def _stops(self, current: Followed, t_ns: int) -> tuple[StopArrival, ...]:
        outlook, run = current.follower.outlook(t_ns), current.run
        if outlook is None:
            return ()
        first_m = float(run.trip_route.route.stop_distances_m[0])
        if outlook.total_m <= first_m + self._tuning.stop_radius_m:
            waits_s = (run.departs_ns - outlook.t_ns) * 1e-9
            outlook = outlook._replace(stand=outlook.stand.at_least(waits_s))
        visits = self._forecaster_of(run).visits(outlook, t_ns)
        told = trip_arrivals.of_run(run, visits)
        if not self._choice.is_certain:
            rivals = [rival.trip_route.route for rival in self._choice.rivals]
            return trip_arrivals.before_the_fork(told, rivals)
        return (*told, *self._next_stops(told, t_ns))

    def _next_stops(self, told: tuple[StopArrival, ...], t_ns: int) -> tuple[StopArrival, ...]:
        """Of the block's next trip, once the vehicle has come to the end of this one."""
        run = self._choice.next_run
        if run is None or not told:
            return ()
        if _key(run) not in self._following:
            self._following = {_key(run): self._made_for(run)}
        forecaster = self._following[_key(run)]
        begins = forecaster.begins(told[-1], run.departs_ns, t_ns)
        first_m = float(run.trip_route.route.stop_distances_m[0])
        visits = forecaster.visits(Outlook(t_ns, first_m, first_m, 0.0, begins), t_ns)
        return trip_arrivals.of_next_run(run, told, begins, visits, t_ns)

    def _arrivals(
        self,
        current: Followed,
        t_ns: int,
        position_ns: int,
        stops: tuple[StopArrival, ...],
        *,
        stale: bool,
    ) -> Arrivals:
        return Arrivals(
            t_ns=t_ns,
            route_id=current.run.pattern.route_id,
            trip_id=self._trip_id(current.run),
            headsign=self._headsign(current.run),
            stale=stale,
            position_ns=position_ns,
            stops=stops,
            runs=tuple(map(trip_arrivals.told_run, self._told_runs(current, stops))),
        )

    def _told_runs(self, current: Followed, stops: tuple[StopArrival, ...]) -> Iterator[Run]:
        """Those that stops are told of."""
        following = self._choice.next_run
        if self._choice.is_certain:
            yield current.run
        if following is not None and any(stop.trip_id is not None for stop in stops):
            yield following


def _key(run: Run) -> RunKey:
    return run.pattern_place, run.trip.trip_id, run.starts_ns
