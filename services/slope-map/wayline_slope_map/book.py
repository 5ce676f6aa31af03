"""What is known of roads and where vehicles are on them, shared between threads.

One thread calls `learn` and `put`, any others the rest. Profiles are never changed, only
replaced, so answers are made outside the lock.
"""

import threading
import time
from collections.abc import Iterable, Mapping, Sequence
from typing import ClassVar

import msgspec

from wayline.matching.matcher import Matcher
from wayline.matching.network import Candidate, First, Sight
from wayline.matching.transition import Moves
from wayline.messages import Horizon, Message, Pose
from wayline.query_error import QueryError
from wayline.view import Clock, Receipt
from wayline_slope_map.matching import Match, RoadIndex, carried_on, on_road
from wayline_slope_map.profile import RoadProfile


class OnRoad(msgspec.Struct, frozen=True):
    """A vehicle's last horizon, and the pose that it was made from."""

    horizon: Horizon
    pose: Pose


class Vehicle(msgspec.Struct, frozen=True):
    """A vehicle's newest pose with its receipt, and its last place on a road."""

    pose: Pose | None = None
    receipt: Receipt = Receipt(0)
    on_road: OnRoad | None = None


class _Told:
    """Of an index that others use as well, the roads that have been told."""

    def __init__(self, index: RoadIndex, profiles: Mapping[str, RoadProfile]) -> None:
        self._index, self._profiles = index, profiles

    def near(self, sight: Sight) -> Sequence[Candidate]:
        """Every point of such a road near a place."""
        return [each for each in self._index.near(sight) if each.edge_id in self._profiles]

    def first(self, candidates: Sequence[Candidate]) -> Sequence[First]:
        """Where they are; nothing speaks against any."""
        return self._index.first(candidates)

    def advance_m(self, earlier: Candidate, later: Candidate, about_m: float) -> float | None:
        """Along one road in one direction; None where that is not one road."""
        return self._index.advance_m(earlier, later, about_m)


class SlopeBook:
    """The profiles of all roads; `clock_ns` is the clock of the receipts.

    The index may be one that cores look at too: that of 10,000 km is a third of a gigabyte.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({Pose})

    def __init__(
        self,
        profiles: Iterable[RoadProfile] = (),
        clock_ns: Clock = time.monotonic_ns,
        index: RoadIndex | None = None,
    ) -> None:
        self._clock_ns = clock_ns
        self._lock = threading.Lock()
        self._profiles: dict[str, RoadProfile] = {}
        self._index = index or RoadIndex()
        self._vehicles: dict[str, Vehicle] = {}
        for profile in profiles:
            self.learn(profile)

    def learn(self, profile: RoadProfile) -> None:
        """Take a road as it is known from now on."""
        with self._lock:
            self._profiles[profile.road.road_id] = profile
            self._index.add(profile.road)

    def put(self, vehicle_id: str, message: Message, source: str, receipt: Receipt) -> None:
        """Take a message of a vehicle: Pose or Horizon, in order; others are ignored."""
        del source
        with self._lock:
            vehicle = self._vehicles.get(vehicle_id, Vehicle())
            match message:
                case Pose():
                    now = Vehicle(message, receipt, vehicle.on_road)
                case Horizon() if vehicle.pose is not None:
                    now = Vehicle(vehicle.pose, vehicle.receipt, OnRoad(message, vehicle.pose))
                case _:
                    return
            self._vehicles[vehicle_id] = now

    def forget(self, vehicle_id: str) -> None:
        """Drop a vehicle that has been silent for long."""
        with self._lock:
            self._vehicles.pop(vehicle_id, None)

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
        sight = Sight(0, lat_deg, lon_deg, 0.0, heading_deg)
        with self._lock:
            told = _Told(self._index, self._profiles)
            matched = Matcher(told).observe(sight, Moves.measured(0.0))
            found = self._profiles[matched.candidate.edge_id] if matched else None
        if matched is None or found is None:
            return None
        return found, on_road(found.road, Match.of(matched.candidate))

    def vehicle_ids(self) -> list[str]:
        """Every vehicle whose pose was heard and that is not yet forgotten."""
        with self._lock:
            return sorted(self._vehicles)

    def vehicle_age_s(self, vehicle_id: str) -> float:
        """Of a vehicle's last pose. Raises QueryError (404) for an unknown vehicle."""
        with self._lock:
            return self._vehicle(vehicle_id).receipt.age_s(self._clock_ns())

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
    if horizon.position_m is None or horizon.direction is None:
        return None
    # a restart of fusion counts anew: nothing to carry on by until the next horizon
    moved_m = max(vehicle.pose.distance_m - pose.distance_m, 0.0)
    match = Match(profile.road.road_id, horizon.direction, horizon.position_m, 0.0)
    return carried_on(profile.road, match, moved_m)
