"""Pure: the horizontal estimator: events in, state forward, verdicts out; can be set back."""

import math

import msgspec

from wayline.geo import LocalPlane
from wayline.grid import LONGEST_GAP_NS
from wayline.tuning import Tuning
from wayline_fusion.aids.kept_pose import contradiction, tells_course
from wayline_fusion.aids.positions import place, take_position
from wayline_fusion.aids.velocities import take_course, take_speed
from wayline_fusion.aids.wheels import stand_still, take_wheel_speed
from wayline_fusion.evidence.memory import Memory
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.states import Floats, States
from wayline_fusion.intake.events import ClockStep, Event, Fix, GyroRestarted, Step, WheelSpeed

LONGEST_STEP_NS = 500_000_000
PLANE_RADIUS_M = 1_000.0
"""The local plane moves along when the vehicle is this far from its origin."""
SOUND_EVERY_NS = 1_000_000_000


class Snapshot(msgspec.Struct, frozen=True, gc=False):
    """Everything that a rewind sets back."""

    t_ns: int
    distance_m: float
    x: Floats
    P: Floats
    memory: Memory


class Estimator(Estimate):
    """Takes events in the order of their time; can be set back to an earlier state."""

    def __init__(self, tuning: Tuning) -> None:
        super().__init__(tuning)
        self._sound = self.snapshot()

    def snapshot(self) -> Snapshot:
        """Copy of the state, for a rewind."""
        kalman = self.filter
        return Snapshot(self.t_ns, self.distance_m, kalman.x, kalman.P, self.memory)

    def restore(self, snapshot: Snapshot) -> None:
        """Set everything back to a snapshot."""
        self.t_ns, self.distance_m = snapshot.t_ns, snapshot.distance_m
        self.filter.x, self.filter.P = snapshot.x.copy(), snapshot.P.copy()
        self.memory = snapshot.memory

    def apply(self, event: Event) -> None:
        """Bring the state forward to an event and take it in."""
        self._advance_to(event.t_ns)
        if isinstance(event, Step):
            if self.standing:
                stand_still(self, event)
            self._keep_sound(event.t_ns)
        elif isinstance(event, WheelSpeed):
            take_wheel_speed(self, event)
        elif isinstance(event, Fix):
            self._fix(event)
        elif isinstance(event, GyroRestarted):
            drift = math.radians(self.tuning.gyro_bias_drift_degps_per_c)
            bias_std = math.hypot(self.filter.std(States.GYRO_BIAS), drift * event.warmer_c)
            self.filter.doubt(States.GYRO_BIAS, bias_std)
        elif isinstance(event, ClockStep):
            self.filter.stray(self.filter.speed_mps * event.step_s)

    def _advance_to(self, t_ns: int) -> None:
        began_ns = self.t_ns
        elapsed_ns = t_ns - began_ns
        if began_ns == 0:
            self.t_ns = t_ns
            return
        if elapsed_ns <= 0:
            return
        if elapsed_ns > LONGEST_GAP_NS:
            self._start_over(t_ns)
            return
        kalman, noise, standing = self.filter, self.driving_noise(), self.standing
        steps = -(-elapsed_ns // LONGEST_STEP_NS)
        from_ns = began_ns
        for step in range(1, steps + 1):
            to_ns = began_ns + elapsed_ns * step // steps
            dt_s = (to_ns - from_ns) * 1e-9
            turn_rad = self.gyro.turned_rad(from_ns, to_ns)
            speed_mps = kalman.speed_mps
            kalman.advance(dt_s, turn_rad, noise, standing=standing)
            self.distance_m += 0.5 * abs(speed_mps + kalman.speed_mps) * dt_s
            from_ns = to_ns
        self.t_ns = t_ns
        self._move_plane()

    def _start_over(self, t_ns: int) -> None:
        """After a silence that no prediction can bridge only the calibration is still good."""
        self.filter.forget_motion()
        self.t_ns = t_ns
        self.memory = Memory(
            position_noise=self.memory.position_noise,
            velocity_noise=self.memory.velocity_noise,
            wander=self.memory.wander,
        )

    def _move_plane(self) -> None:
        """Put the origin under the vehicle; north turns by the convergence of the meridians."""
        plane, x = self.memory.plane, self.filter.x
        east_m, north_m = float(x[States.EAST]), float(x[States.NORTH])
        if plane is None or math.hypot(east_m, north_m) < PLANE_RADIUS_M:
            return
        lat_deg, lon_deg = plane.to_geodetic(east_m, north_m)
        convergence_deg = (lon_deg - plane.lon_deg) * math.sin(math.radians(lat_deg))
        moved = x.copy()
        moved[States.EAST] = moved[States.NORTH] = 0.0
        moved[States.HEADING] += math.radians(convergence_deg)
        self.filter.x = moved
        self.remember(plane=LocalPlane(lat_deg, lon_deg))

    def _question_kept(self, fix: Fix) -> None:
        """After a restart: what was kept of the pose is forgotten where the first fixes differ."""
        verdict = contradiction(self.filter, self.memory, fix, self.tuning)
        if verdict is not None:
            self.verdicts.append(verdict)
            self._start_over(fix.t_ns)
            return
        is_unconfirmed = self.memory.heading_unconfirmed and not tells_course(fix, self.tuning)
        self.remember(position_unconfirmed=False, heading_unconfirmed=is_unconfirmed)

    def _fix(self, fix: Fix) -> None:
        """Speed and course first: walls that displace a position by metres leave Doppler alone."""
        if self.memory.position_unconfirmed or self.memory.heading_unconfirmed:
            self._question_kept(fix)
        if fix.speed_mps is not None:
            if not self.wheels_fresh and self.filter.x[States.WHEEL_SPEED] < 0.0:
                self.filter.go_forward()
            take_speed(self, fix, fix.speed_mps)
            take_course(self, fix, fix.speed_mps)
        plane = self.memory.plane
        if plane is None:
            self.remember(plane=LocalPlane(fix.lat_deg, fix.lon_deg))
            place(self, fix, 0.0, 0.0)
        else:
            take_position(self, fix, *plane.to_plane(fix.lat_deg, fix.lon_deg))

    def _keep_sound(self, t_ns: int) -> None:
        """Notice lost numbers; a good state is kept now and then."""
        kalman = self.filter
        # one number that is none makes the whole product none
        if not math.isfinite(kalman.x.dot(kalman.P).dot(kalman.x)):
            self._recover(t_ns)
        elif t_ns - self._sound.t_ns >= SOUND_EVERY_NS:
            self._sound = self.snapshot()

    def _recover(self, t_ns: int) -> None:
        """Start anew with the last calibration that had numbers, and say so."""
        self.filter.x, self.filter.P = self._sound.x.copy(), self._sound.P.copy()
        self.filter.forget_motion()
        self.memory = Memory()
        self.t_ns, self.distance_m = t_ns, self._sound.distance_m
        self.tell("filter", t_ns, "lost its numbers; restarted with the last good calibration")
