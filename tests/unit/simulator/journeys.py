"""Small journeys made by hand, so that a sensor's truth is known without a driver."""

import math

import numpy as np

from wayline_simulator.course import STEP_M, Course, Surroundings, lay_course
from wayline_simulator.journey import MOTION_STEP_S, Floats, Journey, Motion

WHEEL_RADIUS_M = 0.31
LAT_DEG, LON_DEG, ALT_M = 59.20, 17.63, 30.0


def course(
    length_m: float,
    *,
    heading_deg: float = 90.0,
    curvature_per_m: Floats | float = 0.0,
    grade: Floats | float = 0.0,
    limit_mps: float = 30.0,
    surroundings: np.ndarray[tuple[int], np.dtype[np.int8]] | Surroundings = Surroundings.OPEN,
    backwards_after_m: float = math.inf,
) -> Course:
    """A road of a length; a number stands for the whole road, an array has one for each sample."""
    count = math.ceil(length_m / STEP_M) + 2
    return lay_course(
        lat_deg=LAT_DEG,
        lon_deg=LON_DEG,
        heading_deg=heading_deg,
        alt_m=ALT_M,
        curvature_per_m=np.broadcast_to(np.asarray(curvature_per_m, dtype=np.float64), count),
        grade=np.broadcast_to(np.asarray(grade, dtype=np.float64), count),
        limits_mps=np.full(count, limit_mps),
        surroundings=np.broadcast_to(np.asarray(surroundings, dtype=np.int8), count),
        backwards=np.arange(count) * STEP_M >= backwards_after_m,
    )


def journey(road: Course, speeds_mps: Floats) -> Journey:
    """Driven along a course at speeds over the surface, one every MOTION_STEP_S.

    No slip, no resistance: the engine has the torque that acceleration and grade ask of a car of
    1500 kg in a gear of 1.0 with a final drive of 4.1.
    """
    steps_m = (speeds_mps[:-1] + speeds_mps[1:]) / 2.0 * MOTION_STEP_S
    path_m = np.zeros(len(speeds_mps))
    for index, step_m in enumerate(steps_m):
        grade = road.grade[min(int(path_m[index] / STEP_M), len(road.grade) - 1)]
        path_m[index + 1] = path_m[index] + step_m / math.hypot(1.0, float(grade))
    grades = np.interp(path_m, road.distances_m, road.grade)
    accelerations = np.append(np.diff(speeds_mps) / MOTION_STEP_S, 0.0)
    force_n = 1500.0 * (accelerations + 9.81 * np.sin(np.arctan(grades)))
    count = len(speeds_mps)
    wheel_radps = speeds_mps / WHEEL_RADIUS_M
    return Journey(
        road,
        Motion(
            times_s=np.arange(count, dtype=np.float64) * MOTION_STEP_S,
            path_m=path_m,
            speeds_mps=speeds_mps,
            wheel_radps=wheel_radps,
            engine_torque_nm=force_n * WHEEL_RADIUS_M / 4.1,
            engine_speed_rpm=np.maximum(800.0, wheel_radps * 4.1 * 60.0 / (2.0 * math.pi)),
            gear=np.ones(count, dtype=np.int8),
            gear_ratio=np.ones(count),
            brake=accelerations < -0.5,
            clutch=np.zeros(count, dtype=np.bool_),
            drive_force_n=np.maximum(force_n, 0.0),
            brake_force_n=np.maximum(-force_n, 0.0),
            resistance_n=np.zeros(count),
        ),
    )


def cruise(
    speed_mps: float,
    duration_s: float,
    *,
    curvature_per_m: float = 0.0,
    grade: float = 0.0,
    surroundings: Surroundings = Surroundings.OPEN,
) -> Journey:
    """At one speed from beginning to end."""
    road = course(
        speed_mps * duration_s + STEP_M,
        curvature_per_m=curvature_per_m,
        grade=grade,
        surroundings=surroundings,
    )
    return journey(road, np.full(round(duration_s / MOTION_STEP_S) + 1, speed_mps))


def standing(duration_s: float, surroundings: Surroundings = Surroundings.OPEN) -> Journey:
    """At rest from beginning to end."""
    return cruise(0.0, duration_s, surroundings=surroundings)


def turns_and_stops(blocks: int = 4, speed_mps: float = 12.0) -> Journey:
    """Round the houses to the right: a stop of 10 s, 240 m straight ahead, a bend of 90 degrees."""
    start_s, stand_s, side_m, radius_m = 8.0, 10.0, 240.0, 20.0
    bend_m = radius_m * math.pi / 2.0
    moving_s = (side_m + bend_m) / speed_mps + start_s
    leg_s = stand_s + moving_s
    times_s = np.arange(round(blocks * leg_s / MOTION_STEP_S) + 1) * MOTION_STEP_S
    since_s = np.maximum(times_s % leg_s - stand_s, 0.0)
    ramp = np.minimum(since_s, moving_s - since_s) / start_s
    speeds_mps = speed_mps * np.clip(ramp, 0.0, 1.0)
    length_m = blocks * (side_m + bend_m)
    places_m = np.arange(math.ceil(length_m / STEP_M) + 2) * STEP_M
    into_m = places_m % (side_m + bend_m)
    bending = np.abs(into_m - 120.0 - bend_m / 2.0) < bend_m / 2.0
    return journey(
        course(length_m, curvature_per_m=np.where(bending, 1.0 / radius_m, 0.0)), speeds_mps
    )
