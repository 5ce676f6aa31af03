"""Pure: poses (or fixes) of one vehicle into its progress and arrivals on the best route."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

import msgspec

from wayline.core import Record, Sleep, Store
from wayline.inputs import Tick
from wayline.messages import Arrivals, GpsFix, Message, Pose, StopArrival, StopEvent
from wayline.node import Node
from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.arrivals import predict_visits, told_arrivals
from wayline_eta.fix_follower import FixFollower
from wayline_eta.forecaster import Forecaster
from wayline_eta.lessons import Expectations, Lessons, as_planned, lessons_by
from wayline_eta.route_choice import RouteChoice
from wayline_eta.route_follower import RouteFollower
from wayline_eta.scoring import Scoring
from wayline_eta.sightings import LeftOut, Sighting, Sightings
from wayline_eta.stop_events import StopEvents, of_route
from wayline_eta.trip_arrivals import before_the_fork

SECOND_NS = 1_000_000_000


class EtaCore:
    """One vehicle's progress and arrivals once a second, from poses and seldom reports.

    Nothing comes before the first match with a route, or without routes. `lessons` are what all
    vehicles have learned, this one adds to them; without, it learns for itself.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({Pose, GpsFix})
    period_ns: ClassVar[int | None] = SECOND_NS

    def __init__(
        self,
        routes: Sequence[Route],
        tuning: Tuning,
        lessons: Lessons | None = None,
        left_out: LeftOut | None = None,
    ) -> None:
        lessons = lessons or lessons_by(())
        self._sightings = Sightings(tuning, left_out)
        self._on_routes = OnRoutes(routes, tuning, self._sightings, lessons)
        self._scoring = Scoring(lessons.scored)

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record | Sleep]:
        """Take a pose, a fix, a tick or the end; anything else is not read."""
        return self._scoring.add_to(self._say(message, source), message)

    def _say(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record | Sleep]:
        if isinstance(message, GpsFix):
            self._sightings.take_fix(message, source)
        elif isinstance(message, Pose):
            self._on_routes.take(self._sightings.take_pose(message))
        elif isinstance(message, Tick) and message.t_ns % SECOND_NS == 0:
            self._on_routes.take(self._sightings.pass_time(message.t_ns))
            told = self._on_routes.tell(message.t_ns, message.age_ns)
            return [*self._on_routes.happened(), *told]
        return ()


class ReferenceEtaCore:
    """One vehicle's progress and arrivals once a row of `gps_fix`, by the published filter.

    Nothing comes before the first fix with a position, or without routes.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({GpsFix})
    period_ns: ClassVar[int | None] = None

    def __init__(self, routes: Sequence[Route], tuning: Tuning) -> None:
        self._by_fix = ByFix(routes, tuning)

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
        """Take a fix; anything else is not read."""
        return self._by_fix.follow(message, source) if isinstance(message, GpsFix) else ()


def make_eta_core(
    routes: Sequence[Route],
    tuning: Tuning,
    lessons: Lessons | None = None,
    left_out: LeftOut | None = None,
) -> EtaCore | ReferenceEtaCore:
    """The core that the tuning's `route_filter` asks for.

    They are two, as the reference has no ticks: it answers every row.
    """
    if tuning.route_filter == "avl":
        return ReferenceEtaCore(routes, tuning)
    return EtaCore(routes, tuning, lessons, left_out)


def assigned_routes(routes: Sequence[Route], route_id: str | None) -> Sequence[Route]:
    """The route that a vehicle is assigned to; all where that is none of them."""
    return [route for route in routes if route.route_id == route_id] or routes


def eta_node(
    routes: Sequence[Route],
    tuning: Tuning,
    lessons: Lessons | None = None,
    store: Store | None = None,
    *,
    left_out: LeftOut | None = None,
) -> Node:
    """A core on routes with its name, and what keeps its lessons.

    The poses that fusion makes of a fix come after it, and ticks wait for them.
    """
    core = make_eta_core(routes, tuning, lessons, left_out)
    return Node("eta", core, store, timeless=frozenset({GpsFix}))


class OnRoutes:
    """Follows the route that the vehicle is on, and tells of stops that it surely comes to."""

    def __init__(
        self, routes: Sequence[Route], tuning: Tuning, sightings: Sightings, lessons: Lessons
    ) -> None:
        self._sightings, self._lessons = sightings, lessons
        self._choice = RouteChoice(routes, tuning)
        self._forecaster: Forecaster | None = None
        self._forecast: RouteFollower | None = None
        """The follower of the route that it is of."""
        self._seen: Sighting | None = None
        """The last one, as long as anything may rest on it."""
        self._is_stale = False
        """Whether it has been told that it is old."""
        self.events = StopEvents()

    def take(self, seen: Sequence[Sighting]) -> None:
        """Follow what was seen of the vehicle."""
        for sighting in seen:
            self._seen, self._is_stale = sighting, False
            if sighting.reported:
                self._follow(sighting)

    def happened(self) -> Iterator[StopEvent | Record]:
        """What the vehicle did at stops, and what it taught by that once its route is sure."""
        current = self._choice.current
        for event in self.events.take():
            is_sure = current is not None and not self._choice.rivals
            if is_sure and current is not None and event.route_id == current.route.route_id:
                yield from self._forecaster_of(current).observe(event)
            else:
                yield event

    def tell(self, t_ns: int, pose_age_ns: int) -> list[Message | Sleep]:
        """Progress and arrivals at a whole second while the vehicle is seen.

        `pose_age_ns` is how old the pose was when it came. Once it is old, arrivals are told once
        more, marked stale, and a last time, empty, when nothing can rest on it any longer.
        """
        seen = self._seen
        if seen is not None and not seen.reported:
            self._follow(seen)
        if seen is None or self._choice.current is None:
            return [Sleep()]
        pose, current = seen.pose, self._choice.current
        age_s = (t_ns - pose.t_ns + pose_age_ns) * 1e-9
        if age_s <= self._sightings.stale_after_s:
            return self._fresh(current, pose, t_ns)
        forgotten_after_s = self._sightings.forgotten_after_s
        if age_s > forgotten_after_s:
            self._seen = None
            return [_arrivals(current.route, (), t_ns, pose.t_ns, stale=True), Sleep()]
        forgets_ns = pose.t_ns - pose_age_ns + round(forgotten_after_s * 1e9)
        return [*self._stale(current, pose, t_ns), Sleep(forgets_ns)]

    def _fresh(self, current: RouteFollower, pose: Pose, t_ns: int) -> list[Message | Sleep]:
        progress = current.progress(t_ns)
        arrivals = self._told(current, t_ns, pose.t_ns, stale=False)
        return [arrivals] if progress is None else [progress, arrivals]

    def _stale(self, current: RouteFollower, pose: Pose, t_ns: int) -> list[Message]:
        if self._is_stale:
            return []
        self._is_stale = True
        return [self._told(current, t_ns, pose.t_ns, stale=True)]

    def _follow(self, seen: Sighting) -> None:
        lat_deg, lon_deg = seen.pose.lat_deg, seen.pose.lon_deg
        if lat_deg is not None and lon_deg is not None:
            self._choice.observe(seen.pose, lat_deg, lon_deg, reported=seen.reported)
        current = self._choice.current
        if current is not None:
            self.events.note(current, current.route.route_id, of_route(current.route))

    def _told(
        self, current: RouteFollower, t_ns: int, position_ns: int, *, stale: bool
    ) -> Arrivals:
        """Arrivals up to where a route forks off on which the vehicle may be as well."""
        outlook = current.outlook(t_ns)
        stops: tuple[StopArrival, ...] = ()
        if outlook is not None:
            visits = self._forecaster_of(current).visits(outlook, t_ns)
            rivals = [rival.route for rival in self._choice.rivals]
            stops = before_the_fork(told_arrivals(current.route, visits), rivals)
        return _arrivals(current.route, stops, t_ns, position_ns, stale=stale)

    def _forecaster_of(self, current: RouteFollower) -> Forecaster:
        if self._forecaster is None or self._forecast is not current:
            route = current.route
            self._forecast = current
            self._forecaster = Forecaster(
                route,
                self._lessons,
                scope=route.route_id,
                plan=route.route_id,
                sequences=range(1, len(route.stops) + 1),
            )
        return self._forecaster


class ByFix:
    """Follows the route that is nearest to the first fix, one receiver only."""

    def __init__(self, routes: Sequence[Route], tuning: Tuning) -> None:
        self._routes, self._tuning = routes, tuning
        self._follower: FixFollower | None = None
        self._source: str | None = None
        self._planned: Expectations | None = None

    def follow(self, fix: GpsFix, source: str) -> list[Message]:
        """Progress and arrivals for one row, from the first fix with a position on."""
        if self._follower is None:
            route = self._nearest_route(fix)
            if route is None:
                return []
            self._follower, self._source = FixFollower(route, self._tuning), source
            self._planned = as_planned(route)
        if source != self._source:
            return []
        self._follower.observe(fix)
        progress = self._follower.progress()
        if progress is None:
            return []
        age_s = (self._follower.t_ns - self._follower.known_ns) * 1e-9
        forgotten = age_s > self._tuning.eta_forget_after_s
        outlook = None if forgotten else self._follower.outlook()
        stale = age_s > self._tuning.eta_stale_after_s
        known_ns = self._follower.known_ns
        stops: tuple[StopArrival, ...] = ()
        if outlook is not None and self._planned is not None:
            stops = told_arrivals(
                self._follower.route, predict_visits(self._planned, outlook, progress.t_ns)
            )
        route = self._follower.route
        return [progress, _arrivals(route, stops, progress.t_ns, known_ns, stale=stale)]

    def _nearest_route(self, fix: GpsFix) -> Route | None:
        lat_deg, lon_deg = fix.lat_deg, fix.lon_deg
        if not self._routes or not fix.valid or lat_deg is None or lon_deg is None:
            return None
        return min(
            self._routes,
            key=lambda route: float(route.line.project_legs(lat_deg, lon_deg).offsets_m.min()),
        )


def _arrivals(
    route: Route,
    stops: tuple[StopArrival, ...],
    t_ns: int,
    position_ns: int,
    *,
    stale: bool,
) -> Arrivals:
    return Arrivals(
        t_ns=t_ns, route_id=route.route_id, stale=stale, position_ns=position_ns, stops=stops
    )
