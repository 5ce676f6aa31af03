"""Pure: poses (or fixes) of one vehicle into its progress and arrivals on the best route."""

from collections.abc import Sequence
from typing import ClassVar

import msgspec

from wayline.core import Record, Sleep
from wayline.inputs import Tick
from wayline.messages import Arrivals, GpsFix, Message, Pose
from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.arrivals import Outlook, predict_arrivals
from wayline_eta.fix_follower import FixFollower
from wayline_eta.route_follower import RouteFollower

SECOND_NS = 1_000_000_000


class EtaCore:
    """One vehicle's progress and arrivals once a second, from poses.

    Nothing comes before the first match with a route, or without routes.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({Pose})
    period_ns: ClassVar[int | None] = SECOND_NS

    def __init__(self, routes: Sequence[Route], tuning: Tuning) -> None:
        self._by_pose = ByPose(routes, tuning)

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record | Sleep]:
        """Take a pose or a tick; anything else is not read."""
        del source
        if isinstance(message, Pose):
            self._by_pose.take(message)
        elif isinstance(message, Tick) and message.t_ns % SECOND_NS == 0:
            return self._by_pose.tell(message.t_ns, message.age_ns)
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


def make_eta_core(routes: Sequence[Route], tuning: Tuning) -> EtaCore | ReferenceEtaCore:
    """The core that the tuning's `route_filter` asks for.

    They are two, as they read different topics: a core of poses that also read fixes would have
    its ticks before the poses that fusion makes of those fixes.
    """
    if tuning.route_filter == "avl":
        return ReferenceEtaCore(routes, tuning)
    return EtaCore(routes, tuning)


def assigned_routes(routes: Sequence[Route], route_id: str | None) -> Sequence[Route]:
    """The route that a vehicle is assigned to; all where that is none of them."""
    return [route for route in routes if route.route_id == route_id] or routes


class ByPose:
    """Follows the route that the vehicle is on; while it is on none, all of them.

    The followed route is left only when the vehicle has left it, so routes that share a street
    do not take turns.
    """

    def __init__(self, routes: Sequence[Route], tuning: Tuning) -> None:
        self._routes, self._tuning = routes, tuning
        self._followers = [RouteFollower(route, tuning) for route in routes]
        self._current: RouteFollower | None = None
        self._pose: Pose | None = None
        """The last pose worth following, as long as anything may rest on it."""
        self._is_stale = False
        """Whether it has been told that the pose is old."""

    def take(self, pose: Pose) -> None:
        """Keep a pose for the next tick, if it has a position worth following."""
        if pose.lat_deg is not None and pose.lon_deg is not None and pose.mode != "lost":
            self._pose, self._is_stale = pose, False

    def tell(self, t_ns: int, pose_age_ns: int) -> list[Message | Sleep]:
        """Progress and arrivals at a whole second while there is a fresh pose.

        `pose_age_ns` is how old the pose was when it came. Once it is old, arrivals are told once
        more, marked stale, and a last time, empty, when nothing can rest on it any longer.
        """
        pose = self._pose
        if pose is not None:
            self._follow(pose)
        if pose is None or self._current is None:
            return [Sleep()]
        age_s = (t_ns - pose.t_ns + pose_age_ns) * 1e-9
        if age_s <= self._tuning.eta_stale_after_s:
            return self._fresh(self._current, pose, t_ns)
        if age_s > self._tuning.eta_forget_after_s:
            self._pose = None
            return [_arrivals(self._current.route, None, t_ns, pose.t_ns, stale=True), Sleep()]
        forgets_ns = pose.t_ns - pose_age_ns + round(self._tuning.eta_forget_after_s * 1e9)
        return [*self._stale(self._current, pose, t_ns), Sleep(forgets_ns)]

    def _fresh(self, current: RouteFollower, pose: Pose, t_ns: int) -> list[Message | Sleep]:
        progress = current.progress(t_ns)
        arrivals = _arrivals(current.route, current.outlook(t_ns), t_ns, pose.t_ns, stale=False)
        return [arrivals] if progress is None else [progress, arrivals]

    def _stale(self, current: RouteFollower, pose: Pose, t_ns: int) -> list[Message]:
        if self._is_stale:
            return []
        self._is_stale = True
        return [_arrivals(current.route, current.outlook(t_ns), t_ns, pose.t_ns, stale=True)]

    def _follow(self, pose: Pose) -> None:
        if pose.lat_deg is None or pose.lon_deg is None:
            return
        current = self._current
        if current is not None:
            current.observe(pose, pose.lat_deg, pose.lon_deg)
            if current.on_route:
                return
        for follower in self._followers:
            if follower is not current:
                follower.observe(pose, pose.lat_deg, pose.lon_deg)
        matching = [follower for follower in self._followers if follower.on_route]
        if matching:
            self._choose(min(matching, key=lambda one: (one.ended, one.offset_m)))

    def _choose(self, chosen: RouteFollower) -> None:
        """Follow one route; the other routes' followers start afresh when they are next asked."""
        self._current = chosen
        self._followers = [
            chosen if chosen.route is route else RouteFollower(route, self._tuning)
            for route in self._routes
        ]


class ByFix:
    """Follows the route that is nearest to the first fix, one receiver only."""

    def __init__(self, routes: Sequence[Route], tuning: Tuning) -> None:
        self._routes, self._tuning = routes, tuning
        self._follower: FixFollower | None = None
        self._source: str | None = None

    def follow(self, fix: GpsFix, source: str) -> list[Message]:
        """Progress and arrivals for one row, from the first fix with a position on."""
        if self._follower is None:
            route = self._nearest_route(fix)
            if route is None:
                return []
            self._follower, self._source = FixFollower(route, self._tuning), source
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
        route, known_ns = self._follower.route, self._follower.known_ns
        return [progress, _arrivals(route, outlook, progress.t_ns, known_ns, stale=stale)]

    def _nearest_route(self, fix: GpsFix) -> Route | None:
        lat_deg, lon_deg = fix.lat_deg, fix.lon_deg
        if not self._routes or not fix.valid or lat_deg is None or lon_deg is None:
            return None
        return min(
            self._routes,
            key=lambda route: float(route.line.project_legs(lat_deg, lon_deg).offsets_m.min()),
        )


def _arrivals(
    route: Route, outlook: Outlook | None, t_ns: int, position_ns: int, *, stale: bool
) -> Arrivals:
    stops = predict_arrivals(route, outlook, t_ns) if outlook else ()
    return Arrivals(
        t_ns=t_ns, route_id=route.route_id, stale=stale, position_ns=position_ns, stops=stops
    )
