"""Pure: the horizontal estimator: events in, state forward, verdicts out; can be set back."""

import math
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.geo import LocalPlane
from wayline.grid import LONGEST_GAP_NS
from wayline.tuning import Tuning
from wayline_fusion.estimate import Estimate
from wayline_fusion.events import ClockStep, Event, Fix, GyroRestarted, Step, WheelSpeed
from wayline_fusion.memory import Memory
from wayline_fusion.moved import contradiction, tells_course
from wayline_fusion.positions import place, take_position
from wayline_fusion.states import Floats, States
from wayline_fusion.velocities import take_course, take_speed
from wayline_fusion.wheels import stand_still, take_wheel_speed

LONGEST_STEP_S = 0.5
PLANE_RADIUS_M = 1_000.0
"""The local plane moves along when the vehicle is this far from its origin."""
SOUND_EVERY_NS = 1_000_000_000


class Snapshot(NamedTuple):
    """Everything that a rewind sets back."""

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
        return Snapshot(self.filter.x, self.filter.P, self.memory)

    def restore(self, snapshot: Snapshot) -> None:
        """Set everything back to a snapshot."""
        self.filter.x, self.filter.P = snapshot.x.copy(), snapshot.P.copy()
        self.memory = snapshot.memory

    def apply(self, event: Event) -> None:
        """Bring the state forward to an event and take it in."""
        self._advance_to(event.t_ns)
        if isinstance(event, Fix):
            self._fix(event)
        elif isinstance(event, WheelSpeed):
            take_wheel_speed(self, event)
        elif isinstance(event, GyroRestarted):
            drift = math.radians(self.tuning.gyro_bias_drift_degps_per_c)
            bias_std = math.hypot(self.filter.std(States.GYRO_BIAS), drift * event.warmer_c)
            self.filter.doubt(States.GYRO_BIAS, bias_std)
        elif isinstance(event, ClockStep):
            self.filter.stray(self.filter.speed_mps * event.step_s)
        elif self.standing:
            stand_still(self, event)
        if isinstance(event, Step):
            self._keep_sound(event.t_ns)

    def _advance_to(self, t_ns: int) -> None:
        memory = self.memory
        if memory.t_ns == 0:
            self.remember(t_ns=t_ns)
            return
        total_s = (t_ns - memory.t_ns) * 1e-9
        if total_s <= 0.0:
            return
        if total_s > LONGEST_GAP_NS * 1e-9:
            self._start_over(t_ns)
            return
        steps = math.ceil(total_s / LONGEST_STEP_S - 1e-9)
        noise = self.driving_noise()
        distance_m = memory.distance_m
        for step in range(steps):
            from_ns = memory.t_ns + (t_ns - memory.t_ns) * step // steps
            to_ns = memory.t_ns + (t_ns - memory.t_ns) * (step + 1) // steps
            dt_s = (to_ns - from_ns) * 1e-9
            turn_rad = self.gyro.turned_rad(from_ns, to_ns)
            speed_mps = self.filter.speed_mps
            self.filter.advance(dt_s, turn_rad, noise, standing=self.standing)
            distance_m += 0.5 * abs(speed_mps + self.filter.speed_mps) * dt_s
        self.remember(t_ns=t_ns, distance_m=distance_m)
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
        self.tell("filter", t_ns, "lost its numbers; restarted with the last good calibration")
