"""Pure: what speaks against a vehicle being where a candidate is, by where it was seen.

Costs are negative logarithms of likelihoods.
"""

import math

from wayline.matching.network import Candidate, Sight

LINE_STD_M = 6.0
"""How far the drawn line may lie from the lane."""
HEADING_STD_DEG = 30.0
"""How far a vehicle's heading may lie from the line's, in bends and lane changes."""
STEADY_HEADING_STD_DEG = 45.0
"""A course less sure than this tells nothing."""
OUTLIER = 3.0
"""In sigmas: beyond it a misfit counts in proportion, no longer squared (Huber)."""
CORRELATION_S = 10.0
"""Errors of position last about so long: sights nearer in time are not new evidence."""


def turn_deg(sight: Sight, candidate: Candidate) -> float:
    """Between the vehicle's course and the edge's, 0 to 180; 0 where the former is not known."""
    if sight.course_deg is None or sight.course_std_deg > STEADY_HEADING_STD_DEG:
        return 0.0
    return abs((candidate.heading_deg - sight.course_deg + 180.0) % 360.0 - 180.0)


def news(last: Sight | None, sight: Sight) -> float:
    """How much a sight tells that the last one did not, 0 to 1.

    All after some seconds; or the share of variance that has gone, as a fix takes away what dead
    reckoning did not know.
    """
    if last is None:
        return 1.0
    elapsed = (sight.t_ns - last.t_ns) * 1e-9 / CORRELATION_S
    shrunk = 1.0 - (sight.std_m**2 + LINE_STD_M**2) / (last.std_m**2 + LINE_STD_M**2)
    return min(max(elapsed, shrunk), 1.0)


class Emission:
    """Of one sight, given the one before."""

    def __init__(self, last: Sight | None, sight: Sight) -> None:
        self._sight = sight
        self._news = news(last, sight)
        self._std_m = math.hypot(sight.std_m, LINE_STD_M)
        self._course_std_deg = math.hypot(sight.course_std_deg, HEADING_STD_DEG)
        self._is_old_course = last is not None and sight.stands

    def cost(self, candidate: Candidate) -> float:
        """Misfit of offset and course, weighed by how much of them is new evidence."""
        misfit = _huber(abs(candidate.offset_m) / self._std_m)
        if not self._is_old_course:
            misfit += _huber(turn_deg(self._sight, candidate) / self._course_std_deg)
        return self._news * misfit


def _huber(sigmas: float) -> float:
    """Negative log likelihood of a misfit in sigmas, forgiving to outliers."""
    squared = min(sigmas, OUTLIER)
    return squared * (sigmas - 0.5 * squared)
