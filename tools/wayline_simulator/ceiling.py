"""Pure: how fast a driver would go at each place of a course, seeing what is ahead."""

import numpy as np

from wayline_simulator.course import STEP_M, Course, Floats
from wayline_simulator.driver import DriverModel
from wayline_simulator.traffic import Queue
from wayline_simulator.vehicle import VehicleModel

SLOWEST_MPS = 0.8
"""Nobody creeps along more slowly between stops."""
EARLY_SHARE = 0.8
"""Of comfortable braking, for a lower limit or a bend that is seen from afar; judgement."""
EVEN_CURVATURE_PER_M = 1e-6
"""Less bend than this is none."""


def ceiling_mps(
    course: Course,
    vehicle: VehicleModel,
    driver: DriverModel,
    share: Floats,
    jams: list[Queue],
) -> Floats:
    """Highest speed at each sample from which all that follows can be met by early braking.

    `share` is what driver and traffic make of the permitted speed. Shape (n,).
    """
    lateral_mps2 = driver.lateral_mps2 * vehicle.comfort_share
    curvature_per_m = np.maximum(np.abs(course.curvature_per_m), EVEN_CURVATURE_PER_M)
    permitted_mps = np.minimum(course.limits_mps * driver.pace * share, vehicle.top_speed_mps)
    speeds_mps = np.minimum(permitted_mps, np.sqrt(lateral_mps2 / curvature_per_m))
    speeds_mps[course.backwards] = np.minimum(speeds_mps[course.backwards], driver.reverse_mps)
    for jam in jams:
        inside = slice(int(jam.start_m / STEP_M), int(jam.end_m / STEP_M) + 1)
        speeds_mps[inside] = np.minimum(speeds_mps[inside], jam.speed_mps)
    braking_mps2 = EARLY_SHARE * driver.braking_mps2 * vehicle.comfort_share
    return _reachable_mps(np.maximum(speeds_mps, SLOWEST_MPS), braking_mps2)


def _reachable_mps(speeds_mps: Floats, braking_mps2: float) -> Floats:
    """No faster than braking allows for any place ahead: v^2 <= v_ahead^2 + 2 b distance.

    With 2 b distance added from the start, that is a running minimum from the end.
    """
    gained = 2.0 * braking_mps2 * STEP_M * np.arange(len(speeds_mps))
    squares = np.minimum.accumulate((speeds_mps**2 + gained)[::-1])[::-1] - gained
    reachable_mps: Floats = np.sqrt(squares)
    return reachable_mps
