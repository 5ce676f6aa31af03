"""Pure: what speaks against a vehicle having come from one place to another, by how far it went.

Costs are negative logarithms of likelihoods.
"""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STANDING_M = 1.0
"""Who has come on by less between two sights stands."""
MOTION_SLACK_M = 5.0
MOTION_SLACK_SHARE = 0.1
"""Odometer and line disagree by so much, and by so much of the distance travelled."""
SELDOM_SLACK_M = 25.0
"""Between reports both ends are off, and the way is known by its straight line at best."""
UNLIKE_COST = 0.5
"""Lost by a place as far from where the vehicle was expected as that is away: tells ties apart."""
JUMP_COST = 12.0
"""On a route, the most that a place can lose by moving unlike the vehicle: a detour ends so."""


class Moves(NamedTuple):
    """How far a vehicle has come since it was last seen: anything from the least to the most."""

    least_m: float
    most_m: float
    slack_m: float
    likely_m: float
    unlike_cost: float = 0.0

    @classmethod
    def measured(cls, travelled_m: float) -> Self:
        """By its wheels, or poses that follow each other closely; negative in reverse."""
        slack_m = MOTION_SLACK_M + MOTION_SLACK_SHARE * abs(travelled_m)
        return cls(travelled_m, travelled_m, slack_m, travelled_m)

    @classmethod
    def between(cls, straight_m: float, expected_m: float) -> Self:
        """Where nobody knows the way: all between the straight one and the expected is as likely"""
        least_m, most_m = sorted((straight_m, expected_m))
        slack_m = SELDOM_SLACK_M + MOTION_SLACK_SHARE * most_m
        return cls(least_m, most_m, slack_m, expected_m, UNLIKE_COST)

    @property
    def middle_m(self) -> float:
        """Half way from the least to the most."""
        return (self.least_m + self.most_m) / 2.0

    def cost(self, advance_m: float | None, jump_cost: float = JUMP_COST) -> float:
        """Of having come so far along the network; None: by no way of it."""
        if advance_m is None:
            return jump_cost
        misfit = max(self.least_m - advance_m, advance_m - self.most_m, 0.0) / self.slack_m
        if misfit < 1.0 and (self.unlike_cost > 0.0 or abs(self.likely_m) < STANDING_M):
            misfit *= misfit  # of reports, and of a stand, small misfits are noise
        cost = misfit / (1.0 + misfit / jump_cost)
        if self.unlike_cost > 0.0:
            unlike_m = abs(advance_m - self.likely_m)
            cost += self.unlike_cost * unlike_m / (self.slack_m + self.most_m)
        return cost

    def costs(self, advances_m: Floats, jump_cost: float = JUMP_COST) -> Floats:
        """`cost` of many ways at once, of any shape."""
        short_m, far_m = self.least_m - advances_m, advances_m - self.most_m
        misfits = np.maximum(np.maximum(short_m, far_m), 0.0) / self.slack_m
        if self.unlike_cost > 0.0 or abs(self.likely_m) < STANDING_M:
            misfits = np.where(misfits < 1.0, misfits * misfits, misfits)
        costs = misfits / (1.0 + misfits / jump_cost)
        if self.unlike_cost > 0.0:
            unlike_m = np.abs(advances_m - self.likely_m)
            costs = costs + self.unlike_cost * unlike_m / (self.slack_m + self.most_m)
        return np.asarray(costs)
