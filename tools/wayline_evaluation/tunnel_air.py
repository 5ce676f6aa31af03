"""Pure: the pressure that a vehicle pushes before it into a tunnel, as the yardstick is told."""

import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_simulator.barometer import TUNNEL_FADE_S, TUNNEL_MPS, BarometerModel
from wayline_simulator.course import Surroundings
from wayline_simulator.happenings import Happenings


def piston_pa(
    times_s: Floats, speeds_mps: Floats, happened: Happenings, model: BarometerModel
) -> Floats:
    """At a barometer's instants (Unix), shape (n,): up at entrances, down at exits, both fading."""
    felt_pa = np.zeros(len(times_s))
    before = Surroundings.OPEN
    for time_s, kind in happened.surroundings:
        sign = int(kind == Surroundings.TUNNEL) - int(before == Surroundings.TUNNEL)
        before = Surroundings(kind)
        # the first sample past the portal feels the whole of it
        row = int(np.searchsorted(times_s, time_s))
        if sign and row < len(times_s):
            step_pa = sign * model.tunnel_pa * (speeds_mps[row] / TUNNEL_MPS) ** 2
            felt_pa[row:] += step_pa * np.exp(-(times_s[row:] - times_s[row]) / TUNNEL_FADE_S)
    return felt_pa
