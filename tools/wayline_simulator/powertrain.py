"""Pure: an engine and its gearbox from one instant to the next."""

from enum import Enum

from wayline_simulator.drive_train import (
    OPEN_SHARE,
    RPM_PER_RADPS,
    TorqueTables,
    shift_down_rpm,
    shift_up_rpm,
)
from wayline_simulator.journey import MOTION_STEP_S
from wayline_simulator.vehicle import VehicleModel, engine_mass_kg

BRAKING_MPS2 = -0.3
"""Who slows down harder is about to stop or to bend: no gear is chosen before that is over."""
HOLDING_SHARE = 0.85
"""A higher gear must hold the speed with so much of its torque, or it would be left again."""
MARGIN = 1.1
"""A gear is taken only this far from where it would be left again."""
ENGAGING_LOAD = 0.15
"""Torque that is reckoned with when a gear is chosen with an open clutch."""
LOAD_DECAY = 0.9
"""A step, of the load's running mean: half a second."""
REV_DECAY = 0.9
"""A step, of an engine that is free to find its speed."""


class Clutch(Enum):
    """What the driveline does."""

    OPEN = 0
    """The clutch is open, or slips when torque is wanted."""
    CLOSED = 1
    RELEASING = 2
    """Closed, torque going down before a shift."""
    SHIFTING = 3


class Powertrain:
    """Turns a wanted force at the wheels into gear, torque and the force that comes of them."""

    def __init__(self, vehicle: VehicleModel) -> None:
        """Standing with the engine idling."""
        self._engine, self._gearbox = vehicle.engine, vehicle.gearbox
        self._tables = TorqueTables(vehicle.engine)
        gearbox = vehicle.gearbox
        # the index of a gear is its number: neutral first, reverse from the end
        self.ratios = [0.0, *gearbox.ratios, gearbox.reverse_ratio]
        turns = [
            ratio * gearbox.final_drive_ratio / vehicle.wheel_radius_m for ratio in self.ratios
        ]
        self._push_per_m = [turn * gearbox.efficiency for turn in turns]
        self._drag_per_m = [turn / gearbox.efficiency for turn in turns]
        self._rpm_per_mps = [turn * RPM_PER_RADPS for turn in turns]
        self._engine_kg = [engine_mass_kg(vehicle, ratio) for ratio in self.ratios]
        self._open_rpm = OPEN_SHARE * vehicle.engine.launch_rpm
        self._shift_steps = max(round(gearbox.shift_s / MOTION_STEP_S), 1)
        self._ramp_steps = max(round(gearbox.ramp_s / MOTION_STEP_S), 1)
        self._pause_steps = round(gearbox.pause_s / MOTION_STEP_S)
        self._recovered = self._pause_steps // 2
        self._mass_kg = vehicle.mass_kg
        self._next_gear = self._steps_left = self._pause = 0
        self._load = self._released_n = 0.0
        self.stand()

    def stand(self) -> None:
        """In neutral, idling."""
        self.clutch = Clutch.OPEN
        self.gear = 0
        self.rotating_kg = 0.0
        self.torque_nm = 0.0
        self.force_n = 0.0
        self.speed_rpm = self._engine.idle_rpm

    def load(self, mass_kg: float) -> None:
        """Choose gears for another mass from now on."""
        self._mass_kg = mass_kg

    def launch(self, *, backwards: bool) -> None:
        """A gear in, the clutch still open."""
        self.gear = -1 if backwards else self._gearbox.launch_gear
        self._load = ENGAGING_LOAD

    @property
    def driveline_open(self) -> bool:
        """Whether the clutch is open or slips."""
        return self.clutch is Clutch.OPEN or self.clutch is Clutch.SHIFTING

    @property
    def recovering(self) -> bool:
        """Shifting, or torque is coming back after a shift."""
        return self.clutch is Clutch.RELEASING or self._pause > self._recovered

    def prepare(self, speed_mps: float, wanted_mps2: float, hold_n: float) -> None:
        """Open, close or shift as speed and load ask for; `hold_n` would keep the speed."""
        if self.clutch is Clutch.CLOSED:
            self._watch(speed_mps, wanted_mps2, hold_n)
        elif self.clutch is Clutch.OPEN:
            self._engage(speed_mps, wanted_mps2)
        else:
            self._go_on(speed_mps)

    def push(self, speed_mps: float, needed_n: float) -> float:
        """The force at the wheels that comes nearest to the needed one, for the step to come."""
        if self.clutch is Clutch.OPEN:
            self._slip(speed_mps, needed_n)
        elif self.clutch is Clutch.SHIFTING:
            self.force_n = self.torque_nm = 0.0
            target_rpm = max(speed_mps * self._rpm_per_mps[self.gear], self._engine.idle_rpm)
            self.speed_rpm += (target_rpm - self.speed_rpm) / max(self._steps_left, 1)
        else:
            self._drive(speed_mps, needed_n)
        return self.force_n

    def _drive(self, speed_mps: float, needed_n: float) -> None:
        gear = self.gear
        self.speed_rpm = speed_rpm = speed_mps * self._rpm_per_mps[gear]
        full_n = self._tables.full_nm(speed_rpm) * self._push_per_m[gear]
        share = needed_n / full_n if full_n > 0.0 else 1.0
        self._load += (min(max(share, 0.0), 1.0) - self._load) * (1.0 - LOAD_DECAY)
        if self.clutch is Clutch.RELEASING:
            full_n = min(full_n, self._released_n * self._steps_left / self._ramp_steps)
        if needed_n > 0.0:
            self.force_n = min(needed_n, full_n)
            self.torque_nm = self.force_n / self._push_per_m[gear]
        else:
            drag_n = self._tables.drag_nm(speed_rpm) * self._drag_per_m[gear]
            self.force_n = max(needed_n, -drag_n)
            self.torque_nm = self.force_n / self._drag_per_m[gear]

    def _slip(self, speed_mps: float, needed_n: float) -> None:
        engine, gear = self._engine, self.gear
        free_rpm = engine.launch_rpm if needed_n > 0.0 else engine.idle_rpm
        self.speed_rpm += (free_rpm - self.speed_rpm) * (1.0 - REV_DECAY)
        full_n = self._tables.full_nm(engine.launch_rpm) * self._push_per_m[gear]
        self.force_n = min(max(needed_n, 0.0), full_n)
        self.torque_nm = self.force_n / self._push_per_m[gear]
        if needed_n > 0.0:
            self.speed_rpm = max(self.speed_rpm, speed_mps * self._rpm_per_mps[gear])

    def _watch(self, speed_mps: float, wanted_mps2: float, hold_n: float) -> None:
        """With the clutch closed: leave a gear that has become too high or too low."""
        gear = self.gear
        speed_rpm = speed_mps * self._rpm_per_mps[gear]
        if speed_rpm < self._open_rpm:
            self.clutch = Clutch.OPEN
            self.rotating_kg = 0.0
            return
        self._pause -= 1
        if self._pause > 0 or gear < 0:
            return
        target = gear
        if speed_rpm > shift_up_rpm(self._gearbox, self._load):
            target = self._higher(speed_mps, wanted_mps2, hold_n)
        elif wanted_mps2 > BRAKING_MPS2 and speed_rpm < shift_down_rpm(self._gearbox, self._load):
            target = self._lower(speed_mps)
        if target != gear:
            self._next_gear = target
            self._released_n = max(self.force_n, 0.0)
            self.clutch = Clutch.RELEASING
            self._steps_left = self._ramp_steps

    def _higher(self, speed_mps: float, wanted_mps2: float, hold_n: float) -> int:
        """The highest gear within reach that would be kept, or the present one."""
        gearbox, gear = self._gearbox, self.gear
        top = min(gear + 1 + gearbox.skip, len(gearbox.ratios))
        lost_mps = max(hold_n, 0.0) / self._mass_kg * gearbox.shift_s
        needed_n = hold_n + self._mass_kg * max(wanted_mps2, 0.0)
        for higher in range(top, gear, -1):
            speed_rpm = (speed_mps - lost_mps) * self._rpm_per_mps[higher]
            full_n = self._tables.full_nm(speed_rpm) * self._push_per_m[higher]
            load = min(max(needed_n / full_n, 0.0), 1.0) if full_n > 0.0 else 1.0
            kept = speed_rpm > MARGIN * shift_down_rpm(gearbox, load)
            if kept and hold_n < HOLDING_SHARE * full_n:
                return higher
        return gear

    def _lower(self, speed_mps: float) -> int:
        """The highest gear below in which the engine is fast enough, at least the launch gear."""
        enough_rpm = MARGIN * shift_down_rpm(self._gearbox, self._load)
        for lower in range(self.gear - 1, self._gearbox.launch_gear - 1, -1):
            if speed_mps * self._rpm_per_mps[lower] > enough_rpm:
                return lower
        return min(self.gear, self._gearbox.launch_gear)

    def _engage(self, speed_mps: float, wanted_mps2: float) -> None:
        """With the clutch open: close it when the wheels are fast enough and a gear is wanted."""
        if wanted_mps2 < BRAKING_MPS2:
            return
        best = self.gear if self.gear < 0 else self._fitting(speed_mps)
        if best != self.gear:
            self.gear = best
            self.clutch = Clutch.SHIFTING
            self._steps_left = self._shift_steps
        elif speed_mps * self._rpm_per_mps[best] >= self._engine.launch_rpm:
            self._close()

    def _fitting(self, speed_mps: float) -> int:
        enough_rpm = MARGIN * shift_down_rpm(self._gearbox, ENGAGING_LOAD)
        for gear in range(len(self._gearbox.ratios), self._gearbox.launch_gear, -1):
            if speed_mps * self._rpm_per_mps[gear] > enough_rpm:
                return gear
        return self._gearbox.launch_gear

    def _go_on(self, speed_mps: float) -> None:
        """With a shift that has begun."""
        self._steps_left -= 1
        if self._steps_left > 0:
            return
        if self.clutch is Clutch.RELEASING:
            self.clutch = Clutch.SHIFTING
            self.gear = self._next_gear
            self.rotating_kg = 0.0
            self._steps_left = self._shift_steps
        elif speed_mps * self._rpm_per_mps[self.gear] > self._open_rpm:
            self._close()
        else:
            self.clutch = Clutch.OPEN

    def _close(self) -> None:
        self.clutch = Clutch.CLOSED
        self.rotating_kg = self._engine_kg[self.gear]
        self._pause = self._pause_steps
