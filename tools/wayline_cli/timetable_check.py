"""What a GTFS feed holds, what was mended, what cannot be used: `wayline timetable check`."""

import datetime as dt
from collections.abc import Iterable
from pathlib import Path

from rich.console import Console
from rich.table import Table

from wayline.errors import InputError
from wayline.timetable.model import Timetable
from wayline.timetable.notes import Note, Notes
from wayline.timetable.reading import read_timetable
from wayline.timetable.trip_route import PatternRoutes, note_times
from wayline.timetable.versions import last_day


def check_timetable(path: Path, today: dt.date, console: Console) -> None:
    """Print a feed's contents and its faults. Raises InputError where nothing can be used."""
    timetable = read_timetable(path)
    notes = Notes(timetable.notes)
    lengths_m = list(_patterns_tried(timetable, notes))
    if not lengths_m:
        raise InputError(str(path), "no pattern has a line", "correct stops.txt or shapes.txt")
    _note_calendar(timetable, today, notes)
    console.print(_contents(timetable, lengths_m))
    console.print(_faults(notes.all()))


def _patterns_tried(timetable: Timetable, notes: Notes) -> Iterable[float]:
    """The length of every pattern that has a line; all timings looked at on the way."""
    timings: dict[int, dict[int, str]] = {}
    for trip in timetable.trips:
        timings.setdefault(trip.pattern, {}).setdefault(trip.timing, trip.trip_id)
    for place, pattern in enumerate(timetable.patterns):
        try:
            routes = PatternRoutes(timetable, pattern, notes)
        except InputError as error:
            notes.add("unusable", "patterns", error.what, pattern.pattern_id)
            continue
        for timing, trip_id in timings.get(place, {}).items():
            note_times(routes, timetable.timings[timing], trip_id, notes)
        yield routes.line.length_m


def _note_calendar(timetable: Timetable, today: dt.date, notes: Notes) -> None:
    last = last_day(timetable)
    if last < today.toordinal():
        ended = dt.date.fromordinal(last) if last else "never began"
        notes.add("marked", "calendar.txt", "no service runs any longer", f"ended {ended}")


def _contents(timetable: Timetable, lengths_m: list[float]) -> Table:
    table = Table(title=timetable.source, show_header=False)
    table.add_column(style="bold")
    table.add_column(justify="right")
    days = [service for service in timetable.services if service.ends]
    if days:
        first, last = min(each.begins for each in days), max(each.ends for each in days)
        valid = f"{dt.date.fromordinal(first)} to {dt.date.fromordinal(last)}"
        table.add_row("service days", valid)
    table.add_row("time zone", timetable.timezone)
    for name in ("agencies", "routes", "stops", "shapes", "services", "patterns", "trips"):
        table.add_row(name, f"{len(getattr(timetable, name)):,}")
    blocks = {trip.block_id for trip in timetable.trips if trip.block_id}
    table.add_row("blocks", f"{len(blocks):,}")
    table.add_row("repeated trips", f"{len(timetable.frequencies):,}")
    table.add_row("longest pattern", f"{max(lengths_m) / 1000.0:,.1f} km")
    return table


def _faults(notes: Iterable[Note]) -> Table:
    table = Table(title="Faults")
    for heading in ("is", "file", "what", "where"):
        table.add_column(heading, overflow="fold")
    table.add_column("times", justify="right")
    for note in notes:
        where = ", ".join(note.places)
        table.add_row(note.kind, note.file, note.fault, where, f"{note.count:,}")
    if not table.row_count:
        table.add_row("-", "-", "none found", "", "0")
    return table
