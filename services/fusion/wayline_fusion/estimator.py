"""Pure: the horizontal estimator: events in, state forward, verdicts out; can be set back."""

import math
from typing import NamedTuple

import msgspec

from wayline.geo import LocalPlane, wrap_360
from wayline.grid import LONGEST_GAP_NS
from wayline.messages import Verdict
from wayline.tuning import Tuning
from wayline_fusion.events import Event, Fix, WheelSpeed
from wayline_fusion.gate import judge
from wayline_fusion.gyro_track import GyroTrack
from wayline_fusion.horizontal import Floats, HorizontalFilter, Measurement, States

LONGEST_STEP_S = 0.5
PLANE_RADIUS_M = 1_000.0
"""The local plane moves along when the vehicle is this far from its origin."""
WHEELS_FRESH_NS = 2_000_000_000
"""A wheel speed this old no longer says that the vehicle moves or stands."""


class Memory(msgspec.Struct, frozen=True):
    """What the estimator knows besides the filter's state."""

    t_ns: int = 0
    plane: LocalPlane | None = None
    heading_known: bool = False
    distance_m: float = 0.0
    wheels_ns: int | None = None
    still_since_ns: int | None = None
    accepted_fix_ns: int | None = None
    rejected_since_ns: int | None = None
    """First of the positions that were rejected without a break, and the same for courses."""
    course_rejected_since_ns: int | None = None


class Snapshot(NamedTuple):
    """Everything that a rewind sets back."""

    x: Floats
    P: Floats
    memory: Memory


class Estimator:
    """One vehicle's position, heading, speed and the errors of its gyro and odometer."""

    def __init__(self, tuning: Tuning) -> None:
        self.filter = HorizontalFilter(tuning)
        self.gyro = GyroTrack()
        self.memory = Memory()
        self._tuning = tuning
        self._verdicts: list[Verdict] = []

    def take_verdicts(self) -> list[Verdict]:
        """Verdicts since the last call, those of events applied again after a rewind included."""
        verdicts, self._verdicts = self._verdicts, []
        return verdicts

    def snapshot(self) -> Snapshot:
        """Copy of the state, for a rewind."""
        return Snapshot(self.filter.x, self.filter.P, self.memory)

    def restore(self, snapshot: Snapshot) -> None:
        """Set everything back to a snapshot."""
        self.filter.x, self.filter.P = snapshot.x.copy(), snapshot.P.copy()
        self.memory = snapshot.memory

    @property
    def standing(self) -> bool:
        """Whether the wheels have not turned for long enough."""
        since_ns = self.memory.still_since_ns
        if since_ns is None or not self.wheels_fresh:
            return False
        return self.memory.t_ns - since_ns >= self._tuning.standstill_after_s * 1e9

    @property
    def wheels_fresh(self) -> bool:
        """Whether there is a recent wheel speed."""
        wheels_ns = self.memory.wheels_ns
        return wheels_ns is not None and self.memory.t_ns - wheels_ns <= WHEELS_FRESH_NS

    @property
    def located(self) -> bool:
        """Whether position and heading are known."""
        return self.memory.plane is not None and self.memory.heading_known

    def geodetic(self) -> tuple[float, float] | None:
        """Latitude and longitude in degrees; None before the first fix."""
        if self.memory.plane is None:
            return None
        east_m, north_m = self.filter.x[States.EAST], self.filter.x[States.NORTH]
        return self.memory.plane.to_geodetic(float(east_m), float(north_m))

    def apply(self, event: Event) -> None:
        """Bring the state forward to an event and take it in."""
        self._advance_to(event.t_ns)
        if isinstance(event, Fix):
            self._fix(event)
        elif isinstance(event, WheelSpeed):
            self._wheel_speed(event)
        elif self.standing:
            self._stand_still()

    def _remember(self, **changes: object) -> None:
        self.memory = msgspec.structs.replace(self.memory, **changes)

    def _advance_to(self, t_ns: int) -> None:
        memory = self.memory
        if memory.t_ns == 0:
            self._remember(t_ns=t_ns)
            return
        total_s = (t_ns - memory.t_ns) * 1e-9
        if total_s <= 0.0:
            return
        if total_s > LONGEST_GAP_NS * 1e-9:
            self._start_over(t_ns)
            return
        steps = math.ceil(total_s / LONGEST_STEP_S - 1e-9)
        distance_m = memory.distance_m
        for step in range(steps):
            from_ns = memory.t_ns + (t_ns - memory.t_ns) * step // steps
            to_ns = memory.t_ns + (t_ns - memory.t_ns) * (step + 1) // steps
            dt_s = (to_ns - from_ns) * 1e-9
            turn_rad = self.gyro.turned_rad(from_ns, to_ns)
            self.filter.advance(dt_s, turn_rad, standing=self.standing)
            distance_m += abs(float(self.filter.x[States.SPEED])) * dt_s
        self._remember(t_ns=t_ns, distance_m=distance_m)
        self._move_plane()

    def _start_over(self, t_ns: int) -> None:
        """After a silence that no prediction can bridge only the calibration is still good."""
        self.filter.forget_motion()
        distance_m = self.memory.distance_m
        self.memory = Memory(t_ns=t_ns, distance_m=distance_m)

    def _move_plane(self) -> None:
        """Put the origin under the vehicle; north turns by the convergence of the meridians."""
        plane, x = self.memory.plane, self.filter.x
        if plane is None or math.hypot(x[States.EAST], x[States.NORTH]) < PLANE_RADIUS_M:
            return
        lat_deg, lon_deg = plane.to_geodetic(float(x[States.EAST]), float(x[States.NORTH]))
        convergence_deg = (lon_deg - plane.lon_deg) * math.sin(math.radians(lat_deg))
        moved = x.copy()
        moved[States.EAST] = moved[States.NORTH] = 0.0
        moved[States.HEADING] += math.radians(convergence_deg)
        self.filter.x = moved
        self._remember(plane=LocalPlane(lat_deg, lon_deg))

    def _wheel_speed(self, event: WheelSpeed) -> None:
        still = event.speed_mps == 0.0
        since_ns = self.memory.still_since_ns if still else None
        if still and since_ns is None:
            since_ns = event.t_ns
        self._remember(wheels_ns=event.t_ns, still_since_ns=since_ns)
        if self.standing:
            self._stand_still()
        else:
            self.filter.correct(self.filter.odometer(event.speed_mps, event.std_mps))

    def _stand_still(self) -> None:
        """Zero velocity, and the gyro reads its bias."""
        tuning = self._tuning
        self.filter.correct(self.filter.still(tuning.standstill_std_mps))
        rate_radps = self.gyro.rate_radps(self.memory.t_ns)
        if rate_radps is not None:
            std_radps = math.radians(tuning.standstill_gyro_std_degps)
            self.filter.correct(self.filter.still_rate(rate_radps, std_radps))

    def _fix(self, fix: Fix) -> None:
        plane = self.memory.plane
        if plane is None:
            self._remember(plane=LocalPlane(fix.lat_deg, fix.lon_deg))
            self._place(fix, 0.0, 0.0)
        else:
            self._position(fix, *plane.to_plane(fix.lat_deg, fix.lon_deg))
        if fix.speed_mps is not None:
            if not self.wheels_fresh and self.filter.x[States.SPEED] < 0.0:
                self.filter.go_forward()
            self._gated(self.filter.gps_speed(fix.speed_mps, fix.speed_std_mps), fix.t_ns)
            self._course(fix, fix.speed_mps)

    def _place(self, fix: Fix, east_m: float, north_m: float) -> None:
        self.filter.place(east_m, north_m, fix.position_std_m)
        self._remember(accepted_fix_ns=fix.t_ns, rejected_since_ns=None)

    def _position(self, fix: Fix, east_m: float, north_m: float) -> None:
        """Correct with a position; where dead reckoning is not possible yet, start from it."""
        if not self.memory.heading_known:
            self._place(fix, east_m, north_m)
        elif self._gated(self.filter.position(east_m, north_m, fix.position_std_m), fix.t_ns):
            self._remember(accepted_fix_ns=fix.t_ns, rejected_since_ns=None)
        elif self._locked_out(self.memory.rejected_since_ns, fix.t_ns):
            self._place(fix, east_m, north_m)
        else:
            self._remember(rejected_since_ns=self.memory.rejected_since_ns or fix.t_ns)

    def _course(self, fix: Fix, speed_mps: float) -> None:
        tuning = self._tuning
        if fix.course_rad is None or speed_mps < tuning.course_speed_min_mps:
            return
        own_rad = fix.course_std_rad or fix.speed_std_mps / speed_mps
        std_rad = max(own_rad, math.radians(tuning.gps_course_std_deg))
        rate_radps = self.gyro.rate_radps(fix.t_ns) or 0.0
        std_rad = math.hypot(std_rad, rate_radps * tuning.gps_time_std_s)
        since_ns = self.memory.course_rejected_since_ns
        if not self.memory.heading_known or self._locked_out(since_ns, fix.t_ns):
            start_rad = max(std_rad, math.radians(tuning.heading_start_std_deg))
            backwards_rad = math.pi if self.filter.x[States.SPEED] < 0.0 else 0.0
            self.filter.turn_to(fix.course_rad + backwards_rad, start_rad)
            self._remember(heading_known=True, course_rejected_since_ns=None)
        elif self._gated(self.filter.course(fix.course_rad, std_rad), fix.t_ns):
            self._remember(course_rejected_since_ns=None)
        else:
            self._remember(course_rejected_since_ns=since_ns or fix.t_ns)

    def _locked_out(self, since_ns: int | None, t_ns: int) -> bool:
        return since_ns is not None and t_ns - since_ns >= self._tuning.relock_after_s * 1e9

    def _gated(self, measurement: Measurement, t_ns: int) -> bool:
        _, nis = self.filter.innovation(measurement)
        verdict = judge(
            measurement.sensor,
            t_ns,
            nis,
            len(measurement.z),
            self._tuning.gate_probability,
        )
        self._verdicts.append(verdict)
        if verdict.accepted:
            self.filter.correct(measurement)
        return verdict.accepted

    def heading_deg(self) -> float:
        """Heading, true, clockwise from north."""
        return wrap_360(math.degrees(float(self.filter.x[States.HEADING])))
