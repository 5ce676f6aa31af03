"""Pure: how a driver's foot decides on the next moment's acceleration."""

from collections.abc import Sequence
from math import sqrt
from typing import NamedTuple

from wayline_simulator.course import STEP_M
from wayline_simulator.driver import DriverModel
from wayline_simulator.journey import MOTION_STEP_S
from wayline_simulator.vehicle import VehicleModel

AHEAD_S = 1.0
"""A driver answers to what comes in a second: about the time that a foot needs."""
SLOWING_PER_S = 1.0
"""Deceleration for each m/s of too much speed."""
GAINING_PER_S = 0.4
"""Acceleration for each m/s of missing speed: the last of it is gained gently."""
FADING_MPS = 15.0
"""At this speed the acceleration of the start is halved."""
EASING = 0.6
"""v falls with this power of the distance to a stop: braking eases off towards it (0.5: never)."""
REACTION_S = 0.5
"""From the gas to the brake; judgement."""
RELEASE_SHARE = 0.15
"""Of comfortable braking: a stop that asks for less is still far."""
URGENCY = 8
"""A stop that asks for more than comfortable braking is braked for more quickly, by this power."""
HARDEST_MPS2 = 8.0
"""Dry asphalt gives no more."""
LANDING_MPS, LANDING_S = 0.6, 1.5
"""Slower than this and no further from the stop than so many seconds, the vehicle is let roll
out, exactly to the stop."""
NEAR_M = 0.1
"""As near as this a vehicle that stands creeps up to its stop."""
CREEPING_STEPS = 100
"""At most, for the rest of the way."""


class Pedals(NamedTuple):
    """What limits a foot on these pedals."""

    gaining_mps2: float
    braking_mps2: float
    jerk_per_step_mps2: float


def pedals(vehicle: VehicleModel, driver: DriverModel) -> Pedals:
    """Of this driver in this vehicle."""
    share = vehicle.comfort_share
    return Pedals(
        driver.acceleration_mps2 * share,
        driver.braking_mps2 * share,
        driver.jerk_mps3 * share * MOTION_STEP_S,
    )


class Foot:
    """Follows the ceiling speeds of a course and brakes for one stop after the other."""

    def __init__(self, limits: Pedals, ceiling_mps: Sequence[float]) -> None:
        """`ceiling_mps` for each STEP_M of the course."""
        self._limits = limits
        self._last = len(ceiling_mps) - 1
        self._ceiling_mps = ceiling_mps
        self._stopping = False

    def start(self) -> None:
        """Leave a stop."""
        self._stopping = False

    def wanted_mps2(
        self, path_m: float, speed_mps: float, left_m: float, now_mps2: float, *, quick: bool
    ) -> float:
        """Acceleration for the next step, `left_m` before the stop; `quick` after a shift."""
        if speed_mps < LANDING_MPS and left_m < max(LANDING_S * speed_mps, NEAR_M):
            return _landing_mps2(speed_mps, left_m)
        limits = self._limits
        aim = self._aim_mps2(path_m, speed_mps)
        jerk = limits.jerk_per_step_mps2
        up, down = (3.0 * jerk if quick else jerk), jerk
        if self._stopping or self._is_time(speed_mps, left_m):
            stop_mps2 = EASING * speed_mps * speed_mps / left_m
            self._stopping = stop_mps2 > RELEASE_SHARE * limits.braking_mps2
            aim = min(aim, -stop_mps2)
            down *= max(stop_mps2 / limits.braking_mps2, 1.0) ** URGENCY
        elif aim > 0.0:
            # nobody gains speed that has to be braked away at once
            useful_mps = sqrt(limits.braking_mps2 * left_m)
            aim = min(aim, max(useful_mps - speed_mps, 0.0) * GAINING_PER_S)
        return max(min(aim, now_mps2 + up), now_mps2 - down, -HARDEST_MPS2)

    def _is_time(self, speed_mps: float, left_m: float) -> bool:
        """Whether a stop will ask for comfortable braking when the foot is on the brake."""
        then_m = left_m - REACTION_S * speed_mps
        return EASING * speed_mps * speed_mps >= self._limits.braking_mps2 * then_m

    def _aim_mps2(self, path_m: float, speed_mps: float) -> float:
        """What the ceiling here and a moment ahead asks for."""
        here_mps = self._ceiling_at(path_m)
        soon_mps = self._ceiling_at(path_m + speed_mps * AHEAD_S)
        gap_mps = (here_mps if here_mps < soon_mps else soon_mps) - speed_mps
        if gap_mps < 0.0:
            return gap_mps * SLOWING_PER_S
        fading = 1.0 + speed_mps / FADING_MPS
        return min(gap_mps * GAINING_PER_S, self._limits.gaining_mps2 / fading)

    def _ceiling_at(self, path_m: float) -> float:
        """Between the samples, so that the foot does not tremble."""
        place = path_m / STEP_M
        before = int(place)
        if before >= self._last:
            return self._ceiling_mps[self._last]
        first_mps = self._ceiling_mps[before]
        return first_mps + (place - before) * (self._ceiling_mps[before + 1] - first_mps)


def _landing_mps2(speed_mps: float, left_m: float) -> float:
    """The first of n steps after which even braking ends exactly at the stop.

    With v1 after this step, left = dt (v + v1) / 2 + (n - 1) dt v1 / 2.
    """
    twice_mps = 2.0 * left_m / MOTION_STEP_S
    steps = CREEPING_STEPS
    if speed_mps > 0.0:
        steps = min(max(round(twice_mps / speed_mps), 1), CREEPING_STEPS)
    next_mps = max((twice_mps - speed_mps) / steps, 0.0) if steps > 1 else 0.0
    return (next_mps - speed_mps) / MOTION_STEP_S
