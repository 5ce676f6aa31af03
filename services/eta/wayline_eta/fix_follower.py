"""Pure: one vehicle on one route, from fixes alone, by the published filter of papers/000.

One answer a received row, also for a repeated one. Its position is the filter's own estimate,
which lies beside the route; its speed is the planned one, as the filter has no other.
"""

from wayline.messages import GpsFix, Progress
from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.arrivals import Outlook
from wayline_eta.avl_filter import STEP_S, AvlRouteFilter, Estimate
from wayline_eta.place_tracker import Place
from wayline_eta.presence import Presence
from wayline_eta.stop_visits import StopVisits

STEP_NS = round(STEP_S * 1e9)


class FixFollower:
    """The reference route filter with a clock, laps and stops added."""

    def __init__(self, route: Route, tuning: Tuning) -> None:
        self.route = route
        self._filter = AvlRouteFilter(route)
        self._presence = Presence(tuning)
        self._visits = StopVisits(route, tuning)
        self._estimate: Estimate | None = None
        self._lap = 0
        self.t_ns = 0
        self.known_ns = 0
        """When the last position was received."""

    def observe(self, fix: GpsFix) -> None:
        """Go on by one row."""
        position = _position(fix)
        estimate = self._filter.step(position)
        if estimate is None:
            return
        self._advance_clock(fix, fresh=position is not None)
        self._count_laps(estimate)
        self._estimate = estimate
        place = estimate.place
        std_m = estimate.distance_std_m
        self._presence.observe(Place(self.total_m, place.cross_track_m, std_m, 0.0, 0.0), 0.0)
        self._visits.observe(self.total_m, self.speed_mps, self.t_ns)

    @property
    def total_m(self) -> float:
        """Distance along the route over all laps."""
        return self._lap * self.route.length_m + self._distance_m

    @property
    def speed_mps(self) -> float:
        """The planned speed here, 0 at the end of an open route."""
        ended = self._estimate is not None and self._estimate.ended
        return 0.0 if ended else self.route.speed_at(self._distance_m)

    @property
    def _distance_m(self) -> float:
        return self._estimate.place.distance_m if self._estimate else 0.0

    def _advance_clock(self, fix: GpsFix, *, fresh: bool) -> None:
        if fresh or self._estimate is None:
            self.t_ns = max(self.t_ns, fix.t_ns)
            self.known_ns = self.t_ns
        else:
            self.t_ns += STEP_NS

    def _count_laps(self, estimate: Estimate) -> None:
        if self.route.loop and self._estimate is not None:
            step_m = estimate.place.distance_m - self._distance_m
            self._lap = max(self._lap - round(step_m / self.route.length_m), 0)

    def progress(self) -> Progress | None:
        """Where the vehicle is at the last row; None before the first fix."""
        if self._estimate is None:
            return None
        place = self._estimate.place
        return Progress(
            t_ns=self.t_ns,
            route_id=self.route.route_id,
            distance_m=place.distance_m,
            lap=self._lap,
            lat_deg=self._estimate.lat_deg,
            lon_deg=self._estimate.lon_deg,
            cross_track_m=place.cross_track_m,
            distance_std_m=self._estimate.distance_std_m,
            on_route=self._presence.on_route,
            speed_mps=self.speed_mps,
        )

    def outlook(self) -> Outlook | None:
        """What arrivals are predicted from; None while the vehicle does not follow the route."""
        if self._estimate is None or not self._presence.on_route:
            return None
        return Outlook(
            t_ns=self.t_ns,
            total_m=self.total_m,
            served_m=max(self._visits.served_m, self.total_m),
            distance_std_m=self._estimate.distance_std_m,
        )


def _position(fix: GpsFix) -> tuple[float, float] | None:
    """None for a repeat too: it is not valid."""
    if not fix.valid or fix.lat_deg is None or fix.lon_deg is None:
        return None
    return fix.lat_deg, fix.lon_deg
