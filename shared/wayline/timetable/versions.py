"""Pure: which feeds are versions of one timetable, from when the newer one counts, and the end.

Agencies publish the next timetable while the present one still runs, and the days of both overlap.
Versions have stops in common, under the same ids at the same places.
"""

import datetime as dt
from collections.abc import Sequence

from wayline.geo import step_between
from wayline.timetable.model import Timetable

NEVER = dt.date.max.toordinal()
SAME_PLACE_M = 500.0
"""A stop that was moved by less is the same."""
SAME_SHARE = 0.5
"""Of the stops of the smaller feed."""


def first_day(timetable: Timetable) -> int:
    """The ordinal of the first day on which any service may run."""
    return min((service.begins for service in timetable.services), default=NEVER)


def last_day(timetable: Timetable) -> int:
    """The ordinal of the last day on which any service may run; 0 where there is none."""
    return max((service.ends for service in timetable.services), default=0)


def superseded_days(timetables: Sequence[Timetable]) -> list[int]:
    """Of each feed the day from which a newer version counts in its place; else NEVER.

    The one whose days begin later is the newer; of equals the one that is named later.
    """
    begins = [first_day(each) for each in timetables]
    return [
        min(
            (
                begins[other]
                for other, newer in enumerate(timetables)
                if (begins[other], other) > (begins[at], at) and _are_versions(each, newer)
            ),
            default=NEVER,
        )
        for at, each in enumerate(timetables)
    ]


def families(timetables: Sequence[Timetable]) -> list[int]:
    """Of each feed a number that its versions have too: the first of theirs."""
    found: list[int] = []
    for at, each in enumerate(timetables):
        others = (other for other in range(at) if _are_versions(timetables[other], each))
        first = next(others, None)
        found.append(at if first is None else found[first])
    return found


def _are_versions(one: Timetable, other: Timetable) -> bool:
    smaller, larger = sorted((one, other), key=lambda each: len(each.stops))
    places = {stop.stop_id: stop for stop in larger.stops}
    same = 0
    for stop in smaller.stops:
        there = places.get(stop.stop_id)
        if there is not None:
            step = step_between(stop.lat_deg, stop.lon_deg, there.lat_deg, there.lon_deg)
            same += step.distance_m <= SAME_PLACE_M
    return same >= SAME_SHARE * len(smaller.stops)


def ended_line(timetables: Sequence[Timetable], today: dt.date) -> str | None:
    """Says which feeds run no service any longer; None where all do or will."""
    ended = [
        f"{each.source} (last day {dt.date.fromordinal(last) if (last := last_day(each)) else '-'})"
        for each in timetables
        if last_day(each) < today.toordinal()
    ]
    if not ended:
        return None
    return f"no service runs any longer by {', '.join(ended)}: name a newer feed"
