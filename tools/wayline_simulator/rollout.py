"""Pure: a vehicle's way from stop to stop, one step after the other.

Scalars and lists only: numpy is slow for one number at a time.
"""

from array import array
from typing import NamedTuple

import numpy as np

from wayline.errors import InputError
from wayline_simulator.course import STEP_M, Course, Floats
from wayline_simulator.foot import Foot
from wayline_simulator.journey import MOTION_STEP_S
from wayline_simulator.powertrain import Clutch, Powertrain
from wayline_simulator.road_load import RoadLoad
from wayline_simulator.traffic import Standstill
from wayline_simulator.vehicle import VehicleModel, rigid_mass_kg

ARRIVED_M = 1e-3
"""Standing so near to a stop is standing there."""
RESTING_MPS = 1e-9
"""Slower is rounding."""
PATIENCE_STEPS = round(60.0 / MOTION_STEP_S)
"""Who has not moved for a minute though nothing is in the way never will."""
BRAKE_MPS2 = 0.12
"""What engine and resistance may leave undone before the foot goes to the brake; judgement."""


class Records(NamedTuple):
    """Every MOTION_STEP_S from 0 s; `journey.Motion` says what they are. Shape (n,) each."""

    path_m: Floats
    speeds_mps: Floats
    engine_torque_nm: Floats
    engine_speed_rpm: Floats
    gear: Floats
    brake: Floats
    clutch: Floats
    drive_force_n: Floats
    brake_force_n: Floats
    resistance_n: Floats


class Rollout:
    """The vehicle's way through time, scalar by scalar; acceleration is even in each step."""

    def __init__(self, course: Course, vehicle: VehicleModel, load: RoadLoad, foot: Foot) -> None:
        self._load, self._foot = load, foot
        self._backwards = course.backwards
        self._powertrain = Powertrain(vehicle)
        self._rigid_kg = rigid_mass_kg(vehicle)
        self._last = len(load.slope_n) - 1
        self._path_m = self._speed_mps = self._now_mps2 = 0.0
        self._braking = False
        self._rows = array("d")
        """The fields of Records, one step after the other."""

    def records(self) -> Records:
        """What was written, a column each."""
        return Records(*np.frombuffer(self._rows).reshape(-1, len(Records._fields)).T)

    def stand(self, wait_s: float, *, parked: bool) -> None:
        """At rest, the engine idling, held by the foot or by the parking brake."""
        self._powertrain.stand()
        self._now_mps2 = 0.0
        hold_n = abs(self._load.slope_n[min(int(self._path_m / STEP_M), self._last)])
        idle_rpm = self._powertrain.speed_rpm
        row = (self._path_m, 0.0, 0.0, idle_rpm, 0.0, float(not parked), 1.0, 0.0, hold_n, 0.0)
        self._rows.extend(row * max(round(wait_s / MOTION_STEP_S), 1))

    def load(self, vehicle: VehicleModel) -> None:
        """Stand with another mass from now on."""
        self._rigid_kg = rigid_mass_kg(vehicle)
        self._powertrain.load(vehicle.mass_kg)

    def go_to(self, stop: Standstill) -> None:
        """From rest to rest at a stop."""
        ahead = self._backwards[min(round(self._path_m / STEP_M), self._last)]
        self._powertrain.launch(backwards=bool(ahead))
        self._foot.start()
        standing = 0
        while stop.distance_m - self._path_m > ARRIVED_M or self._speed_mps > 0.0:
            self._step(stop.distance_m)
            standing = standing + 1 if self._speed_mps == 0.0 else 0
            if standing > PATIENCE_STEPS:
                where = f"course at {self._path_m:.0f} m"
                raise InputError(where, "too steep for the vehicle", "take another vehicle")
        # a rounding error before a turn would count as the wrong direction
        self._path_m = stop.distance_m

    def _step(self, stop_m: float) -> None:
        load, powertrain = self._load, self._powertrain
        path_m, speed_mps = self._path_m, self._speed_mps
        place = min(int((path_m + speed_mps * (0.5 * MOTION_STEP_S)) / STEP_M), self._last)
        level = load.level_share[place]
        left_m = max((stop_m - path_m) / level, 1e-9)
        wanted_mps2 = self._foot.wanted_mps2(
            path_m, speed_mps, left_m, self._now_mps2, quick=powertrain.recovering
        )
        wind_mps = speed_mps + load.headwind_mps[place]
        resistance_n = load.rolling_n[place] + load.air_n_per_mps2[place] * wind_mps * abs(wind_mps)
        hold_n = resistance_n + load.slope_n[place]
        powertrain.prepare(speed_mps, wanted_mps2, hold_n)
        mass_kg = self._rigid_kg + powertrain.rotating_kg
        needed_n = mass_kg * wanted_mps2 + hold_n
        drive_n = powertrain.push(speed_mps, needed_n)
        brake_n = self._brake_n(drive_n - needed_n, mass_kg)
        gained_mps2 = (drive_n - brake_n - hold_n) / mass_kg
        # after a shift the foot begins where the shift has left it
        self._now_mps2 = gained_mps2 if powertrain.clutch is Clutch.SHIFTING else wanted_mps2
        next_mps = speed_mps + gained_mps2 * MOTION_STEP_S
        if next_mps < RESTING_MPS:
            next_mps = 0.0
        self._write(drive_n, brake_n, resistance_n)
        gone_m = 0.5 * (speed_mps + next_mps) * MOTION_STEP_S * level
        self._path_m = min(path_m + gone_m, stop_m)
        self._speed_mps = next_mps

    def _brake_n(self, surplus_n: float, mass_kg: float) -> float:
        """The foot goes to the brake for what is worth it, and stays until nothing is left."""
        if surplus_n > BRAKE_MPS2 * mass_kg:
            self._braking = True
        elif surplus_n <= 0.0:
            self._braking = False
        return surplus_n if self._braking else 0.0

    def _write(self, drive_n: float, brake_n: float, resistance_n: float) -> None:
        powertrain = self._powertrain
        self._rows.extend(
            (
                self._path_m,
                self._speed_mps,
                powertrain.torque_nm,
                powertrain.speed_rpm,
                powertrain.gear,
                self._braking,
                powertrain.driveline_open,
                drive_n,
                brake_n,
                resistance_n,
            )
        )
