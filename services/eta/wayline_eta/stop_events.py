"""Pure: what happened at stops as messages, of the route or trip that a vehicle follows."""

from collections.abc import Callable, Hashable, Iterable

from wayline.messages import StopEvent
from wayline.route import Route
from wayline.timetable.runs import Run
from wayline_eta.route_follower import RouteFollower
from wayline_eta.stop_log import Happening, StopLog

SECOND_NS = 1_000_000_000

Told = Callable[[Happening], StopEvent]


class StopEvents:
    """Of one vehicle: gathers what happens until it is told."""

    def __init__(self) -> None:
        self._log: StopLog | None = None
        self._followed: Hashable = None
        self._told: Told | None = None
        self._t_ns = 0
        self._is_known = True
        self._events: list[StopEvent] = []

    def note(
        self, follower: RouteFollower, followed: Hashable, told: Told, *, known: bool = True
    ) -> None:
        """Note where a vehicle was seen last on what it follows.

        `followed` is another one where a route or trip begins; as long as it is not `known`
        whether the vehicle follows it, what happens is kept, and dropped where it does not.
        """
        seen = follower.seen
        if self._log is None or followed != self._followed:
            self._log = StopLog(follower.route, follower.motion)
            self._events = self._events if self._is_known else []
        self._followed, self._told, self._is_known = followed, told, known
        if seen is None:
            self._log.off_route()
        elif seen.t_ns > self._t_ns:
            self._t_ns = seen.t_ns
            self._add(self._log.observe(seen))

    def finish(self, t_ns: int) -> None:
        """What was followed is over: another trip has begun."""
        if self._log is not None:
            self._add(self._log.finish(t_ns))
        self._log = None

    def take(self) -> list[StopEvent]:
        """What has happened since the last time that it was told."""
        if not self._is_known:
            return []
        events, self._events = self._events, []
        return events

    def _add(self, happened: Iterable[Happening]) -> None:
        if self._told is not None:
            self._events += map(self._told, happened)


def of_route(route: Route) -> Told:
    """Words what happened on a route."""
    return lambda happening: _event(route, happening)


def of_run(run: Run) -> Told:
    """Words what happened on a trip, with its times."""
    return lambda happening: _event_of_run(run, happening)


def _event(route: Route, happening: Happening) -> StopEvent:
    stop = route.stops[happening.stop]
    return StopEvent(
        t_ns=happening.t_ns,
        route_id=route.route_id,
        stop_id=stop.stop_id,
        stop_sequence=happening.stop + 1,
        kind=happening.kind,
        distance_m=stop.distance_m,
        lap=happening.lap,
        interpolated=happening.interpolated,
        disruption=happening.disruption,
    )


def _event_of_run(run: Run, happening: Happening) -> StopEvent:
    plan, stop = run.trip_route.plan, happening.stop
    times_s = plan.departures_s if happening.kind == "departed" else plan.arrivals_s
    scheduled_ns = run.starts_ns + round(float(times_s[stop]) * SECOND_NS)
    return StopEvent(
        t_ns=happening.t_ns,
        route_id=run.pattern.route_id,
        trip_id=run.trip.trip_id,
        stop_id=run.trip_route.route.stops[stop].stop_id,
        stop_sequence=run.trip_route.sequences[stop],
        kind=happening.kind,
        scheduled_ns=scheduled_ns if run.is_exact else None,
        distance_m=run.trip_route.route.stops[stop].distance_m,
        interpolated=happening.interpolated,
        disruption=happening.disruption,
    )
