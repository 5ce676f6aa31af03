"""Makes routes of a GTFS feed: of one trip, or one a pattern."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from wayline.errors import InputError
from wayline.geo import step_between
from wayline.line import Line
from wayline.route import CLOSED_WITHIN_M, Route
from wayline.timetable.model import Timetable, Trip
from wayline.timetable.notes import Notes
from wayline.timetable.reading import read_timetable
from wayline.timetable.trip_route import PatternRoutes, note_times

CLOSES_WITHIN_M = 50.0
"""A circular trip's shape may end so far from where it began; what is missing is driven straight"""


def only_trip(timetable: Timetable) -> str:
    """The trip of a feed that has one. Raises InputError where it has several."""
    trips = [trip.trip_id for trip in timetable.trips]
    if len(trips) == 1:
        return trips[0]
    shown = ", ".join(trips[:3])
    mend = f"name one of its trips.txt with --trip, e.g. {shown}, or a folder with --out"
    raise InputError(timetable.source, f"is a GTFS feed of {len(trips):,} trips", mend)


def route_from_gtfs(path: Path, trip_id: str) -> Route:
    """The route that a trip drives, its planned speeds from the trip's timetable.

    A vertex is put at each stop, so that the planned time between two stops is the timetable's;
    waits are the stops' `dwell_s`. The route's id is the feed's with the trip's direction, where it
    has one (`5A-1`). A trip without a shape goes straight from stop to stop. Raises InputError for
    a trip that the feed does not have, or of which nothing can be used.
    """
    timetable = read_timetable(path)
    return route_of_trip(timetable, trip_id, Notes())


def route_of_trip(timetable: Timetable, trip_id: str, notes: Notes) -> Route:
    """A trip's route; what was mended of it is noted. Raises InputError."""
    trip = next((each for each in timetable.trips if each.trip_id == trip_id), None)
    if trip is None:
        raise _no_trip(timetable, trip_id)
    routes = PatternRoutes(timetable, timetable.patterns[trip.pattern], notes)
    note_times(routes, timetable.timings[trip.timing], trip.trip_id, notes)
    return closed(routes.of_trip(trip).route)


def closed(route: Route) -> Route:
    """A loop where a trip ends at the stop where it began, as circular lines do; else as it is."""
    first, last = route.stops[0], route.stops[-1]
    ends = [route.line.point_at(along_m)[:2] for along_m in (route.length_m, 0.0)]
    gap_m = step_between(*ends[0], *ends[1]).distance_m
    if first.stop_id != last.stop_id or len(route.stops) < 3 or gap_m > CLOSES_WITHIN_M:
        return route
    vertices = list(zip(route.line.lats_deg.tolist(), route.line.lons_deg.tolist(), strict=True))
    speeds_mps = route.speeds_mps.tolist()
    if gap_m > CLOSED_WITHIN_M:
        vertices.append(vertices[0])
        speeds_mps.append(speeds_mps[-1])
    vertices[-1] = vertices[0]
    return Route(
        route_id=route.route_id,
        name=route.name,
        loop=True,
        line=Line(*np.array(vertices).T),
        speeds_mps=np.array(speeds_mps),
        stops=[first._replace(dwell_s=max(first.dwell_s, last.dwell_s)), *route.stops[1:-1]],
    )


def _no_trip(timetable: Timetable, trip_id: str) -> InputError:
    for note in timetable.notes:
        if note.kind == "unusable" and trip_id in note.places:
            return InputError(
                f"{timetable.source} trip {trip_id}", f"is {note.fault}", "name another trip"
            )
    where = f"{timetable.source} trips.txt"
    return InputError(where, f"no trip_id {trip_id}", "name one that it has")


def routes_of_patterns(timetable: Timetable, notes: Notes) -> Iterator[Route]:
    """A route a pattern, at the speeds of the trip in the middle of its timetable.

    A pattern without a line is noted and left out.
    """
    trips: dict[int, list[Trip]] = {}
    for trip in timetable.trips:
        trips.setdefault(trip.pattern, []).append(trip)
    for place, pattern in enumerate(timetable.patterns):
        of_pattern = sorted(trips[place], key=lambda trip: trip.starts_s)
        middle = of_pattern[len(of_pattern) // 2]
        try:
            routes = PatternRoutes(timetable, pattern, notes)
            note_times(routes, timetable.timings[middle.timing], middle.trip_id, notes)
            yield closed(routes.of_trip(middle).route)
        except InputError as error:
            notes.add("unusable", "patterns", error.what, pattern.pattern_id)
