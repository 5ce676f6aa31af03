"""Pure: the distance of a trip from its messages, with its std (papers/003).

From GPS alone it is the sum of smoothed speeds, holes bridged. Wheels, where there are some, count
every metre but know their own size badly: fixes without a hole between them tell their scale, and
then wheels tell the whole way, before the first fix and through holes too.
"""

import math
from typing import Literal, NamedTuple

import numpy as np

from wayline.line import Line
from wayline.messages import GpsFix, Odometer, Pose
from wayline.trip_distance.holes import Bridges
from wayline.trip_distance.integrated_walk import Flags, Floats
from wayline.trip_distance.speeds import profile_of
from wayline.trip_distance.track import Track, track_of
from wayline.trip_distance.trust import holes_between, trusted
from wayline.trip_distance.wheels import Steps, Wheels
from wayline.tuning import Tuning

DistanceBasis = Literal["wheels", "speeds", "positions"]

SPEED_SCALE_STD = 0.001
"""Share of the way by which Doppler's sum may be off however long it is: time stamps, lags."""
ENDS_STD_M = 1.0
"""What a trip's first and last second may hide."""
WHEELS_SCALE_STD = 0.02
"""Of wheels that no fix has measured: tyres wear and speedometers read high."""
SCALED_M_MIN = 200.0
"""A shorter way under fixes does not tell the wheels' scale."""


class TripDistance(NamedTuple):
    """How far a trip went; both in metres, the std one sigma of the total error."""

    distance_m: float
    distance_std_m: float
    basis: DistanceBasis
    bridged_m: float = 0.0
    """Part of the distance that lies in holes of GPS and that no wheels told."""
    doubts: tuple[str, ...] = ()
    """What a user should know of the input; one line each."""


class TripMeter:
    """Takes the messages of one trip of one vehicle, one source a kind, and says how far it went.

    `route` is the line that the vehicle follows, where it is known: it bridges holes.
    """

    def __init__(self, tuning: Tuning | None = None, route: Line | None = None) -> None:
        self._tuning = tuning or Tuning()
        self._route = route
        self._fixes: list[GpsFix] = []
        self._odometer = Wheels()
        self._fused = Wheels()
        self.late = 0
        """Fixes that were left out because their time was not after the one before."""

    def take(self, message: GpsFix | Odometer | Pose) -> None:
        """Messages in order of time; poses count where wheels are in them."""
        if isinstance(message, GpsFix):
            self._fix(message)
        elif isinstance(message, Odometer):
            self._odometer.take(message)
        elif message.mode == "fused" or (message.mode == "dead_reckoning" and self._fused.are_told):
            self._fused.take(message)

    def _fix(self, fix: GpsFix) -> None:
        if not fix.valid or fix.lat_deg is None or fix.lon_deg is None:
            return
        if self._fixes and fix.t_ns <= self._fixes[-1].t_ns:
            self.late += 1
            return
        self._fixes.append(fix)

    def distance(self) -> TripDistance | None:
        """Of the trip so far; None where less than two fixes and no wheels tell of it."""
        wheels = self._odometer if self._odometer.are_told else self._fused
        if len(self._fixes) < 2:
            return _uncalibrated(wheels) if wheels.are_told else None
        by_gps = gps_way(track_of(self._fixes, self._tuning), self._route)
        if not wheels.are_told:
            return by_gps.total()
        steps = wheels.steps([fix.t_ns for fix in self._fixes])
        return _calibrated(by_gps, steps, wheels.driven_m)


class GpsWay(NamedTuple):
    """The way from fix to fix by GPS alone, at n fixes."""

    track: Track
    steps_m: Floats
    """Shape (n - 1,)."""
    bridged: Flags
    """Steps that lie in a hole, shape (n - 1,)."""
    hole_stds_m: Floats
    """One sigma of each step that ends a hole, 0 of the others; shape (n - 1,)."""
    white_std_m: float
    """One sigma of the sum of the steps that are none, by noise."""
    speeds_mps: Floats
    """Smoothed, at the fixes, shape (n,)."""
    basis: DistanceBasis
    doubts: tuple[str, ...]

    def total(self) -> TripDistance:
        """All steps together."""
        distance_m = float(self.steps_m.sum())
        std_m = math.hypot(
            float(np.linalg.norm(self.hole_stds_m)),
            self.white_std_m,
            ENDS_STD_M,
            SPEED_SCALE_STD * distance_m,
        )
        bridged_m = float(self.steps_m[self.bridged].sum())
        return TripDistance(distance_m, std_m, self.basis, bridged_m, self.doubts)


def gps_way(track: Track, route: Line | None = None) -> GpsWay:
    """The way by two fixes or more."""
    profile = profile_of(track)
    steps_m = 0.5 * (profile.speeds_mps[1:] + profile.speeds_mps[:-1]) * track.steps_s
    believed = trusted(track)
    bridges = Bridges(track, steps_m.copy(), believed, route)
    bridged, stds_m = np.zeros(len(steps_m), dtype=bool), np.zeros(len(steps_m))
    for hole in holes_between(track, believed):
        inside = slice(hole.begin, hole.end)
        way = bridges.over(hole)
        steps_m[inside] = way.distance_m * track.steps_s[inside] / track.steps_s[inside].sum()
        bridged[inside], stds_m[hole.end - 1] = True, way.distance_std_m
    doubts = profile.doubts if track.good.any() else (*profile.doubts, "no fix is good")
    return GpsWay(
        track=track,
        steps_m=steps_m,
        bridged=bridged,
        hole_stds_m=stds_m,
        white_std_m=profile.white_std_m,
        speeds_mps=profile.speeds_mps,
        basis=profile.basis,
        doubts=doubts,
    )


def _uncalibrated(wheels: Wheels) -> TripDistance:
    std_m = math.hypot(ENDS_STD_M, WHEELS_SCALE_STD * wheels.driven_m)
    return TripDistance(wheels.driven_m, std_m, "wheels", doubts=("no fix measures the wheels",))


def _calibrated(by_gps: GpsWay, steps: Steps, driven_m: float) -> TripDistance:
    """Wheels where they told, by the scale that fixes without a hole tell; GPS where not."""
    compared = steps.told & ~by_gps.bridged
    scale, scale_std = _scale(
        float(by_gps.steps_m[compared].sum()), float(steps.ways_m[compared].sum()), by_gps
    )
    alone = ~steps.told
    rolled_m = driven_m - float(steps.ways_m[alone].sum())
    distance_m = scale * rolled_m + float(by_gps.steps_m[alone].sum())
    bridged_stds_m = np.where(alone, by_gps.hole_stds_m, 0.0)
    std_m = math.hypot(float(np.linalg.norm(bridged_stds_m)), scale_std * rolled_m, ENDS_STD_M)
    bridged_m = float(by_gps.steps_m[alone & by_gps.bridged].sum())
    return TripDistance(distance_m, std_m, "wheels", bridged_m, by_gps.doubts)


def _scale(by_gps_m: float, by_wheels_m: float, by_gps: GpsWay) -> tuple[float, float]:
    """True way over the wheels', and its std."""
    if by_wheels_m < SCALED_M_MIN or by_gps_m < SCALED_M_MIN:
        return 1.0, WHEELS_SCALE_STD
    noise = math.hypot(by_gps.white_std_m, ENDS_STD_M) / by_wheels_m
    return by_gps_m / by_wheels_m, math.hypot(noise, SPEED_SCALE_STD)
