"""Pure: where the work of an engine went over a journey: the check that the physics closes."""

from typing import NamedTuple

import numpy as np

from wayline_simulator.drive_train import RPM_PER_RADPS
from wayline_simulator.journey import MOTION_STEP_S, Floats, Journey, Motion
from wayline_simulator.road_load import GRAVITY_MPS2
from wayline_simulator.vehicle import VehicleModel, engine_mass_kg, rigid_mass_kg


class EnergyBalance(NamedTuple):
    """Joules over a whole journey; drive = brake + resistance + kinetic + engine + potential."""

    crankshaft_j: float
    """Work of the crankshaft, negative on the overrun."""
    drive_j: float
    """Work that reached the road: less driveline, slipping clutch and tyres' slip."""
    brake_j: float
    resistance_j: float
    kinetic_j: float
    """Gained by vehicle and wheels."""
    engine_j: float
    """Taken up by the engine's rotation through a closed clutch; lost when it opens."""
    potential_j: float
    """From the course's altitudes."""

    @property
    def residual_j(self) -> float:
        """What is not accounted for."""
        spent_j = self.brake_j + self.resistance_j + self.kinetic_j + self.engine_j
        return self.drive_j - spent_j - self.potential_j

    @property
    def residual_share(self) -> float:
        """Of the drive's work."""
        return self.residual_j / self.drive_j


def energy_balance(journey: Journey, vehicle: VehicleModel) -> EnergyBalance:
    """All terms over the journey, forces times way from the motion, heights from the course."""
    motion, course = journey.motion, journey.course
    speeds_mps = motion.speeds_mps
    surface_m = (speeds_mps[:-1] + speeds_mps[1:]) / 2.0 * MOTION_STEP_S
    half_squares = np.diff(speeds_mps**2) / 2.0
    engine_kg = _engine_mass_kg(motion, vehicle)[:-1]
    alts_m = np.interp(motion.path_m[[0, -1]], course.distances_m, course.alts_m)
    turned_rad = _between(motion.engine_speed_rpm) / RPM_PER_RADPS * MOTION_STEP_S
    return EnergyBalance(
        crankshaft_j=_sum(motion.engine_torque_nm[:-1] * turned_rad),
        drive_j=_sum(motion.drive_force_n[:-1] * surface_m),
        brake_j=_sum(motion.brake_force_n[:-1] * surface_m),
        resistance_j=_sum(motion.resistance_n[:-1] * surface_m),
        kinetic_j=rigid_mass_kg(vehicle) * _sum(half_squares),
        engine_j=_sum(engine_kg * half_squares),
        potential_j=vehicle.mass_kg * GRAVITY_MPS2 * float(alts_m[1] - alts_m[0]),
    )


def _engine_mass_kg(motion: Motion, vehicle: VehicleModel) -> Floats:
    """What the engine's rotation adds to the mass in each step."""
    closed = ~motion.clutch & (motion.gear != 0)
    ratios, inverse = np.unique(np.where(closed, motion.gear_ratio, 0.0), return_inverse=True)
    return np.array([engine_mass_kg(vehicle, float(ratio)) for ratio in ratios])[inverse]


def _between(values: Floats) -> Floats:
    middle: Floats = (values[:-1] + values[1:]) / 2.0
    return middle


def _sum(values: Floats) -> float:
    return float(np.sum(values))
