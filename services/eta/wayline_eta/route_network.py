"""Pure: a route, or a trip's pattern, as a network of one edge that is driven one way."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wayline.geo import step_between
from wayline.matching.candidates import locally_nearest
from wayline.matching.network import Candidate, First, Sight
from wayline.route import Route

Floats = NDArray[np.float64]

EARLIEST_COST = 0.1
"""Lost by the end of the route against its start, so that a tie is a vehicle that sets out."""
ENDS_COST = 12.0
"""Lost by a first place at the end of a circular trip: who is seen there first sets out."""
ENDS_M = 60.0
"""So near to the end, of a trip that begins as near to it."""
BEFORE_START_M = 10.0
"""A first place this near to the end of a loop is a vehicle about to start its first lap."""


class RouteNetwork:
    """The line of a route; on a loop every way goes round."""

    def __init__(self, route: Route) -> None:
        self._route = route

    def near(self, sight: Sight) -> Sequence[Candidate]:
        """Each passage of the line near a place, whatever the course; never none."""
        found = locally_nearest(self._route.line, sight.lat_deg, sight.lon_deg)
        return [Candidate(self._route.route_id, 1, *each) for each in found]

    def first(self, candidates: Sequence[Candidate]) -> Sequence[First]:
        """Earlier places before later ones, and the start before an end where both are near."""
        length_m = self._route.length_m
        totals_m = [self._first_m(candidate.along_m) for candidate in candidates]
        near_both_ends = not self._route.loop and min(totals_m) < ENDS_M
        costs = [EARLIEST_COST * total_m / length_m for total_m in totals_m]
        if near_both_ends:
            costs = [
                cost + (ENDS_COST if total_m > length_m - ENDS_M else 0.0)
                for cost, total_m in zip(costs, totals_m, strict=True)
            ]
        return [First(*each) for each in zip(totals_m, costs, strict=True)]

    def _first_m(self, along_m: float) -> float:
        length_m = self._route.length_m
        is_before = self._route.loop and along_m > length_m - BEFORE_START_M
        return along_m - length_m if is_before else along_m

    def advance_m(self, earlier: Candidate, later: Candidate, about_m: float) -> float | None:
        """Along the line; on a loop by that many laps which come nearest to `about_m`."""
        surplus_m = later.along_m - earlier.along_m - about_m
        if self._route.loop:
            length_m = self._route.length_m
            surplus_m = (surplus_m + length_m / 2.0) % length_m - length_m / 2.0
        return about_m + surplus_m

    def advances_m(
        self, earlier: Sequence[Candidate], later: Sequence[Candidate], about_m: float
    ) -> Floats:
        """`advance_m` to each later place from each earlier one, shape (later, earlier)."""
        ends_m, begins_m = ([each.along_m for each in places] for places in (later, earlier))
        surplus_m = np.subtract.outer(ends_m, begins_m) - about_m
        if self._route.loop:
            length_m = self._route.length_m
            surplus_m = (surplus_m + length_m / 2.0) % length_m - length_m / 2.0
        return np.asarray(about_m + surplus_m)

    @cached_property
    def is_circular(self) -> bool:
        """Whether the route is open and ends where it begins."""
        if self._route.loop:
            return False
        ends = [self._route.line.point_at(at_m)[:2] for at_m in (0.0, self._route.length_m)]
        return step_between(*ends[0], *ends[1]).distance_m < ENDS_M

    @property
    def start(self) -> Candidate:
        """Where the line begins."""
        return Candidate(self._route.route_id, 1, 0.0, 0.0, float(self._route.line.headings_deg[0]))
