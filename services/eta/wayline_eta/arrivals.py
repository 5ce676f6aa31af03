"""Pure: when a vehicle reaches the stops ahead: the times of legs and dwells, added up.

The times are means and variances of logarithmic normal distributions; their sum is taken to be
such a one too (Fenton 1960). What is told is the mean, which is the plan's where nobody has driven
yet. The legs of one run are slow or quick together.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.messages import StopArrival
from wayline.route import Route
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.experience import Expected
from wayline_eta.lessons import Forecasting
from wayline_eta.stands import MOVING, Stand
from wayline_eta.stop_visits import BOARDING_S, next_visits_m

Floats = NDArray[np.float64]

FLOOR_S = 1.0
RUN_STD = 0.08
"""Of the logarithm of a whole run's time, beside its legs' own."""
SHORT_S = 1.0
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
    """A stop that is still to come: which, where, and seconds until the vehicle is there."""

    stop: int
    distance_m: float
    arrival_s: float
    early_s: float
    late_s: float
    departure_s: float
    early_width_s: float
    """From the model's own p10 to its p50, before forecasts that came have scaled it."""
    late_width_s: float
    """From its p50 to its p90."""
    is_learned: bool
    """Somebody has driven the leg there."""


def predict_arrivals(by: Forecasting, outlook: Outlook, now_ns: int) -> tuple[StopArrival, ...]:
    """The next arrival at every stop still to come, soonest first, each stop once.

    What an outlook older than `now_ns` puts into the past is due now.
    """
    return told_arrivals(by.legs.route, outlook, predict_visits(by, outlook), now_ns)


def predict_visits(
    by: Forecasting,
    outlook: Outlook,
    leaves_ns: Floats | None = None,
    motion: ExpectedMotion | None = None,
) -> list[Visit]:
    """The next visit of every stop still to come, soonest first, each stop once.

    `leaves_ns`, one a stop, is when the vehicle leaves it at the earliest. With its motion the stop
    that it is under way to is reached before the dwell that the running time there holds.
    """
    route = by.legs.route
    if not route.stops:
        return []
    visits_m = next_visits_m(route, outlook.served_m)
    order = np.argsort(visits_m, kind="stable")
    order = order[np.isfinite(visits_m[order])]
    stand = by.stand(outlook)
    sums = Sums(stand.left_s, (_place_s(route, outlook)) ** 2)
    found: dict[str, Visit] = {}
    for position, stop in enumerate(order.tolist()):
        visit_m = float(visits_m[stop])
        untold_s = 0.0
        if position == 0:
            sums = sums.with_travel(by.rest(stop, outlook.total_m, visit_m, outlook.t_ns))
            if motion is not None and not by.is_driven(stop):
                untold_s = _untold_dwell_s(motion, outlook, visit_m)
        else:
            sums = sums.with_travel(by.travel(stop, outlook.t_ns, sums.seconds))
        if motion is not None and motion.is_untold:
            sums = sums._replace(variance_s2=sums.variance_s2 + UNTOLD_STD_S**2)
        arrival_s = sums.seconds - untold_s
        earlier_s, later_s = sums.widths_s(stand)
        scale = by.ranges.scale(arrival_s)
        leaves_s = -math.inf if leaves_ns is None else (leaves_ns[stop] - outlook.t_ns) * 1e-9
        sums = sums.with_dwell(_dwell(by, stop, leaves_s), leaves_s)
        visit = Visit(
            stop,
            max(visit_m - outlook.total_m, 0.0),
            arrival_s,
            arrival_s - scale.early * earlier_s,
            arrival_s + scale.late * later_s,
            sums.seconds,
            earlier_s,
            later_s,
            by.is_driven(stop),
        )
        found.setdefault(route.stops[stop].stop_id, visit)
    return list(found.values())


class Sums(NamedTuple):
    """Of the times on the way to a stop: means and variances."""

    seconds: float
    variance_s2: float
    travel_s: float = 0.0

    def with_travel(self, travel: Expected) -> "Sums":
        """At the end of a leg."""
        return Sums(
            self.seconds + travel.seconds,
            self.variance_s2 + travel.variance_s2,
            self.travel_s + travel.seconds,
        )

    def with_dwell(self, dwell: Expected, leaves_s: float) -> "Sums":
        """At the departure, for which a vehicle that is early waits; waits make up for delays."""
        ready_s, variance_s2 = self.seconds + dwell.seconds, self.variance_s2 + dwell.variance_s2
        if leaves_s <= ready_s:
            return Sums(ready_s, variance_s2, self.travel_s)
        spare = (leaves_s - ready_s) / math.sqrt(variance_s2 + FLOOR_S)
        return Sums(leaves_s, variance_s2 / (1.0 + spare) ** 2, 0.0)

    def widths_s(self, stand: Stand) -> tuple[float, float]:
        """How far p10 is below what is told, and p90 above it."""
        variance_s2 = self.variance_s2 + (RUN_STD * self.travel_s) ** 2
        seconds = max(self.seconds, SHORT_S)
        square = (math.sqrt(variance_s2) + FLOOR_S) ** 2 / seconds**2
        factor = math.exp(NORMAL_P90 * math.sqrt(math.log1p(square)))
        return (
            math.hypot(seconds - seconds / factor, stand.left_s - stand.early_s),
            math.hypot(seconds * factor - seconds, stand.late_s - stand.left_s),
        )


def _dwell(by: Forecasting, stop: int, leaves_s: float) -> Expected:
    """Where vehicles wait for their time, what was seen is mostly that; late ones board."""
    planned_s = float(by.legs.route.stop_dwells_s[stop])
    if math.isfinite(leaves_s):
        return Expected(min(planned_s, BOARDING_S), 0.0)
    return by.experience.dwell(by.legs.keys[stop], planned_s)


def told_arrivals(
    route: Route, outlook: Outlook, visits: Sequence[Visit], now_ns: int
) -> tuple[StopArrival, ...]:
    """Visits as instants."""
    return tuple(told_arrival(route, outlook, visit, now_ns) for visit in visits)


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
        confidence="learned" if visit.is_learned else "planned",
    )


def _untold_dwell_s(motion: ExpectedMotion, outlook: Outlook, visit_m: float) -> float:
    """Of the running time to the next stop what the vehicle will stand there; 0 before it drives"""
    if outlook.stand.left_s > 0.0 or motion.stop_near(outlook.total_m, 0.0, UNDER_WAY_M):
        return 0.0
    return motion.untold_s(visit_m, outlook.total_m)


def _place_s(route: Route, outlook: Outlook) -> float:
    """What a place along the route is unsure by, in time."""
    within_m = outlook.total_m % route.length_m if route.loop else outlook.total_m
    return outlook.distance_std_m / max(route.speed_at(within_m), 1.0)


def instant_ns(outlook: Outlook, now_ns: int, seconds: float) -> int:
    """An instant so many seconds after an outlook's; not before now."""
    return max(outlook.t_ns + math.floor(float(seconds) * 1e9), now_ns)
