"""Pure: the legs of a route from stop to stop, under names that other trips know them by.

A leg is named by the stops at its ends, so that lines that share it teach each other; a route that
is no timetable's has stop ids of its own, and its legs are named with the route. A timetable's
running times may hold dwells: they are told apart as following does (`expected_motion`).
"""

import itertools
from typing import NamedTuple

import numpy as np

from wayline.route import Route
from wayline_eta.expected_motion import ExpectedMotion

SHORTEST_S = 1.0
"""Two stops may be at one place."""


class Leg(NamedTuple):
    """From one stop of a route to the next, as planned."""

    key: str
    """The same for every trip over it."""
    planned_s: float
    """Without any dwell."""


class Legs:
    """The legs of a route between its stops, leg i from stop i on; a loop's last goes to the first.

    `scope` names whose stop ids these are; `motion` is that of a timetable's trip.
    """

    def __init__(self, route: Route, scope: str, motion: ExpectedMotion | None = None) -> None:
        self.route, self.motion = route, motion
        self.leaves_ns = (
            np.full(len(route.stops), -np.inf) if motion is None else motion.stop_leaves_ns
        )
        """When a vehicle leaves each stop at the earliest; at most without such a time."""
        self.dwells_s = route.stop_dwells_s if motion is None else motion.stop_dwells_s
        """Planned, shape (stops,); where vehicles wait for their time, of those that are late."""
        self.keys = [f"{scope}|{stop.stop_id}" for stop in route.stops]
        """Of the stops, under which their dwells are known."""
        self.legs = self._between_stops(scope)

    def _between_stops(self, scope: str) -> list[Leg]:
        route = self.route
        ends = list(itertools.pairwise(range(len(route.stops))))
        if route.loop and len(route.stops) > 1:
            ends.append((len(route.stops) - 1, 0))
        found = []
        for first, last in ends:
            start_m, end_m = route.stop_distances_m[first], route.stop_distances_m[last]
            end_m += route.length_m if end_m <= start_m and route.loop else 0.0
            key = f"{scope}|{route.stops[first].stop_id}>{route.stops[last].stop_id}"
            found.append(Leg(key, max(self.driven_s(start_m, end_m), SHORTEST_S)))
        return found

    def driven_s(self, from_m: float, to_m: float) -> float:
        """Planned seconds from a distance along the route to another, without dwells."""
        time_at = self.route.time_at if self.motion is None else self.motion.driven_s
        ends_s = time_at(np.array([from_m, to_m]))
        return max(float(ends_s[1] - ends_s[0]), 0.0)

    def waits(self, stop: int) -> str:
        """Under what it is known how late vehicles leave a stop where they wait for their time."""
        return f"{self.keys[stop]}|waits"

    def to(self, stop: int) -> Leg | None:
        """The leg that ends at a stop; None of the first one of an open route."""
        if stop > 0:
            return self.legs[stop - 1]
        return self.legs[-1] if self.route.loop and self.legs else None
