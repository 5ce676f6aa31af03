"""Pure: which of several routes a vehicle follows, and which others it may be on as well."""

from collections.abc import Sequence

from wayline.messages import Pose
from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.route_follower import RouteFollower


class RouteChoice:
    """The route that one vehicle is on; while it is on none, all of them are looked at.

    It is left only when the vehicle has left it, so routes that share a street do not take turns.
    Routes that began with it are rivals until the vehicle has left them.
    """

    def __init__(self, routes: Sequence[Route], tuning: Tuning) -> None:
        self._tuning = tuning
        self._followers = [RouteFollower(route, tuning) for route in routes]
        self.current: RouteFollower | None = None
        self.rivals: list[RouteFollower] = []

    def observe(self, pose: Pose, lat_deg: float, lon_deg: float, *, reported: bool) -> None:
        """Take the next pose with its position in degrees, or a report."""
        known = [] if self.current is None else [self.current, *self.rivals]
        for follower in known:
            follower.observe(pose, lat_deg, lon_deg, reported=reported)
        still = [rival for rival in self.rivals if rival.on_route and not rival.ended]
        if len(still) < len(self.rivals):
            self._keep_rivals(still)
        if self.current is not None and self.current.on_route:
            return
        followed = [] if self.current is None else [self.current, *self.rivals]
        for follower in self._followers:
            if follower not in followed:
                follower.observe(pose, lat_deg, lon_deg, reported=reported)
        matching = [follower for follower in self._followers if follower.on_route]
        if matching:
            self._choose(min(matching, key=lambda one: (one.ended, one.offset_m)), matching)

    def _choose(self, chosen: RouteFollower, matching: Sequence[RouteFollower]) -> None:
        """Follow one route."""
        self.current = chosen
        self._keep_rivals([each for each in matching if each is not chosen and not each.ended])

    def _keep_rivals(self, rivals: list[RouteFollower]) -> None:
        """Go on with these; the others start afresh when they are next asked."""
        if self.current is None:
            return
        self.rivals = rivals
        kept = [self.current, *rivals]
        self._followers = [
            each if each in kept else RouteFollower(each.route, self._tuning)
            for each in self._followers
        ]
