"""Pure: motion that no sensor tells: turns without a gyro, starts and stops without a speed."""

import math

import numpy as np

from wayline.likelihood import Measurement
from wayline_fusion.filter.estimate import Estimate

TIGHTEST_M = 4.5
"""Radius of a small car's tightest turn."""
HARDEST_MPS2 = 6.0
"""Sideways: drivers in a hurry; tyres hold more."""
SHORTEST_S = 0.5
"""Fixes may come faster, and a course is as old as its filter."""


def allow_turn(estimate: Estimate, off_rad: float, speed_mps: float, since_ns: int | None) -> bool:
    """Whether a vehicle at a speed can have turned so far since an instant, unseen.

    Starts: a course or a position fails the gate and no gyro tells of turns. Goes on: never, the
    next one is judged by what this one has made of the heading. Stops: what no vehicle can turn is
    left rejected. Resets: nothing; the heading is doubted by as much as it is off.
    """
    if since_ns is None or estimate.gyro.covers(estimate.t_ns):
        return False
    over_s = _over_s(estimate, since_ns)
    rate_radps = min(speed_mps / TIGHTEST_M, HARDEST_MPS2 / max(speed_mps, 0.1))
    if abs(off_rad) > rate_radps * over_s:
        return False
    # where a position has been believed since, the way to it is not in question
    way_ns = estimate.t_ns - max(since_ns, estimate.situation.accepted_fix_ns or 0)
    estimate.filter.inflate_turn(min(abs(off_rad), math.pi), way_ns * 1e-9)
    return True


def allow_unseen(estimate: Estimate, unlikely: Measurement) -> bool:
    """Whether a turn, a start or a stop that nothing tells can have led to an unlikely position.

    Starts: a position fails the gate. Goes on: the longer none was believed, the more is possible.
    Stops: what no vehicle can do is left rejected. Resets: nothing; heading or acceleration are
    doubted by as much.
    """
    accepted_ns = estimate.situation.accepted_fix_ns
    if accepted_ns is None:
        return False
    off_m = float(np.hypot(*unlikely.y))
    speed_mps = abs(estimate.filter.speed_mps)
    way_m = max(speed_mps * _over_s(estimate, accepted_ns), 1.0)
    if allow_turn(estimate, 2.0 * math.atan2(off_m, way_m), speed_mps, accepted_ns):
        return True
    return _allow_start(estimate, off_m, accepted_ns)


def _allow_start(estimate: Estimate, off_m: float, accepted_ns: int) -> bool:
    """Whether tyres can have done it, where neither receiver nor wheels tell a speed."""
    if estimate.wheels_fresh or estimate.speeds_told:
        return False
    over_s = _over_s(estimate, accepted_ns)
    gained_mps = 2.0 * off_m / over_s
    if gained_mps > estimate.tuning.acceleration_max_mps2 * over_s:
        return False
    estimate.filter.inflate_acceleration(gained_mps, over_s)
    return True


def _over_s(estimate: Estimate, since_ns: int) -> float:
    return max((estimate.t_ns - since_ns) * 1e-9, SHORTEST_S)
