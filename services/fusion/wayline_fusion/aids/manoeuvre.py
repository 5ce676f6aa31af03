"""Pure: a speed that the filter does not expect and tyres allow: the vehicle brakes, or spurts."""

import math

from wayline.likelihood import Measurement
from wayline_fusion.filter.estimate import Estimate

SHORTEST_S = 0.1
"""Wheel speeds may come faster, and from rest they begin with a jump."""
LONGEST_S = 3.0
LONGEST_INTERVALS = 1.5
"""After a silence longer than both nothing is known of the acceleration."""
NOISE_STDS = 3.0
"""Of the speed's own noise, besides what tyres can do."""


def allow_manoeuvre(
    estimate: Estimate, measurement: Measurement, t_ns: int, since_ns: int | None
) -> bool:
    """Whether tyres can make of the speed at `since_ns` this one, which fails the gate.

    Starts: a speed of wheels or of a fix fails the gate, and none was rejected just before. Goes
    on: never, the next speed is judged by what this one has made of the acceleration. Stops: what
    changes faster than tyres can is left rejected: wheels that locked or spin. Resets: nothing;
    the acceleration is doubted by as much as the speed is off.
    """
    if since_ns is None:
        return False
    over_s = max((t_ns - since_ns) * 1e-9, SHORTEST_S)
    gained_mps = abs(float(measurement.y[0]))
    noise_mps = NOISE_STDS * math.sqrt(float(measurement.R[0, 0]))
    most_mps = estimate.tuning.acceleration_max_mps2 * over_s + noise_mps
    longest_s = max(LONGEST_S, LONGEST_INTERVALS * estimate.situation.fix_interval_s)
    if over_s > longest_s or gained_mps > most_mps:
        return False
    estimate.filter.inflate_acceleration(gained_mps, over_s)
    return True
