"""Pure: Kalman filters for GPS alone: the discrete one of papers/003 and its modification.

papers/003 runs x' = A x (eq. 7, 8) and its update (eq. 11 to 13) on position and speed, each by
itself with A = 1. Here position and velocity are one state, A moving the one by the other: the
same filter where fixes come, and constant velocity where none do. filterpy does the algebra.
"""

import math
from collections.abc import Callable
from enum import IntEnum
from typing import ClassVar, NamedTuple

import msgspec
import numpy as np
from filterpy.common import Q_continuous_white_noise
from filterpy.kalman import KalmanFilter

from wayline.geo import LocalPlane, wrap_360
from wayline.grid import LONGEST_GAP_NS
from wayline.messages import Verdict
from wayline.tuning import Tuning
from wayline_fusion.architectures.architecture import Motion, SensorErrors
from wayline_fusion.filter.plane import moved_along
from wayline_fusion.filter.states import Floats
from wayline_fusion.filter.vertical import Progress
from wayline_fusion.intake.events import Elapsed, Event, Fix

SPEED_UNKNOWN_MPS = 40.0
"""Per axis, at the first fix."""
TURNING_RADIUS_M = 6.0
"""At a crawl the velocity's direction is noise; the last one is held, and turns this tightly."""
HEADING_UNKNOWN_RAD = math.pi / math.sqrt(3.0)
"""Std of a direction of which nothing is known."""


class PlanarStates(IntEnum):
    """Places in the state vector, with the unit of each."""

    EAST = 0  # m
    NORTH = 1  # m
    EAST_VELOCITY = 2  # m/s
    NORTH_VELOCITY = 3  # m/s


S = PlanarStates
PLACE, VELOCITY = [S.EAST, S.NORTH], [S.EAST_VELOCITY, S.NORTH_VELOCITY]
PLACE_OF, VELOCITY_OF = np.eye(len(S))[PLACE], np.eye(len(S))[VELOCITY]
"""Measurement matrices."""


class Noise(NamedTuple):
    """Of one fix, one sigma per axis."""

    position_std_m: float
    velocity_std_mps: float


NoiseOf = Callable[[Fix, Tuning], Noise]


def same_for_all(fix: Fix, tuning: Tuning) -> Noise:
    """The discrete filter's: a figure from the receiver's data sheet, whatever the sky."""
    del fix
    return Noise(tuning.gps_position_std_m, tuning.gps_speed_std_mps)


def by_quality(fix: Fix, tuning: Tuning) -> Noise:
    """The modified filter's: one figure for good fixes, one for those of few satellites or PDOP."""
    good = same_for_all(fix, tuning)
    return good if fix.is_good else Noise(*(tuning.bad_gps_factor * std for std in good))


class Followed(msgspec.Struct, frozen=True):
    """What is known besides the filter's state."""

    t_ns: int = 0
    plane: LocalPlane | None = None
    distance_m: float = 0.0
    fix_ns: int | None = None
    heading_rad: float | None = None
    heading_std_rad: float = HEADING_UNKNOWN_RAD


class Snapshot(NamedTuple):
    """Everything that a rewind sets back."""

    x: Floats
    P: Floats
    track: Followed


class GpsOnly:
    """Position and velocity from fixes; gyro and wheels are not listened to."""

    uses_vehicle: ClassVar[bool] = False
    takes: ClassVar[frozenset[type[Event]]] = frozenset({Elapsed, Fix})

    def __init__(self, tuning: Tuning, noise_of: NoiseOf) -> None:
        self._tuning = tuning
        self._noise_of = noise_of
        self._filter = KalmanFilter(dim_x=len(S), dim_z=2)
        self._filter.x = np.zeros(len(S))
        self._track = Followed()

    def take_gyro(self, t_ns: int, rate_radps: float) -> None:
        """Not listened to."""

    def know_gyro_steps(self, rounding_std_radps: float) -> None:
        """Not listened to either."""

    def snapshot(self) -> Snapshot:
        """For a rewind; what it holds is never changed in place."""
        return Snapshot(self._filter.x, self._filter.P, self._track)

    def restore(self, snapshot: Snapshot) -> None:
        """Set everything back."""
        self._filter.x, self._filter.P, self._track = snapshot

    def take_verdicts(self) -> list[Verdict]:
        """None: the papers' filters have no gate."""
        return []

    def apply(self, event: Event) -> None:
        """Bring the state forward to a fix or a tick; the vehicle's events have no part in it."""
        if isinstance(event, Fix | Elapsed):
            self._advance_to(event.t_ns)
        if isinstance(event, Fix):
            self._fix(event)

    def _remember(self, **changes: object) -> None:
        self._track = msgspec.structs.replace(self._track, **changes)

    def _advance_to(self, t_ns: int) -> None:
        """Time update (eq. 7, 8)."""
        before = self._track
        elapsed_ns = t_ns - before.t_ns
        if before.t_ns == 0 or elapsed_ns > LONGEST_GAP_NS:
            self._track = Followed(t_ns=t_ns, distance_m=before.distance_m)
            return
        if elapsed_ns <= 0 or before.plane is None:
            self._remember(t_ns=max(t_ns, before.t_ns))
            return
        dt_s = elapsed_ns * 1e-9
        noise = np.kron(Q_continuous_white_noise(2, dt_s), self._acceleration_density())
        self._filter.predict(F=np.eye(len(S)) + np.eye(len(S), k=2) * dt_s, Q=noise)
        moved_m = math.hypot(*self._filter.x[VELOCITY]) * dt_s
        self._remember(t_ns=t_ns, distance_m=before.distance_m + moved_m)
        self._move_plane()
        self._direct(moved_m)

    def _acceleration_density(self) -> Floats:
        """Of white acceleration, east and north: any way, and more across where a turn is fast."""
        tuning = self._tuning
        east_mps, north_mps = self._filter.x[VELOCITY]
        across = math.radians(tuning.turn_noise_deg_per_sqrt_s) * np.array([north_mps, -east_mps])
        density: Floats = tuning.acceleration_noise_mps_per_sqrt_s**2 * np.eye(2)
        return density + np.outer(across, across)

    def _move_plane(self) -> None:
        x = self._filter.x
        moved = moved_along(self._track.plane, float(x[S.EAST]), float(x[S.NORTH]))
        if moved is None:
            return
        sin, cos = math.sin(moved.turn_rad), math.cos(moved.turn_rad)
        east_mps, north_mps = x[VELOCITY]
        turned = cos * east_mps + sin * north_mps, cos * north_mps - sin * east_mps
        self._filter.x = np.array([0.0, 0.0, *turned])
        self._remember(plane=moved.plane)

    def _fix(self, fix: Fix) -> None:
        """Measurement update (eq. 11 to 13) with position, and with velocity where measured."""
        noise, plane = self._noise_of(fix, self._tuning), self._track.plane
        if plane is None:
            plane = LocalPlane(fix.lat_deg, fix.lon_deg)
            stds = [noise.position_std_m] * 2 + [SPEED_UNKNOWN_MPS] * 2
            self._filter.x, self._filter.P = np.zeros(len(S)), np.diag(np.square(stds))
        else:
            place_m = np.array(plane.to_plane(fix.lat_deg, fix.lon_deg))
            self._filter.update(place_m, R=noise.position_std_m**2, H=PLACE_OF)
        self._remember(plane=plane, fix_ns=fix.t_ns)
        if fix.speed_mps is not None and not fix.speed_derived:
            self._velocity(fix.speed_mps, fix.course_rad, noise.velocity_std_mps)
        self._direct(0.0)

    def _velocity(self, speed_mps: float, course_rad: float | None, std_mps: float) -> None:
        """At a crawl the course is noise: then the velocity is only known to be small."""
        if speed_mps < self._tuning.course_speed_min_mps:
            variance = std_mps**2 + 0.5 * speed_mps**2
            self._filter.update(np.zeros(2), R=variance, H=VELOCITY_OF)
        elif course_rad is not None:
            velocity_mps = speed_mps * np.array([math.sin(course_rad), math.cos(course_rad)])
            self._filter.update(velocity_mps, R=std_mps**2, H=VELOCITY_OF)

    def _direct(self, moved_m: float) -> None:
        """Heading is the direction of motion, or what it was before a crawl."""
        east_mps, north_mps = (float(value) for value in self._filter.x[VELOCITY])
        speed_mps = math.hypot(east_mps, north_mps)
        if speed_mps >= self._tuning.course_speed_min_mps:
            across = np.array([north_mps, -east_mps]) / speed_mps
            std_rad = self._velocity_std_mps(across) / speed_mps
            self._remember(
                heading_rad=math.atan2(east_mps, north_mps),
                heading_std_rad=min(std_rad, HEADING_UNKNOWN_RAD),
            )
        else:
            std_rad = self._track.heading_std_rad + moved_m / TURNING_RADIUS_M
            self._remember(heading_std_rad=min(std_rad, HEADING_UNKNOWN_RAD))

    def _velocity_std_mps(self, direction: Floats) -> float:
        covariance = self._filter.P[np.ix_(VELOCITY, VELOCITY)]
        return math.sqrt(max(float(direction @ covariance @ direction), 0.0))

    @property
    def progress(self) -> Progress:
        """How far the vehicle has come; it never seems to go backwards."""
        speed_mps = math.hypot(*self._filter.x[VELOCITY])
        return Progress(self._track.t_ns, self._track.distance_m, speed_mps)

    def motion(self) -> Motion:
        """Where the vehicle is now."""
        track, x, covariance = self._track, self._filter.x, self._filter.P
        speed_mps = math.hypot(*x[VELOCITY])
        along = x[VELOCITY] / speed_mps if speed_mps > 0.0 else np.array([0.0, 1.0])
        # no filter of white noise averages out the part of the fixes' error that wanders slowly
        slow_m2 = self._tuning.gps_error_share * self._tuning.gps_position_std_m**2
        heading_deg = math.degrees(track.heading_rad or 0.0)
        return Motion(
            t_ns=track.t_ns,
            accepted_fix_ns=track.fix_ns,
            place_deg=track.plane and track.plane.to_geodetic(float(x[S.EAST]), float(x[S.NORTH])),
            east_std_m=math.sqrt(float(covariance[S.EAST, S.EAST]) + slow_m2),
            north_std_m=math.sqrt(float(covariance[S.NORTH, S.NORTH]) + slow_m2),
            east_north_cov_m2=float(covariance[S.EAST, S.NORTH]),
            heading_deg=None if track.heading_rad is None else wrap_360(heading_deg),
            heading_std_deg=math.degrees(track.heading_std_rad),
            speed_mps=speed_mps if track.plane else None,
            speed_std_mps=self._velocity_std_mps(along),
        )

    def sensor_errors(self) -> SensorErrors:
        """Nothing is learned."""
        return SensorErrors()
