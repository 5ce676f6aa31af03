"""Pure: one vehicle on one route, from poses: its place, its presence and the stops it served."""

import math

import numpy as np
from numpy.typing import NDArray

from wayline.messages import Pose, Progress
from wayline.route import Route
from wayline.tuning import Tuning
from wayline_eta.along_filter import Along, AlongFilter
from wayline_eta.arrivals import Outlook
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.place_tracker import Place, PlaceTracker, travelled_between_m
from wayline_eta.presence import WRONG_WAY_DEG, Presence
from wayline_eta.stop_log import Seen
from wayline_eta.stop_visits import StopVisits
from wayline_eta.told_place import HOLD_M, ToldPlace

Floats = NDArray[np.float64]

EXTRAPOLATE_AT_MOST_S = 2.0
REACHED_M = 0.5
"""A vehicle whose place is told so near before a stop has reached it: places are means."""
SEAM_M = 1e-6
"""So near before its end a lap is over: sums of distances are rounded."""
HOLD_SIGMAS = 3.0
"""Of a pose: a place that falls back by less, or by HOLD_M, is noise."""


class RouteFollower:
    """The default route filter: place by `PlaceTracker`, going on at the vehicle's speed.

    Of a vehicle that is seen seldom `AlongFilter` tells how it goes on.
    """

    def __init__(self, route: Route, tuning: Tuning) -> None:
        self.route, self._tuning = route, tuning
        self._tracker = PlaceTracker(route)
        self._motion = ExpectedMotion(route)
        self._presence = Presence(tuning)
        self._visits = StopVisits(route, tuning)
        self._pose: Pose | None = None
        self._place: Place | None = None
        self._speed_mps = 0.0
        self._along: AlongFilter | None = None
        """While the vehicle is followed by its reports, on the route."""
        self._has_turned = False
        """It drives back from the last stop, which it reached between two reports."""
        self._told = ToldPlace()

    @property
    def on_route(self) -> bool:
        """Whether the vehicle follows this route."""
        return self._presence.on_route

    @property
    def offset_m(self) -> float:
        """How far from the route the vehicle is, either side."""
        return abs(self._place.cross_track_m) if self._place else float("inf")

    @property
    def total_m(self) -> float:
        """How far along the route the vehicle is; 0 before the first pose."""
        return self._place.total_m if self._place else 0.0

    @property
    def served_m(self) -> float:
        """Stops up to here have been arrived at."""
        return self._last_m if self._has_turned else self._visits.served_m

    @property
    def _last_m(self) -> float:
        stops_m = self._motion.stops_m
        return float(stops_m[-1]) if len(stops_m) and not self.route.loop else np.inf

    def run_as(self, route: Route, leaves_ns: Floats | None = None) -> None:
        """Go on by another plan of the same line: other speeds, dwells and waits.

        `leaves_ns`, one a stop, is when the vehicle leaves it at the earliest.
        """
        self.route, self._motion = route, ExpectedMotion(route, leaves_ns)
        self._visits.run_as(route, self._motion.stop_dwells_s, self._motion.stop_leaves_ns)
        if self._along is not None:
            self._along.run_as(self._motion)

    def again(self) -> "RouteFollower":
        """A follower for a further trip on the line; a circular one begins where this ended."""
        follower = RouteFollower(self.route, self._tuning)
        if self._pose is not None and self._tracker.is_circular:
            follower.set_out(self._pose)
        return follower

    def set_out(self, pose: Pose) -> None:
        """Begin at the start, with the pose that was seen there."""
        self._tracker.set_out(pose)

    @property
    def motion(self) -> ExpectedMotion:
        """How vehicles are expected to move along it."""
        return self._motion

    @property
    def seen(self) -> Seen | None:
        """Where the vehicle was when it was last seen; None off the route."""
        if self._pose is None or self._place is None or not self.on_route:
            return None
        if self._along is None:
            stands = abs(self._speed_mps) < self._tuning.eta_standing_mps
            return Seen(
                self._pose.t_ns,
                self._place.total_m,
                stands,
                reported=False,
                speed_mps=self._speed_mps,
            )
        along = self._along.at(self._pose.t_ns)
        if self._has_turned:
            return Seen(self._pose.t_ns, self._last_m, True, reported=True, stood_s=along.stood_s)
        stands = along.speed_mps == 0.0
        return Seen(self._pose.t_ns, along.total_m, stands, reported=True, stood_s=along.stood_s)

    @property
    def ended(self) -> bool:
        """The vehicle is at the end of an open route: it may be about to start another."""
        at_m = self._place.total_m if self._place else 0.0
        return not self.route.loop and at_m > self.route.length_m - self._tuning.stop_radius_m

    def observe(
        self, pose: Pose, lat_deg: float, lon_deg: float, *, reported: bool = False
    ) -> None:
        """Take the next pose with its position in degrees; older ones are ignored.

        Of a report, and of the last pose before reports are followed, nothing is known of what
        follows: the route then tells how the vehicle goes on.
        """
        if self._pose is not None and not self._is_news(pose, reported=reported):
            return
        if reported:
            self._report(pose, lat_deg, lon_deg)
            return
        told_m = None if self._along is None else self._total_at(pose.t_ns)
        self._along = None
        place = self._held(self._tracker.observe(pose, lat_deg, lon_deg))
        if told_m is not None:
            self._told.see(pose.t_ns, told_m, self.total_m, place.total_m)
        self._speed_mps = _speed_of(self._pose, pose)
        self._pose, self._place = pose, place
        if self._presence.observe(place, self._speed_mps):
            self._visits.observe(place.total_m, self._speed_mps, pose.t_ns)

    def _is_news(self, pose: Pose, *, reported: bool) -> bool:
        """The last pose is so once more when reports begin to be followed."""
        assert self._pose is not None  # noqa: S101
        begins = reported and self._along is None
        return pose.t_ns > self._pose.t_ns or (begins and pose.t_ns == self._pose.t_ns)

    def _report(self, pose: Pose, lat_deg: float, lon_deg: float) -> None:
        silent_s = (pose.t_ns - self._pose.t_ns) * 1e-9 if self._pose is not None else 0.0
        if silent_s > self._tuning.eta_forget_after_s:
            self._along = None
        before = self._along.at(pose.t_ns) if self._along is not None else None
        last_m = self.total_m
        self._told.keep(pose.t_ns)
        if self._pose is not None and pose.t_ns == self._pose.t_ns and self._place is not None:
            place = self._place
        else:
            expected_m = None
            if before is not None and self._place is not None:
                expected_m = before.total_m - self._place.total_m
            place = self._tracker.observe(pose, lat_deg, lon_deg, expected_m)
            self._speed_mps = _speed_of(self._pose, pose)
            self._presence.observe(place, self._speed_mps)
        self._has_turned = self.on_route and self._turns(before, place)
        self._pose, self._place = pose, place
        if self._has_turned:
            self._place = place._replace(total_m=self._last_m)
            return
        if not self._presence.on_route:
            self._along = None
            return
        is_far = abs(place.cross_track_m) > self._tuning.off_route_m
        if not is_far or self._along is None:
            self._along = self._measured(pose, place)
        along = self._along.at(pose.t_ns)
        expected_m = before.total_m if before is not None else None
        self._told.report(expected_m, last_m, along.total_m, drives=along.speed_mps > 0.0)
        self._place = place._replace(total_m=along.total_m)
        self._visits.observe(along.total_m, along.speed_mps, pose.t_ns)

    def _turns(self, before: Along | None, place: Place) -> bool:
        """Whether it drives the other way, at a time when it was to have been at the last stop."""
        if before is None or place.turn_deg <= WRONG_WAY_DEG:
            return False
        return before.total_m + before.std_m >= self._last_m

    def _measured(self, pose: Pose, place: Place) -> AlongFilter:
        along, told_mps = self._along, pose.speed_mps
        if along is None:
            place_m, std_m = place.total_m, place.along_std_m
            return AlongFilter(self._motion, pose.t_ns, place_m, std_m, told_mps or 0.0)
        moves = None
        if told_mps is not None:
            standing, moving = self._tuning.eta_standing_mps, self._tuning.eta_moving_mps
            moves = True if told_mps >= moving else False if told_mps < standing else None
        along.report(pose.t_ns, place.total_m, place.along_std_m, moves=moves, speed_mps=told_mps)
        return along

    def _held(self, place: Place) -> Place:
        if self._place is None:
            return place
        behind_m = self._place.total_m - place.total_m
        limit_m = max(HOLD_M, HOLD_SIGMAS * place.along_std_m)
        held = 0.0 < behind_m < limit_m
        return place._replace(total_m=self._place.total_m) if held else place

    def progress(self, t_ns: int) -> Progress | None:
        """Where the vehicle is at an instant soon after its last pose; None before the first."""
        if self._place is None:
            return None
        place, total_m = self._place, self._total_at(t_ns)
        along = self._along.at(t_ns) if self._along is not None else None
        lap, within_m = lap_of(self.route, total_m)
        lat_deg, lon_deg, _ = self.route.line.point_at(within_m)
        return Progress(
            t_ns=t_ns,
            route_id=self.route.route_id,
            distance_m=within_m,
            lap=lap,
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            cross_track_m=place.cross_track_m,
            distance_std_m=self._std_about(total_m, t_ns),
            on_route=self.on_route,
            speed_mps=along.speed_mps if along else self._speed_mps,
        )

    def outlook(self, t_ns: int) -> Outlook | None:
        """What arrivals are predicted from; None while the vehicle does not follow the route.

        Of an instant at most EXTRAPOLATE_AT_MOST_S after the last pose, or any after a report.
        """
        if self._place is None or self._pose is None or not self.on_route:
            return None
        if self._along is not None:
            along = self._along.at(t_ns)
            return Outlook(
                t_ns=t_ns,
                total_m=along.total_m,
                served_m=max(self._visits.served_m, along.total_m + REACHED_M),
                distance_std_m=along.std_m,
                stand=along.stand,
            )
        at_ns = min(t_ns, self._pose.t_ns + round(EXTRAPOLATE_AT_MOST_S * 1e9))
        total_m = self._ahead_m(at_ns)
        return Outlook(
            t_ns=at_ns,
            total_m=total_m,
            served_m=self._visits.served_by(total_m, self._speed_mps),
            distance_std_m=self._place.along_std_m,
            stand=self._visits.stand(at_ns),
            drives=self._speed_mps >= self._tuning.eta_standing_mps,
        )

    def _total_at(self, t_ns: int) -> float:
        """What is told of the place: it may wait for the vehicle."""
        if self._place is None or self._pose is None:
            return 0.0
        if self._along is not None:
            return max(self._along.at(t_ns).total_m, self._told.floor_m(t_ns))
        total_m = self._ahead_m(t_ns)
        return max(total_m, self._told.floor_m(t_ns)) if self.on_route else total_m

    def _ahead_m(self, t_ns: int) -> float:
        """Where a vehicle that is seen all the time has come to since its last pose."""
        assert self._place is not None  # noqa: S101
        assert self._pose is not None  # noqa: S101
        ahead_s = min(max((t_ns - self._pose.t_ns) * 1e-9, 0.0), EXTRAPOLATE_AT_MOST_S)
        speed_mps = max(self._speed_mps, 0.0) if self.on_route else 0.0
        total_m = self._place.total_m + speed_mps * ahead_s
        return total_m if self.route.loop else min(total_m, self.route.length_m)

    def _std_about(self, total_m: float, t_ns: int) -> float:
        """Of the vehicle's place about what is told of it."""
        assert self._place is not None  # noqa: S101
        if self._along is None:
            return math.hypot(self._place.along_std_m, total_m - self._ahead_m(t_ns))
        along = self._along.at(t_ns)
        return math.hypot(along.std_m, total_m - along.total_m)


def lap_of(route: Route, total_m: float) -> tuple[int, float]:
    """The lap (0 is the first) and the distance within it, 0 <= x < length on a loop."""
    if not route.loop or total_m <= 0.0:
        return 0, max(total_m, 0.0)
    lap, within_m = divmod(total_m + SEAM_M, route.length_m)
    return int(lap), max(within_m - SEAM_M, 0.0)


def _speed_of(last: Pose | None, pose: Pose) -> float:
    """The pose's speed; where it has none, from the distance travelled since the last one."""
    if pose.speed_mps is not None:
        return pose.speed_mps
    if last is None:
        return 0.0
    return travelled_between_m(last, pose) / ((pose.t_ns - last.t_ns) * 1e-9)
