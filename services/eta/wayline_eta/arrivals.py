"""Pure: when a vehicle reaches the stops ahead: the times of legs and dwells, added up.

The times are means and variances of logarithmic normal distributions; their sum is taken to be
such a one too (Fenton 1960). What is told is the mean, which is the plan's where nobody has driven
yet. The legs of one run are slow or quick together.
"""

import itertools
import math
from collections.abc import Iterable
from statistics import NormalDist
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.messages import StopArrival
from wayline.route import Route
from wayline_eta.experience import Expected
from wayline_eta.leg_under_way import rest_of_leg
from wayline_eta.lessons import Expectations
from wayline_eta.ranges import MINUTES, SPANS
from wayline_eta.stands import MOVING, Stand
from wayline_eta.stop_visits import next_visits_m

Floats = NDArray[np.float64]

FLOOR_S = 1.0
SHORT_S = 1.0
UNSEEN_STD = 0.2
"""Of the time to the first stop of a route, in shares of it."""
UNTOLD_STD_S = 12.0
"""Of what a vehicle stands at a stop, and before lights, where no dwell is planned."""
NORMAL = NormalDist()
ENDS_MIN = np.array(MINUTES)
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
    drives: bool = False
    """It is seen to, all the time."""
    slower: float = 1.0
    """What the rest of its leg takes over what is usual, by its own pace."""
    gone_s: float | None = None
    """Since it left the stop before the next one; None where that was not seen, or is not asked."""


class Visit(msgspec.Struct, frozen=True):
    """A stop that is still to come: which, where, and when the vehicle is there."""

    stop: int
    distance_m: float
    is_learned: bool
    """Somebody has driven the whole way there."""
    arrival_ns: int
    early_ns: int
    late_ns: int
    departure_ns: int
    early_width_ns: int
    """From the model's own p10 to what is told, before forecasts that came have scaled it."""
    late_width_ns: int
    """From there to its p90."""


class Ahead(NamedTuple):
    """Seconds until each visit and the departure after it, with the arrival's variance."""

    arrivals_s: Floats
    departures_s: Floats
    variances_s2: Floats


def told_arrivals(route: Route, visits: list[Visit]) -> tuple[StopArrival, ...]:
    """Visits as they are told of a route that no timetable has."""
    ahead = [(visit, route.stops[visit.stop]) for visit in visits]
    return tuple(
        [
            StopArrival(
                stop_id=stop.stop_id,
                name=stop.name,
                distance_m=visit.distance_m,
                arrival_ns=visit.arrival_ns,
                early_ns=visit.early_ns,
                late_ns=visit.late_ns,
                confidence="learned" if visit.is_learned else "planned",
            )
            for visit, stop in ahead
        ]
    )


def predict_visits(by: Expectations, outlook: Outlook, now_ns: int) -> list[Visit]:
    """The next visit of every stop still to come, soonest first, each stop once.

    The vehicle of a timetable's trip leaves no stop before its time. What an outlook older than
    `now_ns` puts into the past is due now.
    """
    route = by.legs.route
    if not route.stops:
        return []
    order, visits_m = _stops_ahead(route, outlook.served_m)
    if not len(order):
        return []
    ahead = _times(by, outlook, order, visits_m)
    earlier_s, later_s = _widths_s(ahead, outlook.stand)
    is_learned = np.logical_and.accumulate(by.is_driven[order])
    span = ENDS_MIN.searchsorted(ahead.arrivals_s / 60.0, side="right") + SPANS * is_learned
    seconds = np.array(
        (
            ahead.arrivals_s,
            ahead.arrivals_s - by.early_scales[span] * earlier_s,
            ahead.arrivals_s + by.late_scales[span] * later_s,
            ahead.departures_s,
            earlier_s,
            later_s,
        )
    )
    after_ns = np.floor(seconds * 1e9).astype(np.int64)
    rows = zip(
        order.tolist(),
        np.maximum(visits_m - outlook.total_m, 0.0).tolist(),
        is_learned.tolist(),
        *np.maximum(after_ns[:-2] + outlook.t_ns, now_ns).tolist(),
        *after_ns[-2:].tolist(),
        strict=True,
    )
    visits = list(itertools.starmap(Visit, rows))
    return visits if route.has_each_stop_once else _once_each(route, visits)


def _once_each(route: Route, visits: Iterable[Visit]) -> list[Visit]:
    """The first visit of every stop."""
    found: dict[str, Visit] = {}
    for visit in visits:
        found.setdefault(route.stops[visit.stop].stop_id, visit)
    return list(found.values())


def _stops_ahead(route: Route, served_m: float) -> tuple[NDArray[np.intp], Floats]:
    """The stops still to come, soonest first, and where they are next reached."""
    places_m = route.stop_distances_m
    if not route.loop:
        first = int(places_m.searchsorted(served_m, side="right"))
        return np.arange(first, len(places_m)), places_m[first:]
    visits_m = next_visits_m(route, served_m)
    order = np.argsort(visits_m, kind="stable")
    return order, visits_m[order]


def _times(by: Expectations, outlook: Outlook, order: NDArray[np.intp], visits_m: Floats) -> Ahead:
    """What is left of the leg under way, then dwells and legs; departures wait for their time."""
    travels_s, travels_s2 = by.travel_s[order], by.travel_s2[order]
    travels_s[0], travels_s2[0] = _rest(by, outlook, int(order[0]), float(visits_m[0]))
    dwells_s, dwells_s2 = by.dwell_s[order], by.dwell_s2[order]
    commons_s = by.run_std[order] * travels_s
    begins_s, begins_s2 = outlook.stand.left_s, _place_s(by.legs.route, outlook) ** 2
    if by.legs.motion is None:
        departures_s = begins_s + (travels_s + dwells_s).cumsum()
        arrivals_s = departures_s - dwells_s
        variances_s2 = begins_s2 + (travels_s2 + dwells_s2).cumsum() - dwells_s2
        return Ahead(arrivals_s, departures_s, variances_s2 + commons_s.cumsum() ** 2)
    if by.legs.motion.is_untold:
        travels_s2 = travels_s2 + np.where(by.is_driven[order], 0.0, UNTOLD_STD_S**2)
    earliest_s = (by.legs.leaves_ns[order] - outlook.t_ns) * 1e-9
    leaves = earliest_s + by.late_s[order], by.late_s2[order]
    travels = travels_s, travels_s2, commons_s
    return _waiting((begins_s, begins_s2), travels, (dwells_s, dwells_s2), leaves)


def _waiting(
    begins: tuple[float, float],
    travels: tuple[Floats, Floats, Floats],
    dwells: tuple[Floats, Floats],
    leaves: tuple[Floats, Floats],
) -> Ahead:
    """Means and variances added up; a vehicle that is early waits, which makes up for delays.

    The third of the travels is the std of what they have in common with the others.
    """
    (at_s, at_s2), common_s = begins, 0.0
    rows = zip(*(each.tolist() for each in (*travels, *dwells, *leaves)), strict=True)
    arrivals_s, departures_s, variances_s2 = [], [], []
    for travel_s, travel_s2, travel_common_s, dwell_s, dwell_s2, leaves_s, leaves_s2 in rows:
        at_s, at_s2, common_s = at_s + travel_s, at_s2 + travel_s2, common_s + travel_common_s
        arrivals_s.append(at_s)
        variances_s2.append(at_s2 + common_s**2)
        at_s, at_s2 = at_s + dwell_s, at_s2 + dwell_s2
        if math.isfinite(leaves_s):
            late_s = at_s, at_s2 + common_s**2
            at_s, at_s2, late = later_of(late_s, (leaves_s, leaves_s2))
            common_s *= late
            at_s2 = max(at_s2 - common_s**2, 0.0)
        departures_s.append(at_s)
    return Ahead(np.array(arrivals_s), np.array(departures_s), np.array(variances_s2))


def later_of(first: tuple[float, float], second: tuple[float, float]) -> tuple[float, float, float]:
    """Mean and variance of the later of two normal instants, and that it is the first.

    Clark 1961, equations 2 to 4, without correlation.
    """
    (first_s, first_s2), (second_s, second_s2) = first, second
    apart_s = math.sqrt(first_s2 + second_s2 + FLOOR_S**2)
    off = (first_s - second_s) / apart_s
    share, density = NORMAL.cdf(off), NORMAL.pdf(off)
    mean_s = first_s * share + second_s * (1.0 - share) + apart_s * density
    square_s2 = (first_s**2 + first_s2) * share + (second_s**2 + second_s2) * (1.0 - share)
    square_s2 += (first_s + second_s) * apart_s * density
    return mean_s, max(square_s2 - mean_s**2, 0.0), share


def next_stop(by: Expectations, outlook: Outlook) -> int | None:
    """The stop that is visited next; None behind the last one."""
    order, _ = _stops_ahead(by.legs.route, outlook.served_m)
    return int(order[0]) if len(order) else None


def usual_s(by: Expectations, outlook: Outlook, from_m: float) -> float:
    """What the way from a place to where the vehicle is usually takes, on the leg that it is on."""
    order, _ = _stops_ahead(by.legs.route, outlook.served_m)
    if not len(order) or outlook.total_m <= from_m:
        return 0.0
    planned_s = by.legs.driven_s(from_m, outlook.total_m)
    whole_s = float(by.planned_s[order[0]])
    return planned_s * (
        float(by.travel_s[order[0]]) / whole_s if whole_s > 0.0 else by.first_factor
    )


def _rest(by: Expectations, outlook: Outlook, stop: int, visit_m: float) -> tuple[float, float]:
    """Of the leg under way, by what of its planned time is still to go, how it began, its pace."""
    planned_s = by.legs.driven_s(max(outlook.total_m, 0.0), visit_m)
    whole_s = float(by.planned_s[stop])
    if whole_s <= 0.0:
        to_first_s = by.first_factor * planned_s
        return to_first_s, (UNSEEN_STD * to_first_s) ** 2
    share = min(planned_s / whole_s, 1.0)
    whole = Expected(float(by.travel_s[stop]), float(by.travel_s2[stop]))
    rest = rest_of_leg(whole, 1.0 - share, outlook.gone_s)
    return outlook.slower * rest.seconds, outlook.slower**2 * rest.variance_s2


def _widths_s(ahead: Ahead, stand: Stand) -> tuple[Floats, Floats]:
    """How far p10 is below what is told, and p90 above it."""
    seconds = np.maximum(ahead.arrivals_s, SHORT_S)
    square = ((np.sqrt(ahead.variances_s2) + FLOOR_S) / seconds) ** 2
    factor = np.exp(NORMAL_P90 * np.sqrt(np.log1p(square)))
    earlier_s, later_s = seconds - seconds / factor, seconds * factor - seconds
    if stand is MOVING:
        return earlier_s, later_s
    return (
        np.hypot(earlier_s, stand.left_s - stand.early_s),
        np.hypot(later_s, stand.late_s - stand.left_s),
    )


def _place_s(route: Route, outlook: Outlook) -> float:
    """What a place along the route is unsure by, in time."""
    within_m = outlook.total_m % route.length_m if route.loop else outlook.total_m
    return outlook.distance_std_m / max(route.speed_at(within_m), 1.0)
