"""Pure: how long a vehicle that stands will go on standing.

At a stop for the rest of its dwell, or until its time. Beyond that, and between stops, a stand has
no usual length: what has lasted for some time goes on for a share of it (the lifetimes of a Pareto
distribution). A queue at a light is over soon, a breakdown of ten minutes is not. Where dwells have
been seen, the longer one lasts the less likely is it one of them.
"""

import math
from typing import NamedTuple

TAIL = 1.5
"""Exponent: of the stands that have lasted for some time a third (0.35) lasts twice as long.

Stands of a minute and more on everyday drives have 1.1 to 1.4, by few of them (Hill 1975). Whoever
asks at some instant of any one stand is asked of an exponent of 1: after a share of it that may be
any (Gott 1993). At 2 ranges held 61 % of a stand, at 1.5 they hold 70 %.
"""

HELD_UP = 0.02
"""So many stands at a stop are none of its dwells: something holds the vehicle up."""
BISECTIONS, TINY_S = 30, 1e-3


class Stand(NamedTuple):
    """Seconds that a vehicle will still stand: 10 %, 50 % and 90 % quantiles."""

    early_s: float = 0.0
    left_s: float = 0.0
    late_s: float = 0.0

    def at_least(self, seconds: float) -> "Stand":
        """Not shorter than so long."""
        return Stand(*(max(each, seconds) for each in self))


MOVING = Stand()


def goes_on(overdue_s: float) -> Stand:
    """A stand that has lasted so long beyond what was planned."""
    return Stand(*(overdue_s * _share(quantile) for quantile in (0.1, 0.5, 0.9)))


def _share(quantile: float) -> float:
    return float((1.0 - quantile) ** (-1.0 / TAIL) - 1.0)


def rest_of_dwell(stood_s: float, mean_s: float, variance_s2: float) -> Stand:
    """A stand that has lasted so long at a stop with such dwells.

    They are distributed as a logarithmic normal; a few stands among them have a heavy tail.
    """
    if mean_s <= 0.0:
        return goes_on(stood_s)
    log_s2 = math.log1p(variance_s2 / mean_s**2)
    middle, log_s = math.log(mean_s) - 0.5 * log_s2, math.sqrt(2.0 * log_s2)

    def lasts(seconds: float) -> float:
        """The share of stands that last longer."""
        dwells = 0.5 * math.erfc((math.log(max(seconds, TINY_S)) - middle) / max(log_s, TINY_S))
        return (1.0 - HELD_UP) * dwells + HELD_UP * math.pow(1.0 + seconds / mean_s, -TAIL)

    def left_s(share: float) -> float:
        """Until when that share of those is left which last as long as this has."""
        wanted, low_s, high_s = share * lasts(stood_s), stood_s, 10.0 * (mean_s + stood_s)
        for _ in range(BISECTIONS):
            middle_s = 0.5 * (low_s + high_s)
            low_s, high_s = (middle_s, high_s) if lasts(middle_s) > wanted else (low_s, middle_s)
        return high_s - stood_s

    return Stand(left_s(0.9), left_s(0.5), left_s(0.1))
