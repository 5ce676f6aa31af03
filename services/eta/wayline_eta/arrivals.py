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
from wayline_eta.stands import MOVING, Stand
from wayline_eta.stop_visits import BOARDING_S, next_visits_m

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
    stand: Stand = MOVING


class Visit(NamedTuple):
    """A stop that is still to come: which, where, and seconds until the vehicle is there."""

    stop: int
    distance_m: float
    arrival_s: float
    early_s: float
    late_s: float
    departure_s: float


def predict_arrivals(route: Route, outlook: Outlook, now_ns: int) -> tuple[StopArrival, ...]:
    """The next arrival at every stop still to come, soonest first, each stop once.

    What an outlook older than `now_ns` puts into the past is due now.
    """
    return tuple(
        told_arrival(route, outlook, visit, now_ns) for visit in predict_visits(route, outlook)
    )


def predict_visits(route: Route, outlook: Outlook, leaves_ns: Floats | None = None) -> list[Visit]:
    """The next visit of every stop still to come, soonest first, each stop once.

    `leaves_ns`, one a stop, is when the vehicle leaves it at the earliest.
    """
    if not route.stops:
        return []
    visits_m = next_visits_m(route, outlook.served_m)
    order = np.argsort(visits_m, kind="stable")
    order = order[np.isfinite(visits_m[order])]
    if leaves_ns is None:
        leaves_ns = np.full(len(route.stops), -np.inf)
    earliest_s = (leaves_ns[order] - outlook.t_ns) * 1e-9
    dwells_s = route.stop_dwells_s[order]
    dwells_s = np.where(np.isfinite(earliest_s), np.minimum(dwells_s, BOARDING_S), dwells_s)
    arrivals_s, departures_s = _seconds_to(route, outlook, visits_m[order], dwells_s, earliest_s)
    spreads_s = NORMAL_P90 * _spread_s(route, outlook, arrivals_s)
    stand = outlook.stand
    earlies_s = arrivals_s - np.hypot(spreads_s, stand.left_s - stand.early_s)
    lates_s = arrivals_s + np.hypot(spreads_s, stand.late_s - stand.left_s)
    found: dict[str, Visit] = {}
    for at, stop in enumerate(order.tolist()):
        distance_m = max(float(visits_m[stop]) - outlook.total_m, 0.0)
        visit = Visit(
            stop,
            distance_m,
            float(arrivals_s[at]),
            float(earlies_s[at]),
            float(lates_s[at]),
            float(departures_s[at]),
        )
        found.setdefault(route.stops[stop].stop_id, visit)
    return list(found.values())


def told_arrival(route: Route, outlook: Outlook, visit: Visit, now_ns: int) -> StopArrival:
    """A visit as instants."""
    stop = route.stops[visit.stop]
    return StopArrival(
        stop_id=stop.stop_id,
        name=stop.name,
        distance_m=visit.distance_m,
        arrival_ns=instant_ns(outlook, now_ns, visit.arrival_s),
        early_ns=instant_ns(outlook, now_ns, visit.early_s),
        late_ns=instant_ns(outlook, now_ns, visit.late_s),
    )


def _seconds_to(
    route: Route, outlook: Outlook, visits_m: Floats, dwells_s: Floats, earliest_s: Floats
) -> tuple[Floats, Floats]:
    """Until each visit and the departure after it: travel, dwells, waits for the time."""
    places_m = np.concatenate(([max(outlook.total_m, 0.0)], visits_m))
    travels_s = np.maximum(np.diff(route.time_at(places_m)), 0.0)
    at_s = outlook.stand.left_s
    arrivals_s, departures_s = np.empty(len(visits_m)), np.empty(len(visits_m))
    steps = zip(travels_s.tolist(), dwells_s.tolist(), earliest_s.tolist(), strict=True)
    for visit, (travel_s, dwell_s, leaves_s) in enumerate(steps):
        arrivals_s[visit] = at_s + travel_s
        at_s = departures_s[visit] = max(at_s + travel_s + dwell_s, leaves_s)
    return arrivals_s, departures_s


def _spread_s(route: Route, outlook: Outlook, seconds: Floats) -> Floats:
    """One sigma of the time to go."""
    within_m = outlook.total_m % route.length_m if route.loop else outlook.total_m
    place_s = outlook.distance_std_m / max(route.speed_at(within_m), 1.0)
    return np.hypot(SPREAD_FLOOR_S + SPREAD_SHARE * seconds, place_s)


def instant_ns(outlook: Outlook, now_ns: int, seconds: float) -> int:
    """An instant so many seconds after an outlook's; not before now."""
    return max(outlook.t_ns + math.floor(float(seconds) * 1e9), now_ns)
