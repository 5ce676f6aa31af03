"""Pure: when a vehicle reaches the stops ahead, from planned speeds and dwells.

The spread grows with the time to go. Papers/000, table 3, gives the standard deviation of the
error over a lap of 219 s: 27 s at its start, 10 s, 7 s and 4 s on the way, 1.1 s near the end.
A second at least and 12 % of the time to go fits that, position error comes on top.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.messages import StopArrival
from wayline.route import Route
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.stands import MOVING, Stand
from wayline_eta.stop_visits import BOARDING_S, next_visits_m

Floats = NDArray[np.float64]

SPREAD_FLOOR_S = 1.0
SPREAD_SHARE = 0.12
UNTOLD_STD_S = 12.0
"""Of what a vehicle stands at a stop, and before lights, where no dwell is planned."""
UNDER_WAY_M = 30.0
"""A vehicle so far behind a stop has left it."""
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
    """A stop that is still to come: which, how far ahead, and when the vehicle is there."""

    stop: int
    distance_m: float
    arrival_ns: int
    early_ns: int
    late_ns: int
    departure_ns: int


def predict_arrivals(route: Route, outlook: Outlook, now_ns: int) -> tuple[StopArrival, ...]:
    """The next arrival at every stop still to come, soonest first, each stop once.

    What an outlook older than `now_ns` puts into the past is due now.
    """
    stops = route.stops
    return tuple(
        StopArrival(
            stop_id=stops[stop].stop_id,
            name=stops[stop].name,
            distance_m=distance_m,
            arrival_ns=arrival_ns,
            early_ns=early_ns,
            late_ns=late_ns,
            confidence="planned",
        )
        for stop, distance_m, arrival_ns, early_ns, late_ns, _ in predict_visits(
            route, outlook, now_ns
        )
    )


def predict_visits(
    route: Route, outlook: Outlook, now_ns: int, motion: ExpectedMotion | None = None
) -> list[Visit]:
    """The next visit of every stop still to come, soonest first, each stop once.

    With the motion of a trip its vehicle leaves no stop before its time, and reaches the one that
    it is under way to before the dwell that the running time there holds. What an outlook older
    than `now_ns` puts into the past is due now.
    """
    if not route.stops:
        return []
    order, visits_m = _ahead(route, outlook.served_m)
    arrivals_s, departures_s = _seconds_to(route, outlook, visits_m, order, motion)
    stds_s = _spread_s(route, outlook, arrivals_s)
    if motion is not None and motion.is_untold:
        stds_s = np.hypot(stds_s, UNTOLD_STD_S * np.sqrt(1.0 + np.arange(len(order))))
    spreads_s, stand = NORMAL_P90 * stds_s, outlook.stand
    earlies_s, lates_s = arrivals_s - spreads_s, arrivals_s + spreads_s
    if stand is not MOVING:
        earlies_s = arrivals_s - np.hypot(spreads_s, stand.left_s - stand.early_s)
        lates_s = arrivals_s + np.hypot(spreads_s, stand.late_s - stand.left_s)
    distances_m = np.maximum(visits_m - outlook.total_m, 0.0)
    seconds = np.array((arrivals_s, earlies_s, lates_s, departures_s))
    instants_ns = _instants_ns(outlook, now_ns, seconds).tolist()
    found: dict[str, Visit] = {}
    for visit in map(Visit, order.tolist(), distances_m.tolist(), *instants_ns):
        found.setdefault(route.stops[visit.stop].stop_id, visit)
    return list(found.values())


def _ahead(route: Route, served_m: float) -> tuple[NDArray[np.intp], Floats]:
    """The stops still to come, soonest first, and where they are next reached."""
    places_m = route.stop_distances_m
    if not route.loop:
        first = int(np.searchsorted(places_m, served_m, side="right"))
        return np.arange(first, len(places_m)), places_m[first:]
    visits_m = next_visits_m(route, served_m)
    order = np.argsort(visits_m, kind="stable")
    return order, visits_m[order]


def _untold_dwell_s(motion: ExpectedMotion, outlook: Outlook, visit_m: float) -> float:
    """Of the running time to the next stop what the vehicle will stand there; 0 before it drives"""
    if outlook.stand.left_s > 0.0 or motion.stop_near(outlook.total_m, 0.0, UNDER_WAY_M):
        return 0.0
    return motion.untold_s(visit_m, outlook.total_m)


def _seconds_to(
    route: Route,
    outlook: Outlook,
    visits_m: Floats,
    stops: NDArray[np.intp],
    motion: ExpectedMotion | None,
) -> tuple[Floats, Floats]:
    """Until each visit and the departure after it: planned travel, dwells, waits for the time."""
    places_m = np.concatenate(([max(outlook.total_m, 0.0)], visits_m))
    travels_s = np.maximum(np.diff(route.time_at(places_m)), 0.0)
    dwells_s = route.stop_dwells_s[stops]
    if motion is None or not len(stops):
        departures_s = outlook.stand.left_s + np.cumsum(travels_s + dwells_s)
        return departures_s - dwells_s, departures_s
    earliest_s = (motion.stop_leaves_ns[stops] - outlook.t_ns) * 1e-9
    dwells_s = np.where(np.isfinite(earliest_s), np.minimum(dwells_s, BOARDING_S), dwells_s)
    at_s, departures_s = outlook.stand.left_s, np.empty(len(stops))
    steps = zip((travels_s + dwells_s).tolist(), earliest_s.tolist(), strict=True)
    for visit, (takes_s, leaves_s) in enumerate(steps):
        at_s = departures_s[visit] = max(at_s + takes_s, leaves_s)
    arrivals_s = np.concatenate(([outlook.stand.left_s], departures_s[:-1])) + travels_s
    arrivals_s[0] -= _untold_dwell_s(motion, outlook, float(visits_m[0]))
    return arrivals_s, departures_s


def _spread_s(route: Route, outlook: Outlook, seconds: Floats) -> Floats:
    """One sigma of the time to go."""
    within_m = outlook.total_m % route.length_m if route.loop else outlook.total_m
    place_s = outlook.distance_std_m / max(route.speed_at(within_m), 1.0)
    return np.hypot(SPREAD_FLOOR_S + SPREAD_SHARE * seconds, place_s)


def _instants_ns(outlook: Outlook, now_ns: int, seconds: Floats) -> NDArray[np.int64]:
    """Instants so many seconds after an outlook's; not before now."""
    after_ns = np.floor(seconds * 1e9).astype(np.int64)
    return np.asarray(np.maximum(outlook.t_ns + after_ns, now_ns))
