"""Pure: where the fixes have moved: it tells heading and speed where nothing else does."""

import math
from typing import NamedTuple

import msgspec

from wayline.geo import step_between, wrap_pi
from wayline_fusion.filter.estimate import UNSURE_HEADING_RAD, Estimate, Reckoned
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import FixTaken

SHORTEST_M = 15.0
"""A way this long has a direction worth having..."""
NOISE_MAX_RAD = math.radians(15.0)
"""...unless the fixes' own noise turns it further."""
LONGEST_S = 10.0
LONGEST_INTERVALS = 1.5
"""A way that takes longer than both is none: the vehicle stands, or crawls."""
STD_MAX_RAD = math.radians(45.0)
"""A direction of long ago says no more of the heading of now."""
ALIKE_SHARE = 0.5
"""A way that was reckoned half as long as the fixes have moved, or twice, is another one."""
CRAWL_MPS = 1.0
"""Slower, noise tells the direction."""
STARTING_MPS = 1.0
"""Who stood between two fixes may just have driven off."""


class Anchor(NamedTuple):
    """A fix from which the way is measured, and where reckoning had come to."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    std_m: float
    reckoned: Reckoned


class Moved(NamedTuple):
    """From one fix to another: means over the time between them."""

    distance_m: float
    bearing_rad: float
    noise_m: float
    """Std of the distance, and across it."""
    elapsed_s: float
    reckoned_m: tuple[float, float]
    """East and north in the frame of the reckoned way..."""
    biased_s: float
    """...and for how long the gyro's bias has bent it."""

    @property
    def speed_mps(self) -> float:
        """Of the straight line."""
        return self.distance_m / self.elapsed_s


class WayEvidence(msgspec.Struct, frozen=True):
    """What earlier fixes have shown."""

    anchor: Anchor | None = None


class Displacement:
    """Heading and speed from where believed positions have moved.

    Starts: with the second one, while the heading is not known, or unsure, as it is where no
    course is told. Goes on: the direction turns the heading by what the way was reckoned askew, in
    reverse too; where neither receiver nor wheels tell a speed, the way over the time tells the
    mean one. Stops: heading and speed are sure; from then on positions themselves correct both, and
    a displacement would count them twice. Resets: after a way that is too short for its time it
    begins anew.
    """

    def __init__(self) -> None:
        self.evidence = WayEvidence()

    def take(self, estimate: Estimate, fix: FixTaken) -> Outcome:
        """Set what is not known from the way since an earlier fix."""
        anchor = self.evidence.anchor
        if estimate.situation.accepted_fix_ns != fix.t_ns:
            if anchor is not None and fix.t_ns - anchor.t_ns > _longest_s(estimate) * 1e9:
                self.evidence = WayEvidence()
            return UNUSED
        if not estimate.wheels_fresh and not fix.tells_speed:
            _face_forwards(estimate)
        here = Anchor(fix.t_ns, fix.lat_deg, fix.lon_deg, fix.std_m, estimate.reckoned)
        if anchor is None:
            self.evidence = WayEvidence(here)
            return UNUSED
        moved = _moved(anchor, here)
        if moved.elapsed_s <= 0.0:
            return UNUSED  # two receivers' fixes of one instant
        is_long = moved.distance_m >= max(SHORTEST_M, moved.noise_m / NOISE_MAX_RAD)
        is_over = moved.elapsed_s > _longest_s(estimate)
        if (
            is_long
            and not estimate.way_reckoned(tells_speed=fix.tells_speed)
            and self._turn(estimate, moved)
        ):
            is_over = True
        if (is_long or is_over) and not fix.tells_speed:
            _set_speed(estimate, moved)
        if is_long or is_over:
            self.evidence = WayEvidence(here)
        return UNUSED

    def _turn(self, estimate: Estimate, moved: Moved) -> bool:
        """Whether the heading was set: it was not as sure as the direction of the way is."""
        kalman, is_known = estimate.filter, estimate.situation.heading_known
        std_rad = _std_rad(estimate, moved)
        known_rad = kalman.std(States.HEADING)
        is_unsure = known_rad > UNSURE_HEADING_RAD or _is_way_unknown(estimate)
        is_better = not is_known or (is_unsure and known_rad > std_rad)
        if std_rad > STD_MAX_RAD or not is_better:
            return False
        kalman.reset_heading(_heading_rad(estimate, moved), std_rad)
        estimate.know(heading_known=True)
        return True


def _moved(anchor: Anchor, here: Anchor) -> Moved:
    step = step_between(anchor.lat_deg, anchor.lon_deg, here.lat_deg, here.lon_deg)
    reckoned_m = (
        here.reckoned.east_m - anchor.reckoned.east_m,
        here.reckoned.north_m - anchor.reckoned.north_m,
    )
    return Moved(
        step.distance_m,
        math.radians(step.bearing_deg),
        math.hypot(anchor.std_m, here.std_m),
        (here.t_ns - anchor.t_ns) * 1e-9,
        reckoned_m,
        here.reckoned.biased_s - anchor.reckoned.biased_s,
    )


def _longest_s(estimate: Estimate) -> float:
    return max(LONGEST_S, LONGEST_INTERVALS * estimate.situation.fix_interval_s)


def _heading_rad(estimate: Estimate, moved: Moved) -> float:
    """The heading, turned as the way is that was reckoned with it; without one, the way's."""
    east_m, north_m = moved.reckoned_m
    reckoned_m, heading_rad = math.hypot(east_m, north_m), estimate.reckoned.heading_rad
    if ALIKE_SHARE * moved.distance_m <= reckoned_m <= moved.distance_m / ALIKE_SHARE:
        # the reckoned way bends by the gyro's bias; half of it is behind the way's middle
        bent_rad = 0.5 * float(estimate.filter.x[States.GYRO_BIAS]) * moved.biased_s
        return heading_rad - bent_rad + wrap_pi(moved.bearing_rad - math.atan2(east_m, north_m))
    backwards_rad = math.pi if estimate.filter.x[States.WHEEL_SPEED] < 0.0 else 0.0
    return moved.bearing_rad + backwards_rad


def _std_rad(estimate: Estimate, moved: Moved) -> float:
    """Of the heading now: the fixes' noise, and what has turned unseen since the way's middle."""
    kalman = estimate.filter
    noise_rad = math.atan2(moved.noise_m, moved.distance_m)
    if estimate.gyro.covers(estimate.t_ns):
        unseen_rad = 0.5 * moved.elapsed_s * kalman.std(States.GYRO_BIAS)
    else:
        unseen_rad = kalman.turn_rad_per_sqrt_s() * math.sqrt(moved.elapsed_s / 3.0)
    return math.hypot(noise_rad, unseen_rad)


def _is_way_unknown(estimate: Estimate) -> bool:
    """Whether the position of this fix has told nothing of heading and speed."""
    return estimate.situation.way_unknown_ns == estimate.t_ns


def _face_forwards(estimate: Estimate) -> None:
    """Positions alone cannot tell a vehicle from one that goes backwards the other way."""
    speed_mps = estimate.filter.x[States.WHEEL_SPEED]
    if speed_mps < -CRAWL_MPS:
        estimate.filter.mirror()
    elif speed_mps < 0.0:
        estimate.filter.reset_speed()


def _set_speed(estimate: Estimate, moved: Moved) -> None:
    """Where nothing tells the speed: the mean one, unsure by what may have changed since."""
    tuning, kalman = estimate.tuning, estimate.filter
    if estimate.wheels_fresh:
        return
    density = 2.0 * tuning.acceleration_std_mps2**2 * tuning.acceleration_time_s
    changed_mps = math.sqrt(density * moved.elapsed_s / 3.0)
    # no speed is negative: a slow mean leaves little room for a fast end
    room_mps = moved.speed_mps + STARTING_MPS
    std_mps = math.hypot(moved.noise_m / moved.elapsed_s, min(changed_mps, room_mps))
    if _is_way_unknown(estimate) or kalman.speed_std_mps > std_mps:
        scale = float(kalman.x[States.ODOMETER_SCALE])
        kalman.reset_wheel_speed(moved.speed_mps / scale, std_mps, is_over_ground=True)
