"""Pure: how long a vehicle that stands will go on standing.

At a stop for the rest of its dwell, or until its time. Beyond that, and between stops, a stand has
no usual length: what has lasted for some time goes on for a share of it (the lifetimes of a Pareto
distribution). A queue at a light is over soon, a breakdown of ten minutes is not.
"""

from typing import NamedTuple

TAIL = 2.0
"""Exponent: of the stands that have lasted for some time a quarter lasts twice as long."""


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
