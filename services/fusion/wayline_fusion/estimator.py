"""Pure: the horizontal estimator: events in, state forward, verdicts out; can be set back."""

import math
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.geo import LocalPlane, wrap_360
from wayline.grid import LONGEST_GAP_NS
from wayline.messages import Verdict
from wayline.tuning import Tuning
from wayline_fusion import measurements
from wayline_fusion.bias_wander import Walk
from wayline_fusion.events import ClockStep, Event, Fix, GyroRestarted, Step, WheelSpeed
from wayline_fusion.gate import alarmed, judge, nis_of, threshold
from wayline_fusion.gyro_track import GyroTrack
from wayline_fusion.horizontal import DrivingNoise, HorizontalFilter
from wayline_fusion.lockout import patience_s, rejected
from wayline_fusion.measurements import Measurement
from wayline_fusion.memory import Memory
from wayline_fusion.moved import contradiction, tells_course
from wayline_fusion.states import Floats, States

LONGEST_STEP_S = 0.5
PLANE_RADIUS_M = 1_000.0
"""The local plane moves along when the vehicle is this far from its origin."""
WHEELS_FRESH_NS = 2_000_000_000
"""A wheel speed this old no longer says that the vehicle moves or stands."""
STILL_NS = 100_000_000
"""At rest the gyro is averaged over a step."""
ROUNDING_CORRELATION_S = 0.1
"""While driving, the rate goes through a coarse gyro's steps this fast..."""
REST_CORRELATION_S = 10.0
"""...and at rest it stays in one."""
SPEED_UNKNOWN_MPS = 40.0
POSITION_FACTOR_MIN = 1.0
"""Reflections in ordinary streets move fixes by metres at once, then not at all for a while."""
SLOW_FACTOR_POWER = 0.4
"""Of the white variance's factor, on the slow std: nearly as many decibels."""
SAME_ERROR_RATIO = 0.7
"""Of two claimed stds; a satellite more or less changes them by less."""
VELOCITY_FACTOR_MIN = 0.3
SCALE_UNKNOWN = 0.2
BIAS_DOUBT_FACTOR = 3.0
"""A course that had to be set says that the bias is known less well than it seemed; once more, and
again so."""
RELOCK_DOUBT_SHARE = 0.5
"""Positions that have won against dead reckoning may still be the reflections."""
SOUND_EVERY_NS = 1_000_000_000


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
        self.gyro_rounding_radps = 0.0
        """Std of the gyro's steps."""
        self.memory = Memory()
        self._tuning = tuning
        self._verdicts: list[Verdict] = []
        self._sound = self.snapshot()

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
        elif isinstance(event, GyroRestarted):
            drift = math.radians(self._tuning.gyro_bias_drift_degps_per_c)
            bias_std = math.hypot(self.filter.std(States.GYRO_BIAS), drift * event.warmer_c)
            self.filter.doubt(States.GYRO_BIAS, bias_std)
        elif isinstance(event, ClockStep):
            self.filter.stray(float(self.filter.x[States.SPEED]) * event.step_s)
        elif self.standing:
            self._stand_still(event)
        if isinstance(event, Step):
            self._keep_sound(event.t_ns)

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
        noise = self._driving_noise()
        distance_m = memory.distance_m
        for step in range(steps):
            from_ns = memory.t_ns + (t_ns - memory.t_ns) * step // steps
            to_ns = memory.t_ns + (t_ns - memory.t_ns) * (step + 1) // steps
            dt_s = (to_ns - from_ns) * 1e-9
            turn_rad = self.gyro.turned_rad(from_ns, to_ns)
            self.filter.advance(dt_s, turn_rad, noise, standing=self.standing)
            distance_m += abs(float(self.filter.x[States.SPEED])) * dt_s
        self._remember(t_ns=t_ns, distance_m=distance_m)
        self._move_plane()

    def _start_over(self, t_ns: int) -> None:
        """After a silence that no prediction can bridge only the calibration is still good."""
        self.filter.forget_motion()
        distance_m = self.memory.distance_m
        self.memory = msgspec.structs.replace(
            Memory(t_ns=t_ns, distance_m=distance_m),
            position_noise=self.memory.position_noise,
            velocity_noise=self.memory.velocity_noise,
            wander=self.memory.wander,
        )

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

    def _driving_noise(self) -> DrivingNoise:
        return DrivingNoise(
            math.hypot(
                math.radians(self._tuning.gyro_noise_deg_per_sqrt_s),
                self.gyro_rounding_radps * math.sqrt(ROUNDING_CORRELATION_S),
            ),
            math.radians(self._tuning.gyro_bias_walk_degps_per_sqrt_s)
            * self.memory.wander.multiple,
        )

    def _wheel_speed(self, event: WheelSpeed) -> None:
        """Correct with a wheel speed, unless no vehicle changes its speed like that."""
        if self.standing and event.speed_mps != 0.0:
            self._pull_away(event.t_ns)
        self._remember(wheels_ns=event.t_ns)
        if self.standing and event.speed_mps == 0.0:
            return
        measurement = measurements.odometer(self.filter.x, event.speed_mps, event.std_mps)
        since_ns = self.memory.wheels_rejected_since_ns
        if _has_lasted(since_ns, event.t_ns, self._tuning.wheels_relock_after_s):
            self._strayed(float(measurement.y[0]), since_ns, event.t_ns)
            self.filter.doubt(States.SPEED, SPEED_UNKNOWN_MPS)
            self._remember(still_since_ns=None)
        nis = nis_of(measurement, self.filter.expected(measurement))
        verdict = judge("odometer", event.t_ns, nis, 1, self._tuning.gate_probability)
        if not verdict.accepted:
            self._verdicts.append(verdict)
            self._remember(wheels_rejected_since_ns=since_ns or event.t_ns, still_since_ns=None)
            return
        still_since_ns = self.memory.still_since_ns or event.t_ns
        self._remember(
            wheels_rejected_since_ns=None,
            still_since_ns=still_since_ns if event.speed_mps == 0.0 else None,
        )
        self.filter.correct(measurement)

    def _pull_away(self, t_ns: int) -> None:
        """Since the last wheel speed it was held still, yet may have driven off."""
        held_s = (t_ns - (self.memory.wheels_ns or t_ns)) * 1e-9
        gained_mps = self._tuning.acceleration_noise_mps_per_sqrt_s * math.sqrt(held_s)
        self.filter.doubt(States.SPEED, gained_mps)

    def _stand_still(self, event: Step) -> None:
        """Zero velocity, and the gyro reads its bias."""
        tuning = self._tuning
        self.filter.correct(measurements.still(self.filter.x, tuning.standstill_std_mps))
        turned_rad = self.gyro.turned_rad(event.t_ns - STILL_NS, event.t_ns)
        if turned_rad is None:
            return
        still_s = STILL_NS * 1e-9
        # at rest a coarse gyro reads the same step all the time
        rounding_radps = self.gyro_rounding_radps * math.sqrt(REST_CORRELATION_S / still_s)
        std_radps = math.hypot(math.radians(tuning.standstill_gyro_std_degps), rounding_radps)
        rate_radps = turned_rad / still_s
        measurement = measurements.still_rate(self.filter.x, rate_radps, std_radps)
        since_ns = self.memory.still_rate_rejected_since_ns
        if _has_lasted(since_ns, event.t_ns, tuning.bias_relock_after_s):
            # another gyro, or one that was switched off and on
            self.filter.doubt(States.GYRO_BIAS, math.radians(tuning.gyro_bias_initial_std_degps))
            self._tell("standstill_gyro", event.t_ns, "another bias for long; learned anew")
        is_accepted = self._gated(measurement, event.t_ns, is_silent=True)
        self._remember(still_rate_rejected_since_ns=_since(is_accepted, since_ns, event.t_ns))

    def _question_kept(self, fix: Fix) -> None:
        """After a restart: what was kept of the pose is forgotten where the first fixes differ."""
        verdict = contradiction(self.filter, self.memory, fix, self._tuning)
        if verdict is not None:
            self._verdicts.append(verdict)
            self._start_over(fix.t_ns)
            return
        is_unconfirmed = self.memory.heading_unconfirmed and not tells_course(fix, self._tuning)
        self._remember(position_unconfirmed=False, heading_unconfirmed=is_unconfirmed)

    def _fix(self, fix: Fix) -> None:
        """Speed and course first: walls that displace a position by metres leave Doppler alone."""
        if self.memory.position_unconfirmed or self.memory.heading_unconfirmed:
            self._question_kept(fix)
        if fix.speed_mps is not None:
            if not self.wheels_fresh and self.filter.x[States.SPEED] < 0.0:
                self.filter.go_forward()
            self._gps_speed(fix, fix.speed_mps)
            self._course(fix, fix.speed_mps)
        plane = self.memory.plane
        if plane is None:
            self._remember(plane=LocalPlane(fix.lat_deg, fix.lon_deg))
            self._place(fix, 0.0, 0.0)
        else:
            self._position(fix, *plane.to_plane(fix.lat_deg, fix.lon_deg))

    def _strayed(self, off_mps: float, since_ns: int | None, t_ns: int) -> None:
        """A sensor that is believed again says how fast dead reckoning has gone wrong meanwhile."""
        self.filter.stray(off_mps * (t_ns - (since_ns or t_ns)) * 1e-9)

    def _place(self, fix: Fix, east_m: float, north_m: float, doubt_m: float = 0.0) -> None:
        self.filter.place(east_m, north_m, fix.position_std_m, doubt_m)
        self._remember(placed_ns=fix.t_ns, accepted_fix_ns=fix.t_ns, lockout=None)

    def _position(self, fix: Fix, east_m: float, north_m: float) -> None:
        """Correct with a position; where dead reckoning is not possible yet, start from it."""
        memory = self.memory
        if not memory.heading_known:
            self._place(fix, east_m, north_m)
            return
        slow_std_m = self.filter.slow_std_m(fix.position_std_m)
        claimed_m2 = fix.position_std_m**2 - slow_std_m**2
        # where white noise is more than claimed, what is slow is too
        slow_std_m *= memory.position_noise.factor**SLOW_FACTOR_POWER
        self._renew_fixes_error(slow_std_m)
        white_std_m = math.sqrt(memory.position_noise.factor * claimed_m2)
        measurement = measurements.position(self.filter.x, east_m, north_m, slow_std_m, white_std_m)
        expected = self.filter.expected(measurement)
        nis = nis_of(measurement, expected)
        unaided_s = (fix.t_ns - (memory.accepted_fix_ns or fix.t_ns)) * 1e-9
        verdict = self._position_verdict(fix.t_ns, nis, unaided_s)
        self._verdicts.append(alarmed(verdict, measurement, expected))
        if not verdict.accepted:
            self._locked_out(fix, (east_m, north_m), measurement, nis, unaided_s)
            return
        self.filter.correct(measurement)
        square = 0.5 * float(measurement.y @ measurement.y)
        noise = memory.position_noise.learned(
            square, 0.5 * float(np.trace(expected)), claimed_m2, POSITION_FACTOR_MIN
        )
        self._remember(accepted_fix_ns=fix.t_ns, lockout=None, position_noise=noise)

    def _renew_fixes_error(self, slow_std_m: float) -> None:
        """Other satellites, or a receiver that has settled, make another error."""
        known_m = self.memory.slow_std_m or slow_std_m
        kept = min(slow_std_m, known_m) / max(slow_std_m, known_m)
        if kept < SAME_ERROR_RATIO:
            self.filter.renew_fixes_error(kept)
        if kept < SAME_ERROR_RATIO or self.memory.slow_std_m is None:
            self._remember(slow_std_m=slow_std_m)

    def _position_verdict(self, t_ns: int, nis: float, unaided_s: float) -> Verdict:
        """After a long outage a position that is none too likely waits until others confirm it."""
        tuning, lockout = self._tuning, self.memory.lockout
        doubt_s = unaided_s if lockout is None else lockout.unaided_s
        if doubt_s > tuning.relock_outage_s:
            return judge("gps_position", t_ns, nis, 2, tuning.reacquire_probability)
        return judge("gps_position", t_ns, nis, 2, tuning.gate_probability)

    def _locked_out(
        self,
        fix: Fix,
        place_m: tuple[float, float],
        measurement: Measurement,
        nis: float,
        unaided_s: float,
    ) -> None:
        """Remember a rejected position; believe it when others have agreed for long enough."""
        memory, tuning = self.memory, self._tuning
        off_m = (float(measurement.y[0]), float(measurement.y[1]))
        lockout = rejected(memory.lockout, fix.t_ns, off_m, fix.position_std_m, unaided_s)
        is_likely = nis <= threshold(2, tuning.gate_probability)
        supported_s = ((memory.accepted_fix_ns or 0) - (memory.placed_ns or 0)) * 1e-9
        if lockout.agreed_s < patience_s(lockout, supported_s, tuning, is_likely=is_likely):
            self._remember(lockout=lockout)
        elif is_likely:
            self.filter.correct(measurement)
            self._remember(accepted_fix_ns=fix.t_ns, lockout=None)
        else:
            self._place(fix, *place_m, doubt_m=RELOCK_DOUBT_SHARE * lockout.off_m)

    def _gps_speed(self, fix: Fix, speed_mps: float) -> None:
        memory, tuning = self.memory, self._tuning
        std_mps = fix.speed_std_mps * math.sqrt(memory.velocity_noise.factor)
        measurement = measurements.gps_speed(self.filter.x, speed_mps, std_mps)
        expected = self.filter.expected(measurement)
        since_ns = memory.speed_rejected_since_ns
        if self.wheels_fresh and _has_lasted(since_ns, fix.t_ns, tuning.speed_relock_after_s):
            self._strayed(float(measurement.y[0]), since_ns, fix.t_ns)
            # other tyres, or a speed in another unit
            self.filter.doubt(States.ODOMETER_SCALE, SCALE_UNKNOWN)
            self.filter.doubt(States.SPEED, SPEED_UNKNOWN_MPS)
            self._tell("odometer", fix.t_ns, "another scale for long; learned anew")
        elif since_ns is not None and not self.wheels_fresh:
            # two in a row, and nothing else tells the speed: the vehicle braked hard
            self.filter.doubt(States.SPEED, SPEED_UNKNOWN_MPS)
        is_accepted = self._gated(measurement, fix.t_ns)
        noise = memory.velocity_noise
        if self.wheels_fresh and speed_mps >= tuning.course_speed_min_mps:
            square = float(measurement.y[0]) ** 2
            noise = noise.learned(
                square, float(expected[0, 0]), fix.speed_std_mps**2, VELOCITY_FACTOR_MIN
            )
        self._remember(
            velocity_noise=noise,
            speed_rejected_since_ns=_since(is_accepted, since_ns, fix.t_ns),
        )

    def _course(self, fix: Fix, speed_mps: float) -> None:
        tuning = self._tuning
        if fix.course_rad is None or speed_mps < tuning.course_speed_min_mps:
            return
        rate_radps = self.gyro.rate_radps(fix.t_ns)
        rate_radps = (
            0.0 if rate_radps is None else rate_radps - float(self.filter.x[States.GYRO_BIAS])
        )
        std_rad = self._course_std_rad(fix, speed_mps, rate_radps)
        backwards_rad = math.pi if self.filter.x[States.SPEED] < 0.0 else 0.0
        since_ns = self.memory.course_rejected_since_ns
        is_locked = _has_lasted(since_ns, fix.t_ns, tuning.course_relock_after_s)
        if not self.memory.heading_known or is_locked:
            start_rad = max(std_rad, math.radians(tuning.heading_start_std_deg))
            off_rad = fix.course_rad + backwards_rad - float(self.filter.x[States.HEADING])
            self.filter.turn_to(fix.course_rad + backwards_rad, start_rad)
            self._remember(heading_known=True, course_rejected_since_ns=None)
            if is_locked:
                self._strayed(2.0 * speed_mps * math.sin(0.5 * off_rad), since_ns, fix.t_ns)
                bias_std = BIAS_DOUBT_FACTOR * self.filter.std(States.GYRO_BIAS)
                most = math.radians(tuning.gyro_bias_initial_std_degps)
                self.filter.doubt(States.GYRO_BIAS, min(bias_std, most))
                self._tell("gps_course", fix.t_ns, "another heading for long; set to the course")
            return
        measurement = measurements.course(self.filter.x, fix.course_rad, std_rad, rate_radps)
        self._learn_doppler(fix, speed_mps, measurement)
        is_accepted = self._gated(measurement, fix.t_ns)
        self._remember(course_rejected_since_ns=_since(is_accepted, since_ns, fix.t_ns))
        if is_accepted:
            self._learn_wander(fix.t_ns, fix.course_rad + backwards_rad, std_rad)

    def _learn_wander(self, t_ns: int, course_rad: float, std_rad: float) -> None:
        """Of the gyro's bias, from the heading that a fix tells."""
        memory, tuning, kalman = self.memory, self._tuning, self.filter
        turn_rad = self.gyro.angle_rad(t_ns)
        if turn_rad is None:
            self._remember(wander=memory.wander.forgotten())
            return
        walk = Walk(
            math.radians(tuning.gyro_bias_walk_degps_per_sqrt_s),
            self._driving_noise().turn_rad_per_sqrt_s,
            float(kalman.x[States.GYRO_BIAS]),
            float(kalman.x[States.GYRO_SCALE]),
            kalman.std(States.GYRO_SCALE),
        )
        self._remember(wander=memory.wander.noticed(t_ns, course_rad, std_rad, turn_rad, walk))

    def _learn_doppler(self, fix: Fix, speed_mps: float, measurement: Measurement) -> None:
        """Across the direction of travel Doppler is as noisy as along it."""
        if fix.course_std_rad is not None or not self.gyro.covers(fix.t_ns):
            return
        claimed = (fix.speed_std_mps / speed_mps) ** 2
        noise = self.memory.velocity_noise
        other = float(measurement.R[0, 0]) - noise.factor * claimed
        self._remember(
            velocity_noise=noise.learned(
                float(measurement.y[0]) ** 2,
                float(self.filter.expected(measurement)[0, 0]) + other,
                claimed,
                VELOCITY_FACTOR_MIN,
            )
        )

    def _course_std_rad(self, fix: Fix, speed_mps: float, rate_radps: float) -> float:
        """Doppler across the direction of travel, mounting, and what turning adds."""
        tuning = self._tuning
        noise = math.sqrt(self.memory.velocity_noise.factor)
        doppler_rad = fix.course_std_rad or fix.speed_std_mps * noise / speed_mps
        turning_rad = rate_radps * (tuning.antenna_lever_m / speed_mps + tuning.gps_time_std_s)
        return math.hypot(doppler_rad, math.radians(tuning.gps_course_std_deg), turning_rad)

    def _gated(self, measurement: Measurement, t_ns: int, *, is_silent: bool = False) -> bool:
        """Correct with a likely measurement; `is_silent` says so only of an unlikely one."""
        expected = self.filter.expected(measurement)
        nis = nis_of(measurement, expected)
        verdict = judge(
            measurement.sensor, t_ns, nis, len(measurement.y), self._tuning.gate_probability
        )
        if not (is_silent and verdict.accepted):
            self._verdicts.append(alarmed(verdict, measurement, expected))
        if verdict.accepted:
            self.filter.correct(measurement)
        return verdict.accepted

    def _keep_sound(self, t_ns: int) -> None:
        """Notice lost numbers; a good state is kept now and then."""
        kalman = self.filter
        # a NaN goes through a product as through a sum, which takes numpy three times as long
        if not math.isfinite(np.vdot(kalman.x, kalman.x) + np.vdot(kalman.P, kalman.P)):
            self._recover(t_ns)
        elif t_ns - self._sound.memory.t_ns >= SOUND_EVERY_NS:
            self._sound = self.snapshot()

    def _recover(self, t_ns: int) -> None:
        """Start anew with the last calibration that had numbers, and say so."""
        self.filter.x, self.filter.P = self._sound.x.copy(), self._sound.P.copy()
        self.filter.forget_motion()
        self.memory = Memory(t_ns=t_ns, distance_m=self._sound.memory.distance_m)
        self._tell("filter", t_ns, "lost its numbers; restarted with the last good calibration")

    def _tell(self, sensor: str, t_ns: int, reason: str) -> None:
        """Say that something known was given up."""
        self._verdicts.append(
            Verdict(sensor=sensor, t_ns=t_ns, accepted=False, nis=0.0, threshold=0.0, reason=reason)
        )

    def heading_deg(self) -> float:
        """Heading, true, clockwise from north."""
        return wrap_360(math.degrees(float(self.filter.x[States.HEADING])))


def _since(is_accepted: bool, since_ns: int | None, t_ns: int) -> int | None:
    """Since when measurements are rejected without a break, after one more."""
    return None if is_accepted else since_ns or t_ns


def _has_lasted(since_ns: int | None, t_ns: int, after_s: float) -> bool:
    return since_ns is not None and t_ns - since_ns >= after_s * 1e9
