"""Pure: when a vehicle reaches the stops ahead, from planned speeds and dwells.

The spread grows with the time to go. Papers/000, table 3, gives the standard deviation of the
error over a lap of 219 s: 27 s at its start, 10 s, 7 s and 4 s on the way, 1.1 s near the end.
A second at least and 12 % of the time to go fits that, position error comes on top.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.messages import StopArrival
from wayline.route import Route
from wayline_eta.stop_visits import next_visits_m

Floats = NDArray[np.float64]

SPREAD_FLOOR_S = 1.0
SPREAD_SHARE = 0.12
NORMAL_P90 = 1.281_551_6
"""The 90 % quantile of the standard normal distribution."""


class Outlook(NamedTuple):
    """What is known of a vehicle when its arrivals are predicted."""

    t_ns: int
    total_m: float
    """Along the route, over all laps."""
    served_m: float
    """Stops up to here have been arrived at."""
    distance_std_m: float
    dwell_left_s: float


def predict_arrivals(route: Route, outlook: Outlook, now_ns: int) -> tuple[StopArrival, ...]:
    """The next arrival at every stop still to come, soonest first, each stop once.

    What an outlook older than `now_ns` puts into the past is due now.
    """
    if not route.stops:
        return ()
    visits_m = next_visits_m(route, outlook.served_m)
    order = np.argsort(visits_m, kind="stable")
    order = order[np.isfinite(visits_m[order])]
    seconds = _seconds_to(route, outlook, visits_m[order], order)
    spreads = NORMAL_P90 * _spread_s(route, outlook, seconds)
    arrivals: dict[str, StopArrival] = {}
    for index, visit_m, to_go_s, spread_s in zip(
        order, visits_m[order], seconds, spreads, strict=True
    ):
        stop = route.stops[index]
        arrival = StopArrival(
            stop_id=stop.stop_id,
            name=stop.name,
            distance_m=max(float(visit_m) - outlook.total_m, 0.0),
            arrival_ns=_instant(outlook, now_ns, to_go_s),
            early_ns=_instant(outlook, now_ns, to_go_s - spread_s),
            late_ns=_instant(outlook, now_ns, to_go_s + spread_s),
        )
        arrivals.setdefault(stop.stop_id, arrival)
    return tuple(arrivals.values())


def _seconds_to(
    route: Route, outlook: Outlook, visits_m: Floats, order: NDArray[np.intp]
) -> Floats:
    """Planned travel to each visit, and the dwells of the stops before it."""
    start_s = route.time_at(np.array([max(outlook.total_m, 0.0)]))[0]
    travel_s = np.maximum(route.time_at(visits_m) - start_s, 0.0)
    dwells_s = np.concatenate(([0.0], np.cumsum(route.stop_dwells_s[order])))[:-1]
    return np.asarray(travel_s + dwells_s + outlook.dwell_left_s)


def _spread_s(route: Route, outlook: Outlook, seconds: Floats) -> Floats:
    """One sigma of the time to go."""
    within_m = outlook.total_m % route.length_m if route.loop else outlook.total_m
    place_s = outlook.distance_std_m / max(route.speed_at(within_m), 1.0)
    return np.hypot(SPREAD_FLOOR_S + SPREAD_SHARE * seconds, place_s)


def _instant(outlook: Outlook, now_ns: int, seconds: float) -> int:
    return max(outlook.t_ns + math.floor(float(seconds) * 1e9), now_ns)
