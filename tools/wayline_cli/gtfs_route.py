"""Makes routes of a GTFS feed: of one trip, or one a pattern."""

from collections.abc import Iterator
from pathlib import Path

from wayline.errors import InputError
from wayline.route import Route
from wayline.timetable.model import Timetable, Trip
from wayline.timetable.notes import Notes
from wayline.timetable.reading import read_timetable
from wayline.timetable.trip_route import PatternRoutes, TripRoute, note_times


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
    return route_of_trip(timetable, trip_id, Notes()).route


def route_of_trip(timetable: Timetable, trip_id: str, notes: Notes) -> TripRoute:
    """A trip's route; what was mended of it is noted. Raises InputError."""
    trip = next((each for each in timetable.trips if each.trip_id == trip_id), None)
    if trip is None:
        raise _no_trip(timetable, trip_id)
    routes = PatternRoutes(timetable, timetable.patterns[trip.pattern], notes)
    note_times(routes, timetable.timings[trip.timing], trip.trip_id, notes)
    return routes.of_trip(trip)


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
            yield routes.of_trip(middle).route
        except InputError as error:
            notes.add("unusable", "patterns", error.what, pattern.pattern_id)
