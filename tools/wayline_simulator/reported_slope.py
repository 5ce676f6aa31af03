"""Pure: the slope that a truck makes of its torque and reports on its bus (papers/004)."""

import math

import numpy as np
from scipy.signal import lfilter

from wayline.drive import Vehicle
from wayline_simulator.journey import Floats, Journey
from wayline_simulator.noise import in_steps
from wayline_simulator.torque import TorqueModel, TorqueSamples, reference_torque_nm

INVALID_PCT = 13.0
"""Reported while the wheel brakes are on, whose force nobody knows (papers/004 section 3.3)."""
GRAVITY_MPS2 = 9.81
AIR_KG_PER_M3 = 1.225
"""At sea level in the standard atmosphere (ISO 2533); the vehicle does not know better."""


def reported_slopes_pct(
    journey: Journey,
    model: TorqueModel,
    samples: TorqueSamples,
    assumed: Vehicle,
    random: np.random.Generator,
) -> Floats:
    """The slope beside every sample, in whole steps and INVALID_PCT while braking.

    Made of the noisy torque and wheel speed and of what the vehicle is assumed to be, wind unknown.
    """
    motion = journey.motion
    rolled_mps = motion.wheel_radps * assumed.wheel_radius_m
    speeds_mps = np.interp(samples.instants_s, motion.times_s, rolled_mps)
    speeds_mps += model.slope_speed_noise_mps * random.standard_normal(len(speeds_mps))
    share = _incline_share(samples, assumed, speeds_mps, model.rate_hz)
    kept = math.exp(-1.0 / (model.rate_hz * model.slope_filter_s))
    smooth = lfilter([1.0 - kept], [1.0, -kept], share)
    slopes_pct = 100.0 * np.tan(np.arcsin(np.clip(smooth, -0.9, 0.9)))
    most_pct = INVALID_PCT - model.slope_resolution_pct
    slopes_pct = np.clip(in_steps(slopes_pct, model.slope_resolution_pct), -most_pct, most_pct)
    return np.where(samples.brake, INVALID_PCT, slopes_pct)


def _incline_share(
    samples: TorqueSamples, assumed: Vehicle, speeds_mps: Floats, rate_hz: float
) -> Floats:
    """F_incline / F_gravity by (4.1) to (4.4) of papers/004.

    (4.5) takes the arctan of it; a force along the road is the weight's sine, which differs by
    0.05 % at a slope of 10 %.
    """
    weight_n = assumed.mass_kg * GRAVITY_MPS2
    accelerations_mps2 = np.diff(speeds_mps, prepend=speeds_mps[:1]) * rate_hz
    drive_n = _torque_force_n(samples, assumed) - assumed.mass_kg * accelerations_mps2
    moving = speeds_mps > 0.1
    roll_n = np.where(moving, assumed.rolling_coefficient * weight_n, 0.0)
    drag_m2 = assumed.drag_coefficient * assumed.frontal_area_m2
    air_n = 0.5 * AIR_KG_PER_M3 * drag_m2 * speeds_mps**2
    shares: Floats = (drive_n - roll_n - air_n) / weight_n
    return shares


def _torque_force_n(samples: TorqueSamples, assumed: Vehicle) -> Floats:
    """At the wheels; losses are borne by the engine in drive and by the vehicle on the overrun."""
    torques_nm = samples.torques_pct / 100.0 * reference_torque_nm(assumed)
    through = np.where(
        torques_nm >= 0.0, assumed.driveline_efficiency, 1.0 / assumed.driveline_efficiency
    )
    closed = ~samples.clutch
    ratios = samples.gear_ratios * assumed.final_drive_ratio
    forces_n: Floats = closed * torques_nm * ratios * through / assumed.wheel_radius_m
    return forces_n
