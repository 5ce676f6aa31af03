"""Pure: fixes and vehicle sensors in, pose and fusion_status out."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import msgspec

from wayline.air import metres_per_pascal, pressure_altitude_m
from wayline.core import Record
from wayline.gps_quality import altitude_std_m, horizontal_std_m, is_good
from wayline.inputs import Flush, Tick
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
from wayline_fusion.architectures.architecture import Architecture, Motion, SensorErrors
from wayline_fusion.architectures.gps_only import GpsOnly, by_quality, same_for_all
from wayline_fusion.architectures.loose import Loose
from wayline_fusion.architectures.uncoupled import Uncoupled
from wayline_fusion.filter.timeline import Timeline
from wayline_fusion.filter.vertical import States as VerticalStates
from wayline_fusion.filter.vertical import VerticalFilter
from wayline_fusion.intake.clock_steps import ClockSteps
from wayline_fusion.intake.displacement import Displacement
from wayline_fusion.intake.events import ClockStep, Event, Fix, Step, WheelSpeed
from wayline_fusion.intake.plausibility import SENSORS, Plausibility, refused, within_reason
from wayline_fusion.intake.resolution import Resolution
from wayline_fusion.keeping.keeper import Keeper
from wayline_fusion.keeping.records import Saved

ARCHITECTURES: Mapping[str, Callable[[Tuning], Architecture]] = {
    "loose": Loose,
    "uncoupled": Uncoupled,
    "gps_only": lambda tuning: GpsOnly(tuning, same_for_all),
    "gps_only_modified": lambda tuning: GpsOnly(tuning, by_quality),
}
"""What `[tuning] architecture` may name."""

Taker = Callable[[Any, str], Sequence[Message | Record]]
"""Takes one kind of input."""

SECOND_NS = 1_000_000_000
OUTAGE_NS = 2_000_000_000
"""Without an accepted fix this long, the pose is dead reckoning (SPEC section 2)."""
LOST_STD_M = 100.0
KMH_MPS = 1.0 / 3.6
DILUTION_MIN = 0.6
GYRO_ROUNDING_MAX_DEGPS = 0.15
"""Of steps of half a degree a second; until enough is read, steps seem larger."""


class FusionCore:
    """One vehicle's pose, ten times a second with CAN, else once a fix.

    `saved` is what was kept of this very vehicle; records of it say what to keep.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset({GpsFix, Odometer, Gyro, Barometer})
    period_ns: ClassVar[int | None] = 100_000_000

    def __init__(self, tuning: Tuning, saved: Saved | None = None) -> None:
        self._tuning = tuning
        self._estimator = estimator = ARCHITECTURES[tuning.architecture](tuning)
        # the other architectures learn nothing
        self._keeper = Keeper(estimator, saved, tuning) if isinstance(estimator, Loose) else None
        self._beginning = self._keeper
        """Until what was kept is taken up."""
        self._timeline: Timeline[Event, Any] = Timeline(
            self._estimator.apply,
            self._estimator.snapshot,
            self._estimator.restore,
            round(tuning.late_measurement_s * 1e9),
        )
        self._plausibility = Plausibility()
        self._clock_steps = ClockSteps()
        self._refused_ns: dict[str, int] = {}
        self._vertical = VerticalFilter(tuning)
        self._displacement = Displacement()
        self._wheel_steps = Resolution(1e-4)
        self._pressure_steps = Resolution(0.1)
        self._rate_steps = Resolution(1e-4)
        self._rate_rounding_radps = 0.0
        self._pressure_altitude_m: float | None = None
        self._reverse = False
        self._can_ns: int | None = None
        self._fix_ns: int | None = None
        self._fix_delay_ns = 0
        """How much older than the newest event a fix is when it comes."""
        self._pose_ns = 0
        self._distance_m = 0.0
        self._climbed_at = (0, 0.0)
        self._late = 0
        self._rejected = 0
        self._verdicts: list[Verdict] = []
        self._takers: dict[type[msgspec.Struct], Taker] = {
            Gyro: self._gyro,
            Odometer: self._odometer,
            GpsFix: self._gps_fix,
            Barometer: self._barometer,
            Tick: self._tick,
            Flush: self._flush,
        }

    def handle(self, message: msgspec.Struct, source: str) -> Sequence[Message | Record]:
        """Take a fix, a sensor's message or a Tick; return the poses and status due."""
        taker = self._takers.get(type(message))
        return () if taker is None else taker(message, source)

    def _is_refused(self, message: Message, source: str) -> bool:
        """Whether a reading cannot be; first of all a step of the clock is noticed."""
        step_s = self._clock_steps.step_s(message)
        if step_s is not None:
            self._add(ClockStep(self._clock_steps.newest_ns, step_s))
        reason = self._plausibility.refusal(message, source)
        if reason is not None:
            self._refuse(message, reason)
            return True
        if self._beginning is not None and self._beginning.begin(message.t_ns):
            self._beginning = None
        return False

    def _refuse(self, message: Message, reason: str) -> None:
        """Count a reading that cannot be; one a second is told."""
        self._rejected += 1
        sensor, t_ns = SENSORS[type(message)], self._clock_steps.newest_ns
        if t_ns - self._refused_ns.get(sensor, 0) >= SECOND_NS:
            self._refused_ns[sensor] = t_ns
            self._verdicts.append(refused(sensor, message.t_ns, reason))

    def _gyro(self, gyro: Gyro, source: str) -> Sequence[Message]:
        if self._is_refused(gyro, source):
            return ()
        if gyro.temperature_c is not None and self._keeper is not None:
            restarted = self._keeper.take_temperature(gyro.t_ns, gyro.temperature_c)
            if restarted is not None:
                self._add(restarted)
        t_ns, rate_degps = gyro.t_ns, gyro.yaw_rate_degps
        if rate_degps is not None:
            self._can_ns = t_ns
            if not self._rate_steps.settled and self._rate_steps.learn(rate_degps):
                rounding_degps = min(self._rate_steps.std, GYRO_ROUNDING_MAX_DEGPS)
                self._rate_rounding_radps = math.radians(rounding_degps)
            self._estimator.take_gyro(t_ns, math.radians(rate_degps), self._rate_rounding_radps)
        return ()

    def _odometer(self, odometer: Odometer, source: str) -> Sequence[Message]:
        if self._is_refused(odometer, source):
            return ()
        if odometer.reverse is not None:
            self._reverse = odometer.reverse
        if odometer.speed_mps is None:
            return ()
        self._can_ns = odometer.t_ns
        self._wheel_steps.learn(odometer.speed_mps)
        rounding_mps = min(self._wheel_steps.std, KMH_MPS)
        std_mps = math.hypot(rounding_mps, self._tuning.odometer_std_mps)
        signed_mps = -odometer.speed_mps if self._reverse else odometer.speed_mps
        self._add(WheelSpeed(odometer.t_ns, signed_mps, std_mps))
        return ()

    def _gps_fix(self, fix: GpsFix, source: str) -> Sequence[Message]:
        if self._is_refused(fix, source):
            return ()
        fix = within_reason(fix)
        if not fix.valid or fix.lat_deg is None or fix.lon_deg is None:
            return ()
        self._fix_ns = fix.t_ns
        self._fix_delay_ns = max(self._estimator.progress.t_ns - fix.t_ns, 0)
        self._add(self._fix_event(fix, fix.lat_deg, fix.lon_deg))
        if fix.alt_m is not None and "gps" in self._tuning.vertical_sensors:
            self._climb()
            self._vertical.gps(fix.alt_m, altitude_std_m(fix, self._tuning))
        # after a late fix the state is not that of its instant but of the last event
        now_ns = self._estimator.progress.t_ns
        if self._has_can(fix.t_ns) or now_ns <= self._pose_ns:
            return [self._status(fix.t_ns)]
        self._pose_ns = now_ns
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
            is_good=is_good(fix, self._tuning),
            speed_derived=fix.speed_derived or fix.speed_mps is None,
        )

    def _barometer(self, barometer: Barometer, source: str) -> Sequence[Message]:
        if self._is_refused(barometer, source):
            return ()
        pressure_pa = barometer.pressure_pa
        if pressure_pa is None or "barometer" not in self._tuning.vertical_sensors:
            return ()
        self._pressure_steps.learn(pressure_pa)
        rounding_m = self._pressure_steps.std * metres_per_pascal(pressure_pa)
        if rounding_m <= self._tuning.baro_resolution_std_max_m and self._vertical.known:
            self._climb()
            std_m = math.hypot(rounding_m, self._tuning.baro_std_m)
            self._vertical.barometer(pressure_altitude_m(pressure_pa), std_m)
        return ()

    def _tick(self, tick: Tick, _: str) -> Sequence[Message | Record]:
        t_ns = tick.t_ns
        self._add(Step(t_ns))
        messages: list[Message | Record] = []
        on_second = t_ns % SECOND_NS == 0
        without_fix = self._fix_ns is None or t_ns - self._fix_ns > SECOND_NS
        if t_ns > self._pose_ns and (self._has_can(t_ns) or (on_second and without_fix)):
            self._climb()
            self._pose_ns = t_ns
            messages.append(self._pose())
        if on_second:
            messages.append(self._status(t_ns))
        if self._keeper is not None:
            messages += self._keeper.due(t_ns, self._heard_ns())
        return messages

    def _flush(self, _: Flush, __: str) -> Sequence[Record]:
        return [] if self._keeper is None else self._keeper.last(self._heard_ns())

    def _heard_ns(self) -> int | None:
        """When a sensor said something for the last time."""
        return max(self._can_ns or 0, self._fix_ns or 0) or None

    def _add(self, event: Event) -> None:
        """Apply an event; told are its own verdicts, not those of events that it set back."""
        if not self._timeline.add(event):
            self._late += 1
        for verdict in self._estimator.take_verdicts():
            if verdict.t_ns == event.t_ns:
                self._rejected += not verdict.accepted
                self._verdicts.append(verdict)

    def _has_can(self, t_ns: int) -> bool:
        heard = self._can_ns is not None and t_ns - self._can_ns <= SECOND_NS
        return heard and self._estimator.uses_vehicle

    def _climb(self) -> None:
        """Bring the vertical filter forward to where the vehicle is now."""
        now = self._estimator.progress
        t_ns, distance_m = self._climbed_at
        self._climbed_at = (now.t_ns, now.distance_m)
        if t_ns and now.t_ns > t_ns:
            driven_m = max(now.distance_m - distance_m, 0.0)
            self._vertical.advance(
                -driven_m if now.backwards else driven_m, (now.t_ns - t_ns) * 1e-9
            )

    def _mode(self, motion: Motion) -> PoseMode:
        if not _is_located(motion) or motion.accepted_fix_ns is None:
            return "starting"
        if max(motion.east_std_m, motion.north_std_m) > LOST_STD_M:
            return "lost"
        # a fix that is on its way is not missing
        due_ns = motion.t_ns - self._fix_delay_ns
        if motion.is_unconfirmed or due_ns - motion.accepted_fix_ns > OUTAGE_NS:
            return "dead_reckoning"
        return "fused" if self._has_can(motion.t_ns) else "gps"

    def _pose(self) -> Pose:
        motion, vertical = self._estimator.motion(), self._vertical
        self._distance_m = max(self._distance_m, self._estimator.progress.distance_m)
        place, is_directed = motion.place_deg, motion.heading_deg is not None
        return Pose(
            t_ns=self._pose_ns,
            mode=self._mode(motion),
            lat_deg=place[0] if place else None,
            lon_deg=place[1] if place else None,
            alt_m=vertical.altitude_m if vertical.known else None,
            heading_deg=motion.heading_deg,
            speed_mps=motion.speed_mps,
            yaw_rate_degps=motion.yaw_rate_degps,
            grade_pct=vertical.grade_pct if vertical.known else None,
            distance_m=self._distance_m,
            east_std_m=motion.east_std_m if place else None,
            north_std_m=motion.north_std_m if place else None,
            east_north_cov_m2=motion.east_north_cov_m2 if place else None,
            heading_std_deg=motion.heading_std_deg if is_directed else None,
            speed_std_mps=None if motion.speed_mps is None else motion.speed_std_mps,
            alt_std_m=vertical.std(VerticalStates.ALTITUDE) if vertical.known else None,
            grade_std_pct=100.0 * vertical.std(VerticalStates.SLOPE) if vertical.known else None,
        )

    def _status(self, t_ns: int) -> FusionStatus:
        errors, motion = self._estimator.sensor_errors(), self._estimator.motion()
        verdicts, self._verdicts = tuple(self._verdicts), []
        accepted_ns = motion.accepted_fix_ns
        return FusionStatus(
            t_ns=t_ns,
            **msgspec.structs.asdict(errors),
            baro_bias_m=self._vertical.baro_bias_m,
            baro_bias_std_m=self._vertical.std(VerticalStates.BARO_BIAS),
            calibration=self._calibration(errors, motion),
            outage_s=0.0 if accepted_ns is None else max(t_ns - accepted_ns, 0) * 1e-9,
            late=self._late,
            rejected=self._rejected,
            verdicts=verdicts,
        )

    def _calibration(self, errors: SensorErrors, motion: Motion) -> Calibration:
        bias_std_degps, scale_std = errors.gyro_bias_std_degps, errors.odometer_scale_std
        if (
            bias_std_degps is not None
            and scale_std is not None
            and bias_std_degps <= self._tuning.calibrated_bias_std_degps
            and scale_std <= self._tuning.calibrated_scale_std
        ):
            return "calibrated"
        return "started" if _is_located(motion) else "none"


def _is_located(motion: Motion) -> bool:
    """Whether position and heading are known."""
    return motion.place_deg is not None and motion.heading_deg is not None


def speed_std_mps_of(fix: GpsFix, tuning: Tuning) -> float:
    """Of a fix that tells none: Doppler suffers from dilution as positions do."""
    dilution = max(fix.hdop, DILUTION_MIN) if fix.hdop is not None else 1.0
    std_mps = tuning.gps_speed_std_mps * dilution
    return std_mps if is_good(fix, tuning) else std_mps * tuning.bad_gps_factor
