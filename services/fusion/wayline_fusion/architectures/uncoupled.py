"""Pure: GPS and dead reckoning side by side, uncoupled (papers/001, "Integration architectures").

Neither affects the other: every fix is believed as it is, and between fixes and without them the
position starts at the last one, along its course, by gyro and odometer as they read. The
prediction is that of loose coupling; what it would have corrected stays as it came from the box,
and so do the stds, which therefore grow fast.
"""

import math
from typing import ClassVar, NamedTuple

import msgspec

from wayline.geo import LocalPlane, wrap_360
from wayline.grid import LONGEST_GAP_NS
from wayline.messages import Verdict
from wayline.tuning import Tuning
from wayline_fusion.architectures.architecture import Motion, SensorErrors
from wayline_fusion.filter.gyro_track import GyroTrack, TakeGyro
from wayline_fusion.filter.horizontal import DrivingNoise, HorizontalFilter
from wayline_fusion.filter.plane import moved_along
from wayline_fusion.filter.states import Floats, States
from wayline_fusion.filter.vertical import Progress
from wayline_fusion.intake.events import ClockStep, Elapsed, Event, Fix, WheelSpeed

S = States
WHEELS_FRESH_NS = 2_000_000_000
"""Without a wheel speed this long the speed is that of the fixes."""
ROUNDING_CORRELATION_S = 0.1
"""While driving, the rate goes through a coarse gyro's steps this fast."""


class Reckoned(msgspec.Struct, frozen=True):
    """What is known besides the filter's state."""

    t_ns: int = 0
    plane: LocalPlane | None = None
    heading_known: bool = False
    distance_m: float = 0.0
    wheels_ns: int | None = None
    fix_ns: int | None = None


class Snapshot(NamedTuple):
    """Everything that a rewind sets back."""

    x: Floats
    P: Floats
    reckoned: Reckoned


class Uncoupled:
    """Dead reckoning from the last fix without feedback."""

    uses_vehicle: ClassVar[bool] = True
    takes: ClassVar[frozenset[type[Event]]] = frozenset({ClockStep, Elapsed, Fix, WheelSpeed})

    def __init__(self, tuning: Tuning) -> None:
        self._tuning = tuning
        self._filter = HorizontalFilter(tuning)
        self._gyro = GyroTrack()
        self.take_gyro: TakeGyro = self._gyro.add
        self._gyro_rounding_radps = 0.0
        self._reckoned = Reckoned()

    def know_gyro_steps(self, rounding_std_radps: float) -> None:
        """Count the gyro's steps as noise."""
        self._gyro_rounding_radps = rounding_std_radps

    def snapshot(self) -> Snapshot:
        """For a rewind; what it holds is never changed in place."""
        return Snapshot(self._filter.x, self._filter.P, self._reckoned)

    def restore(self, snapshot: Snapshot) -> None:
        """Set everything back."""
        self._filter.x, self._filter.P, self._reckoned = snapshot

    def take_verdicts(self) -> list[Verdict]:
        """None: whatever a receiver says is believed."""
        return []

    def apply(self, event: Event) -> None:
        """Bring the state forward to an event and take it in."""
        self._advance_to(event.t_ns)
        if isinstance(event, Fix):
            self._fix(event)
        elif isinstance(event, WheelSpeed):
            self._remember(wheels_ns=event.t_ns)
            self._set_speed(event.speed_mps, event.std_mps, by_wheels=True)

    def _remember(self, **changes: object) -> None:
        self._reckoned = msgspec.structs.replace(self._reckoned, **changes)

    @property
    def _wheels_fresh(self) -> bool:
        wheels_ns = self._reckoned.wheels_ns
        return wheels_ns is not None and self._reckoned.t_ns - wheels_ns <= WHEELS_FRESH_NS

    def _advance_to(self, t_ns: int) -> None:
        """Ticks come ten times a second, so that no step is long."""
        before, kalman = self._reckoned, self._filter
        elapsed_ns = t_ns - before.t_ns
        if before.t_ns == 0 or elapsed_ns > LONGEST_GAP_NS:
            kalman.reset_motion()
            self._reckoned = Reckoned(t_ns=t_ns, distance_m=before.distance_m)
        elif elapsed_ns > 0:
            turn_rad = self._gyro.turned_rad(before.t_ns, t_ns)
            standing = self._wheels_fresh and kalman.x[S.WHEEL_SPEED] == 0.0
            dt_s = elapsed_ns * 1e-9
            kalman.advance(dt_s, turn_rad, self._noise(), standing=standing)
            moved_m = abs(kalman.speed_mps) * dt_s
            self._remember(t_ns=t_ns, distance_m=before.distance_m + moved_m)
            self._move_plane()

    def _noise(self) -> DrivingNoise:
        walk_rad = math.radians(self._tuning.gyro_noise_deg_per_sqrt_s)
        rounding_rad = self._gyro_rounding_radps * math.sqrt(ROUNDING_CORRELATION_S)
        bias_walk = math.radians(self._tuning.gyro_bias_walk_degps_per_sqrt_s)
        return DrivingNoise(
            math.hypot(walk_rad, rounding_rad), bias_walk, self._tuning.gps_error_time_s
        )

    def _move_plane(self) -> None:
        x = self._filter.x
        moved = moved_along(self._reckoned.plane, float(x[S.EAST]), float(x[S.NORTH]))
        if moved is not None:
            self._filter.recentre(moved.turn_rad)
            self._remember(plane=moved.plane)

    def _fix(self, fix: Fix) -> None:
        """Start from a fix anew, along its course where it has one worth the name."""
        plane = self._reckoned.plane or LocalPlane(fix.lat_deg, fix.lon_deg)
        self._filter.reset_position(*plane.to_plane(fix.lat_deg, fix.lon_deg), fix.position_std_m)
        self._remember(plane=plane, fix_ns=fix.t_ns)
        if fix.speed_mps is None:
            return
        if not self._wheels_fresh:
            self._set_speed(fix.speed_mps, fix.speed_std_mps, by_wheels=False)
        if fix.course_rad is not None and fix.speed_mps >= self._tuning.course_speed_min_mps:
            floor_rad = math.radians(self._tuning.gps_course_std_deg)
            std_rad = fix.course_std_rad or fix.speed_std_mps / fix.speed_mps
            backwards_rad = math.pi if self._filter.x[S.WHEEL_SPEED] < 0.0 else 0.0
            heading_rad = fix.course_rad + backwards_rad
            self._filter.reset_heading(heading_rad, math.hypot(std_rad, floor_rad))
            self._remember(heading_known=True)

    def _set_speed(self, speed_mps: float, std_mps: float, *, by_wheels: bool) -> None:
        """Set the speed; that of the wheels is off by their scale, that of a fix is not."""
        self._filter.reset_wheel_speed(speed_mps, std_mps, is_over_ground=not by_wheels)

    @property
    def progress(self) -> Progress:
        """How far the vehicle has come."""
        reckoned = self._reckoned
        return Progress(reckoned.t_ns, reckoned.distance_m, self._filter.speed_mps)

    def motion(self) -> Motion:
        """Where the vehicle is now."""
        reckoned, kalman = self._reckoned, self._filter
        x, plane = kalman.x, reckoned.plane
        heading_deg = wrap_360(math.degrees(float(x[S.HEADING])))
        rate_radps = self._gyro.rate_radps(reckoned.t_ns)
        return Motion(
            t_ns=reckoned.t_ns,
            accepted_fix_ns=reckoned.fix_ns,
            place_deg=plane and plane.to_geodetic(float(x[S.EAST]), float(x[S.NORTH])),
            east_std_m=kalman.std(S.EAST),
            north_std_m=kalman.std(S.NORTH),
            east_north_cov_m2=float(kalman.P[S.EAST, S.NORTH]),
            heading_deg=heading_deg if reckoned.heading_known else None,
            heading_std_deg=math.degrees(kalman.std(S.HEADING)),
            speed_mps=kalman.speed_mps if plane or self._wheels_fresh else None,
            speed_std_mps=kalman.speed_std_mps,
            yaw_rate_degps=None if rate_radps is None else math.degrees(rate_radps),
        )

    def sensor_errors(self) -> SensorErrors:
        """Nothing is learned."""
        return SensorErrors()
