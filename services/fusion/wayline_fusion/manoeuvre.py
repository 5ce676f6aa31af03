"""Pure: a speed that the filter does not expect and tyres allow: the vehicle brakes, or spurts."""

import math

from wayline_fusion.estimate import Estimate
from wayline_fusion.gate import nis_of, threshold
from wayline_fusion.measurements import Measurement

SHORTEST_S = 0.1
"""Wheel speeds may come faster, and from rest they begin with a jump."""
NOISE_STDS = 3.0
"""Of the speed's own noise, besides."""
LONGEST_S = 3.0
"""After a longer silence nothing is known of the acceleration."""


def expect_manoeuvre(
    estimate: Estimate, measurement: Measurement, t_ns: int, since_ns: int | None
) -> None:
    """Doubt the acceleration where that explains a speed unlike the one at `since_ns`.

    What changes faster than tyres can hold is left to the gate: wheels that locked or spin.
    """
    tuning = estimate.tuning
    nis = nis_of(measurement, estimate.filter.expected(measurement))
    if since_ns is None or nis <= threshold(1, tuning.gate_probability):
        return
    over_s = max((t_ns - since_ns) * 1e-9, SHORTEST_S)
    gained_mps = abs(float(measurement.y[0]))
    most_mps = tuning.acceleration_max_mps2 * over_s + NOISE_STDS * math.sqrt(measurement.R[0, 0])
    if over_s <= LONGEST_S and gained_mps <= most_mps:
        estimate.filter.manoeuvre(gained_mps, over_s)
