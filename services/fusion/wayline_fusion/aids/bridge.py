"""Pure: the way between two fixes that tell speed and course, where nothing else tells of it."""

import math

import numpy as np

from wayline.geo import wrap_pi
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.filter.situation import Waypoint, direction
from wayline_fusion.filter.states import Floats
from wayline_fusion.intake.events import VelocityTold

SHORTEST_S = 3.0
"""Over less, going straight on is as good."""
LONGEST_S = 20.0
"""Over more, a vehicle has been anywhere between."""


class Bridge:
    """The way between two fixes by the velocities at both ends.

    Starts: without a gyro and wheels, at the second fix that tells speed and course. Goes on:
    before each position the vehicle is put where the mean of both velocities leads from the fix
    before, as unsure as they are and as speed and heading may have changed between. Stops: a gyro
    or wheels tell the way; fixes come so often that prediction is as good, and averages more of
    them, or so seldom that the ends say little of what lies between. Resets: nothing else.
    """

    def __init__(self) -> None:
        self.evidence = None

    def take(self, estimate: Estimate, told: VelocityTold) -> Outcome:
        """Put the vehicle where both velocities lead, and remember how it moves now."""
        if not estimate.located:
            return UNUSED
        before = estimate.situation.waypoint
        is_alone = not (estimate.gyro.covers(told.t_ns) or estimate.wheels_fresh)
        if before is not None and is_alone:
            elapsed_s = (told.t_ns - before.t_ns) * 1e-9
            if SHORTEST_S < elapsed_s <= LONGEST_S:
                _lead(estimate, before, elapsed_s)
        estimate.pass_waypoint()
        return UNUSED


def _lead(estimate: Estimate, before: Waypoint, elapsed_s: float) -> None:
    plane = estimate.situation.plane
    if plane is None:
        return
    east_m, north_m = plane.to_plane(before.lat_deg, before.lon_deg)
    way_m, way_m2 = _way(estimate, before, elapsed_s)
    kept = math.exp(-elapsed_s / estimate.driving_noise().fix_error_time_s)
    aged = np.array([1.0, 1.0, kept, kept])
    covariance = before.covariance * np.outer(aged, aged)
    covariance[:2, :2] += way_m2
    covariance[2:, 2:] += (1.0 - kept**2) * np.eye(2)
    estimate.filter.reset_place(east_m + way_m[0], north_m + way_m[1], covariance)
    estimate.know(way_unknown_ns=estimate.t_ns)


def _way(estimate: Estimate, before: Waypoint, elapsed_s: float) -> tuple[Floats, Floats]:
    """East and north of the way, and its covariance.

    The change from one velocity to the other may have come at any time between. Besides, speed and
    heading wander: a Brownian bridge has an integral of variance q t^3 / 12.
    """
    tuning, here, there = estimate.tuning, before.velocity, estimate.velocity()
    changed_m = (there.vector_mps - here.vector_mps) * elapsed_s
    gained_mps2 = 2.0 * tuning.acceleration_std_mps2**2 * tuning.acceleration_time_s
    speeds_mps = abs(here.speed_mps), abs(there.speed_mps)
    # halfway a bridge's variance is a quarter of what its ends would have without each other
    fastest_mps = math.hypot(max(speeds_mps), math.sqrt(0.25 * gained_mps2 * elapsed_s))
    turn_rad = math.radians(tuning.turn_noise_deg_per_sqrt_s)
    at_speed_rad = tuning.lateral_acceleration_std_mps2 / max(min(speeds_mps), 0.1)
    turn_rad2 = min(turn_rad, at_speed_rad) ** 2
    aside = 0.5 * (1.0 - math.exp(-0.5 * (turn_rad2 * elapsed_s + there.heading_std_rad**2)))
    turned_rad = wrap_pi(there.heading_rad - here.heading_rad)
    along = direction(here.heading_rad + 0.5 * turned_rad)
    along_m2 = (1.0 - aside) * gained_mps2 * np.outer(along, along)
    across_m2 = aside * gained_mps2 + fastest_mps**2 * turn_rad2
    wandered = along_m2 + across_m2 * (np.eye(2) - np.outer(along, along))
    covariance_m2 = (np.outer(changed_m, changed_m) + wandered * elapsed_s**3) / 12.0
    unsure = here.covariance_m2ps2() + there.covariance_m2ps2()
    way_m = 0.5 * (here.vector_mps + there.vector_mps) * elapsed_s
    return way_m, covariance_m2 + 0.25 * elapsed_s**2 * unsure
