"""Pure: a direction that the filter does not expect and that a vehicle can have turned to."""

import math

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
    over_s = max((estimate.t_ns - since_ns) * 1e-9, SHORTEST_S)
    rate_radps = min(speed_mps / TIGHTEST_M, HARDEST_MPS2 / max(speed_mps, 0.1))
    if abs(off_rad) > rate_radps * over_s:
        return False
    estimate.filter.inflate_turn(min(abs(off_rad), math.pi), over_s)
    return True
