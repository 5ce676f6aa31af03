"""What is known of roads and where vehicles are on them, shared between threads.

One thread calls `learn` and `put`, any others the rest. Profiles are never changed, only
replaced, so answers are made outside the lock.
"""

import threading
import time
from collections.abc import Callable, Iterable

import msgspec

from wayline.geo import wrap_180, wrap_360
from wayline.messages import Horizon, Message, Pose
from wayline.query_error import QueryError
from wayline_slope_map.matching import Match, RoadIndex, chosen
from wayline_slope_map.profile import RoadProfile


class OnRoad(msgspec.Struct, frozen=True):
    """A vehicle's last horizon, and the pose that it was made from."""

    horizon: Horizon
    pose: Pose


class Vehicle(msgspec.Struct, frozen=True):
    """A vehicle's newest pose, when it was received, and its last place on a road."""

    pose: Pose | None = None
    heard_ns: int = 0
    on_road: OnRoad | None = None


class SlopeBook:
    """The profiles of all roads; `clock_ns` is any clock that only goes forward."""

    def __init__(
        self,
        profiles: Iterable[RoadProfile] = (),
        clock_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._clock_ns = clock_ns
        self._lock = threading.Lock()
        self._profiles: dict[str, RoadProfile] = {}
        self._index = RoadIndex()
        self._vehicles: dict[str, Vehicle] = {}
        for profile in profiles:
            self.learn(profile)

    def learn(self, profile: RoadProfile) -> None:
        """Take a road as it is known from now on."""
        with self._lock:
            self._profiles[profile.road.road_id] = profile
            self._index.add(profile.road)

    def put(self, vehicle_id: str, message: Message, source: str) -> None:
        """Take a message of a vehicle: Pose or Horizon, in order; others are ignored."""
        del source
        with self._lock:
            vehicle = self._vehicles.get(vehicle_id, Vehicle())
            match message:
                case Pose():
                    now = Vehicle(message, self._clock_ns(), vehicle.on_road)
                case Horizon() if vehicle.pose is not None:
                    now = Vehicle(vehicle.pose, vehicle.heard_ns, OnRoad(message, vehicle.pose))
                case _:
                    return
            self._vehicles[vehicle_id] = now

    def profiles(self) -> list[RoadProfile]:
        """Every road."""
        with self._lock:
            return list(self._profiles.values())

    def profile(self, road_id: str) -> RoadProfile:
        """One road. Raises QueryError (404) for one that is not known."""
        with self._lock:
            found = self._profiles.get(road_id)
        if found is None:
            raise QueryError(404, f"no road {road_id}; /v1/roads lists them")
        return found

    def nearest(
        self, lat_deg: float, lon_deg: float, heading_deg: float
    ) -> tuple[RoadProfile, Match] | None:
        """The road at a place that runs along or against a heading, None on none."""
        with self._lock:
            match = chosen(self._index.near(lat_deg, lon_deg, heading_deg), None, 0.0)
            found = self._profiles[match.road_id] if match else None
        return (found, _on_line(found, match)) if match and found else None

    def vehicle_ids(self) -> list[str]:
        """Every vehicle whose pose was heard."""
        with self._lock:
            return sorted(self._vehicles)

    def vehicle_age_s(self, vehicle_id: str) -> float:
        """Since a vehicle's last pose was received. Raises QueryError (404) for an unknown one."""
        with self._lock:
            return max(self._clock_ns() - self._vehicle(vehicle_id).heard_ns, 0) * 1e-9

    def place(self, vehicle_id: str) -> tuple[RoadProfile, Match] | None:
        """A vehicle's place: that of its last horizon, carried on by the distance since.

        None where that horizon lies on no road. Raises QueryError (404) for an unknown vehicle.
        """
        with self._lock:
            vehicle = self._vehicle(vehicle_id)
            road_id = vehicle.on_road.horizon.road_id if vehicle.on_road else None
            found = None if road_id is None else self._profiles.get(road_id)
        match = _carried_on(found, vehicle) if found else None
        return (found, match) if found and match else None

    def _vehicle(self, vehicle_id: str) -> Vehicle:
        vehicle = self._vehicles.get(vehicle_id)
        if vehicle is None:
            raise QueryError(404, f"no vehicle {vehicle_id} was heard")
        return vehicle


def _carried_on(profile: RoadProfile, vehicle: Vehicle) -> Match | None:
    if vehicle.pose is None or vehicle.on_road is None:
        return None
    horizon, pose = vehicle.on_road.horizon, vehicle.on_road.pose
    if horizon.position_m is None or pose.heading_deg is None:
        return None
    direction = _direction(profile, horizon.position_m, pose, pose.heading_deg)
    # a restart of fusion counts anew: nothing to carry on by until the next horizon
    moved_m = max(vehicle.pose.distance_m - pose.distance_m, 0.0)
    along_m = horizon.position_m + direction * moved_m
    return _on_line(profile, Match(profile.road.road_id, direction, along_m, 0.0))


def _direction(profile: RoadProfile, along_m: float, pose: Pose, heading_deg: float) -> int:
    """1 along the road's line, -1 against it; a vehicle in reverse travels tail first."""
    reverse = pose.speed_mps is not None and pose.speed_mps < 0.0
    course_deg = wrap_360(heading_deg + 180.0) if reverse else heading_deg
    _, _, line_deg = profile.road.line.point_at(along_m)
    return 1 if abs(wrap_180(course_deg - line_deg)) <= 90.0 else -1


def _on_line(profile: RoadProfile, match: Match) -> Match:
    """A match may lie metres before the start or after the end; a loop goes on there."""
    along_m, length_m = match.along_m, profile.road.line.length_m
    on_m = along_m % length_m if profile.road.loop else min(max(along_m, 0.0), length_m)
    return match._replace(along_m=on_m)
