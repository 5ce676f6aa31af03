"""Reads a GTFS feed whole: forgiving, and noting what was mended, marked and left out."""

import zoneinfo
from collections import Counter
from pathlib import Path

from wayline.errors import InputError
from wayline.timetable.feed_calendar import services_of
from wayline.timetable.feed_parts import (
    agencies_of,
    frequencies_of,
    routes_of,
    shapes_of,
    stops_of,
)
from wayline.timetable.feed_trips import trips_of
from wayline.timetable.model import Agency, Timetable
from wayline.timetable.notes import Notes
from wayline.timetable.tables import FeedFiles

DEFAULT_ZONE = "UTC"


def read_timetable(path: Path, notes: Notes | None = None) -> Timetable:
    """A feed's timetable; what was mended is noted, in `notes` too where they are given.

    Raises InputError where nothing of it can be used.
    """
    notes = notes or Notes()
    return read_files(FeedFiles(path, notes), notes)


def read_files(files: FeedFiles, notes: Notes) -> Timetable:
    """The timetable of a feed whose files are open; `notes` are those of its opening."""
    agencies = agencies_of(files.table("agency"))
    stops = stops_of(files.table("stops"), notes)
    shapes = shapes_of(files.table("shapes"), notes)
    services = services_of(files.table("calendar"), files.table("calendar_dates"), notes)
    found = trips_of(files, stops, shapes, services, notes)
    if not found.trips:
        raise _nothing(files, notes)
    return Timetable(
        source=str(files.path),
        fingerprint=files.fingerprint(),
        agencies=agencies,
        routes=routes_of(files.table("routes"), found.patterns, notes),
        stops=stops,
        shapes=shapes,
        services=tuple(services),
        patterns=found.patterns,
        timings=found.timings,
        trips=found.trips,
        frequencies=frequencies_of(files.table("frequencies"), found.trips, notes),
        timezone=_timezone(agencies, notes),
        notes=notes.all(),
    )


def _nothing(files: FeedFiles, notes: Notes) -> InputError:
    worst = next((note for note in notes.all() if note.kind == "unusable"), None)
    what = f"holds no trip that can be used ({worst})" if worst else "holds no trip"
    return InputError(f"{files.path} trips.txt", what, "name a GTFS folder or zip file")


def _timezone(agencies: tuple[Agency, ...], notes: Notes) -> str:
    """One for the whole feed, as GTFS has it; the most used where a feed has several."""
    zones = Counter(agency.timezone for agency in agencies if agency.timezone)
    for zone, _ in zones.most_common():
        if zone in zoneinfo.available_timezones():
            if len(zones) > 1:
                notes.add("marked", "agency.txt", f"several time zones: {zone} is used")
            return zone
    notes.add("marked", "agency.txt", f"no agency_timezone that is known: {DEFAULT_ZONE} is used")
    return DEFAULT_ZONE
