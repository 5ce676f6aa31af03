"""Straight drives for a receiver to measure."""

import numpy as np

from wayline_simulator.course import STEP_M, Surroundings, lay_course
from wayline_simulator.journey import MOTION_STEP_S, Floats, Journey, Motion

START_S = 1_767_250_800.0
"""2026-01-01 07:00 UTC"""
LAT_DEG, LON_DEG = 48.1, 11.6


def drive(
    speed_mps: float = 15.0,
    duration_s: float = 600.0,
    surroundings: Surroundings = Surroundings.OPEN,
    *,
    covered_m: tuple[float, float] | None = None,
    heading_deg: float = 30.0,
    grade: float = 0.0,
) -> Journey:
    """A steady drive straight ahead; in a tunnel from the first of `covered_m` to the second."""
    count = int(speed_mps * duration_s / STEP_M) + 3
    around = np.full(count, surroundings, dtype=np.int8)
    if covered_m:
        around[int(covered_m[0] / STEP_M) : int(covered_m[1] / STEP_M)] = Surroundings.TUNNEL
    course = lay_course(
        lat_deg=LAT_DEG,
        lon_deg=LON_DEG,
        heading_deg=heading_deg,
        alt_m=520.0,
        curvature_per_m=np.zeros(count),
        grade=np.full(count, grade),
        limits_mps=np.full(count, 30.0),
        surroundings=around,
    )
    return Journey(course, _steady(speed_mps, duration_s))


def _steady(speed_mps: float, duration_s: float) -> Motion:
    times_s: Floats = np.arange(round(duration_s / MOTION_STEP_S) + 1.0) * MOTION_STEP_S
    nothing: Floats = np.zeros_like(times_s)
    return Motion(
        times_s=times_s,
        path_m=speed_mps * times_s,
        speeds_mps=nothing + speed_mps,
        wheel_radps=nothing,
        engine_torque_nm=nothing,
        engine_speed_rpm=nothing,
        gear=nothing.astype(np.int8),
        gear_ratio=nothing,
        brake=nothing > 0.0,
        clutch=nothing > 0.0,
        drive_force_n=nothing,
        brake_force_n=nothing,
        resistance_n=nothing,
    )
