"""Pure: fixes and vehicle sensors in, pose and fusion_status out."""

import math
from collections.abc import Sequence
from typing import ClassVar

import msgspec

from wayline.air import metres_per_pascal, pressure_altitude_m
from wayline.gps_quality import altitude_std_m, horizontal_std_m, is_good
from wayline.inputs import Tick
from wayline.messages import (
    Barometer,
    Calibration,
    FusionStatus,
    GpsFix,
    Gyro,
    Message,
    Odometer,
    Pose,
    PoseMode,
    Verdict,
)
from wayline.tuning import Tuning
from wayline_fusion.displacement import Displacement
from wayline_fusion.estimator import Estimator, Snapshot
from wayline_fusion.events import Event, Fix, Step, WheelSpeed
from wayline_fusion.resolution import Resolution
from wayline_fusion.states import States
from wayline_fusion.timeline import Timeline
from wayline_fusion.vertical import States as VerticalStates
from wayline_fusion.vertical import VerticalFilter

SECOND_NS = 1_000_000_000
OUTAGE_NS = 2_000_000_000
"""Without an accepted fix this long, the pose is dead reckoning (SPEC section 2)."""
LOST_STD_M = 100.0
KMH_MPS = 1.0 / 3.6
DILUTION_MIN = 0.6
GYRO_ROUNDING_MAX_DEGPS = 0.15
"""Of steps of half a degree a second; until enough is read, steps seem larger."""


class FusionCore:
    """One vehicle's pose, ten times a second with CAN, else once a fix."""

    reads: ClassVar[frozenset[type[Message]]] = frozenset({GpsFix, Odometer, Gyro, Barometer})
    period_ns: ClassVar[int | None] = 100_000_000

    def __init__(self, tuning: Tuning) -> None:
        self._tuning = tuning
        self._estimator = Estimator(tuning)
        self._timeline: Timeline[Event, Snapshot] = Timeline(
            self._estimator.apply,
            self._estimator.snapshot,
            self._estimator.restore,
            round(tuning.late_measurement_s * 1e9),
        )
        self._vertical = VerticalFilter(tuning)
        self._displacement = Displacement()
        self._wheel_steps = Resolution(1e-4)
        self._pressure_steps = Resolution(0.1)
        self._rate_steps = Resolution(1e-4)
        self._pressure_altitude_m: float | None = None
        self._reverse = False
        self._can_ns: int | None = None
        self._fix_ns: int | None = None
        self._pose_ns = 0
        self._distance_m = 0.0
        self._climbed_at = (0, 0.0)
        self._late = 0
        self._rejected = 0
        self._verdicts: list[Verdict] = []

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message]:
        """Take a fix, a sensor's message or a Tick; return the poses and status due."""
        del source
        if isinstance(message, Gyro):
            self._gyro(message)
        elif isinstance(message, Tick):
            return self._tick(message.t_ns)
        elif isinstance(message, Odometer):
            self._odometer(message)
        elif isinstance(message, GpsFix):
            return self._gps_fix(message)
        elif isinstance(message, Barometer):
            self._barometer(message)
        return ()

    def _gyro(self, gyro: Gyro) -> None:
        if gyro.yaw_rate_degps is not None:
            self._can_ns = gyro.t_ns
            self._rate_steps.learn(gyro.yaw_rate_degps)
            rounding_degps = min(self._rate_steps.std, GYRO_ROUNDING_MAX_DEGPS)
            self._estimator.gyro_rounding_radps = math.radians(rounding_degps)
            self._estimator.gyro.add(gyro.t_ns, math.radians(gyro.yaw_rate_degps))

    def _odometer(self, odometer: Odometer) -> None:
        if odometer.reverse is not None:
            self._reverse = odometer.reverse
        if odometer.speed_mps is None:
            return
        self._can_ns = odometer.t_ns
        self._wheel_steps.learn(odometer.speed_mps)
        rounding_mps = min(self._wheel_steps.std, KMH_MPS)
        std_mps = math.hypot(rounding_mps, self._tuning.odometer_std_mps)
        signed_mps = -odometer.speed_mps if self._reverse else odometer.speed_mps
        self._add(WheelSpeed(odometer.t_ns, signed_mps, std_mps))

    def _gps_fix(self, fix: GpsFix) -> Sequence[Message]:
        if not fix.valid or fix.lat_deg is None or fix.lon_deg is None:
            return ()
        self._fix_ns = fix.t_ns
        self._add(self._fix_event(fix, fix.lat_deg, fix.lon_deg))
        if fix.alt_m is not None and "gps" in self._tuning.vertical_sensors:
            self._climb()
            self._vertical.gps(fix.alt_m, altitude_std_m(fix, self._tuning))
        if self._has_can(fix.t_ns) or fix.t_ns <= self._pose_ns:
            return [self._status(fix.t_ns)]
        self._pose_ns = fix.t_ns
        return [self._pose(), self._status(fix.t_ns)]

    def _fix_event(self, fix: GpsFix, lat_deg: float, lon_deg: float) -> Fix:
        position_std_m = horizontal_std_m(fix, self._tuning)
        # a speed derived from the positions is no second measurement beside them
        speed_mps = None if fix.speed_derived else fix.speed_mps
        speed_std_mps = fix.speed_std_mps
        course_deg, course_std_deg = fix.course_deg, fix.course_std_deg
        if speed_mps is None and (motion := self._displacement.motion(fix, position_std_m)):
            speed_mps, speed_std_mps = motion.speed_mps, motion.speed_std_mps
            if course_deg is None:
                course_deg, course_std_deg = motion.course_deg, motion.course_std_deg
        return Fix(
            fix.t_ns,
            lat_deg,
            lon_deg,
            position_std_m,
            speed_mps,
            speed_std_mps or speed_std_mps_of(fix, self._tuning),
            None if course_deg is None else math.radians(course_deg),
            None if course_std_deg is None else math.radians(course_std_deg),
        )

    def _barometer(self, barometer: Barometer) -> None:
        pressure_pa = barometer.pressure_pa
        if pressure_pa is None or "barometer" not in self._tuning.vertical_sensors:
            return
        self._pressure_steps.learn(pressure_pa)
        rounding_m = self._pressure_steps.std * metres_per_pascal(pressure_pa)
        if rounding_m <= self._tuning.baro_resolution_std_max_m and self._vertical.known:
            self._climb()
            std_m = math.hypot(rounding_m, self._tuning.baro_std_m)
            self._vertical.barometer(pressure_altitude_m(pressure_pa), std_m)

    def _tick(self, t_ns: int) -> Sequence[Message]:
        self._add(Step(t_ns))
        messages: list[Message] = []
        on_second = t_ns % SECOND_NS == 0
        without_fix = self._fix_ns is None or t_ns - self._fix_ns > SECOND_NS
        if t_ns > self._pose_ns and (self._has_can(t_ns) or (on_second and without_fix)):
            self._climb()
            self._pose_ns = t_ns
            messages.append(self._pose())
        if on_second:
            messages.append(self._status(t_ns))
        return messages

    def _add(self, event: Event) -> None:
        """Apply an event; told are its own verdicts, not those of events that it set back."""
        if not self._timeline.add(event):
            self._late += 1
        verdicts = [v for v in self._estimator.take_verdicts() if v.t_ns == event.t_ns]
        self._rejected += sum(not verdict.accepted for verdict in verdicts)
        self._verdicts += verdicts

    def _has_can(self, t_ns: int) -> bool:
        return self._can_ns is not None and t_ns - self._can_ns <= SECOND_NS

    def _climb(self) -> None:
        """Bring the vertical filter forward to where the vehicle is now."""
        memory = self._estimator.memory
        t_ns, distance_m = self._climbed_at
        self._climbed_at = (memory.t_ns, memory.distance_m)
        if t_ns and memory.t_ns > t_ns:
            backwards = self._estimator.filter.x[States.SPEED] < 0.0
            driven_m = max(memory.distance_m - distance_m, 0.0)
            self._vertical.advance(
                -driven_m if backwards else driven_m, (memory.t_ns - t_ns) * 1e-9
            )

    def _mode(self) -> PoseMode:
        memory = self._estimator.memory
        if not self._estimator.located or memory.accepted_fix_ns is None:
            return "starting"
        east_std_m, north_std_m = self._position_stds()
        if max(east_std_m, north_std_m) > LOST_STD_M:
            return "lost"
        if memory.t_ns - memory.accepted_fix_ns > OUTAGE_NS:
            return "dead_reckoning"
        return "fused" if self._has_can(memory.t_ns) else "gps"

    def _position_stds(self) -> tuple[float, float]:
        kalman = self._estimator.filter
        return kalman.std(States.EAST), kalman.std(States.NORTH)

    def _pose(self) -> Pose:
        estimator, kalman, vertical = self._estimator, self._estimator.filter, self._vertical
        memory = estimator.memory
        self._distance_m = max(self._distance_m, memory.distance_m)
        place = estimator.geodetic()
        moving = place is not None or estimator.wheels_fresh
        heading = memory.heading_known
        east_std_m, north_std_m = self._position_stds()
        rate_radps = estimator.gyro.rate_radps(memory.t_ns)
        x = kalman.x
        return Pose(
            t_ns=self._pose_ns,
            mode=self._mode(),
            lat_deg=place[0] if place else None,
            lon_deg=place[1] if place else None,
            alt_m=vertical.altitude_m if vertical.known else None,
            heading_deg=estimator.heading_deg() if heading else None,
            speed_mps=float(x[States.SPEED]) if moving else None,
            yaw_rate_degps=None
            if rate_radps is None
            else math.degrees(
                float(x[States.GYRO_SCALE]) * (rate_radps - float(x[States.GYRO_BIAS]))
            ),
            grade_pct=vertical.grade_pct if vertical.known else None,
            distance_m=self._distance_m,
            east_std_m=east_std_m if place else None,
            north_std_m=north_std_m if place else None,
            east_north_cov_m2=float(kalman.P[States.EAST, States.NORTH]) if place else None,
            heading_std_deg=math.degrees(kalman.std(States.HEADING)) if heading else None,
            speed_std_mps=kalman.std(States.SPEED) if moving else None,
            alt_std_m=vertical.std(VerticalStates.ALTITUDE) if vertical.known else None,
            grade_std_pct=100.0 * vertical.std(VerticalStates.SLOPE) if vertical.known else None,
        )

    def _status(self, t_ns: int) -> FusionStatus:
        kalman, verdicts = self._estimator.filter, tuple(self._verdicts)
        self._verdicts = []
        accepted_ns = self._estimator.memory.accepted_fix_ns
        barometer = self._vertical.std(VerticalStates.BARO_BIAS)
        return FusionStatus(
            t_ns=t_ns,
            gyro_bias_degps=math.degrees(float(kalman.x[States.GYRO_BIAS])),
            gyro_bias_std_degps=math.degrees(kalman.std(States.GYRO_BIAS)),
            gyro_scale=float(kalman.x[States.GYRO_SCALE]),
            gyro_scale_std=kalman.std(States.GYRO_SCALE),
            odometer_scale=float(kalman.x[States.ODOMETER_SCALE]),
            odometer_scale_std=kalman.std(States.ODOMETER_SCALE),
            gps_latency_s=float(kalman.x[States.LATENCY]),
            gps_latency_std_s=kalman.std(States.LATENCY),
            baro_bias_m=self._vertical.baro_bias_m,
            baro_bias_std_m=barometer,
            calibration=self._calibration(),
            outage_s=0.0 if accepted_ns is None else max(t_ns - accepted_ns, 0) * 1e-9,
            late=self._late,
            rejected=self._rejected,
            verdicts=verdicts,
        )

    def _calibration(self) -> Calibration:
        kalman, tuning = self._estimator.filter, self._tuning
        bias_known = kalman.std(States.GYRO_BIAS) <= math.radians(tuning.calibrated_bias_std_degps)
        scale_known = kalman.std(States.ODOMETER_SCALE) <= tuning.calibrated_scale_std
        if bias_known and scale_known:
            return "calibrated"
        return "started" if self._estimator.located else "none"


def speed_std_mps_of(fix: GpsFix, tuning: Tuning) -> float:
    """Of a fix that tells none: Doppler suffers from dilution as positions do."""
    dilution = max(fix.hdop, DILUTION_MIN) if fix.hdop is not None else 1.0
    std_mps = tuning.gps_speed_std_mps * dilution
    return std_mps if is_good(fix, tuning) else std_mps * tuning.bad_gps_factor
