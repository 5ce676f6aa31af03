"""Trips of a feed with what they share: patterns (stops and line) and timings."""

from collections import Counter
from typing import NamedTuple

import polars as pl

from wayline.timetable.calendar import Service
from wayline.timetable.feed_calendar import every_day
from wayline.timetable.model import Pattern, Shape, TimetableStop, Timing, Trip
from wayline.timetable.notes import Notes
from wayline.timetable.stop_times import TripRows, rows_by_trip
from wayline.timetable.tables import ROW, FeedFiles

FILE = "trips.txt"
PatternKey = tuple[str, int | None, int | None, bytes]


class FeedTrips(NamedTuple):
    """The trips that can be used, and what they name."""

    patterns: tuple[Pattern, ...]
    timings: tuple[Timing, ...]
    trips: tuple[Trip, ...]


class TripRow(NamedTuple):
    """A row of trips.txt."""

    trip_id: str
    route_id: str
    direction_id: int | None
    shape: int | None
    service: int
    block_id: str | None
    headsign: str


def trips_of(
    files: FeedFiles,
    stops: tuple[TimetableStop, ...],
    shapes: tuple[Shape, ...],
    services: list[Service],
    notes: Notes,
) -> FeedTrips:
    """The trips; services that they name and nobody describes are added, running every day."""
    rows = _trip_rows(files.table("trips"), shapes, services, notes)
    stop_ids = [stop.stop_id for stop in stops]
    gathering = _Gathering(rows)
    by_trip = rows_by_trip(
        files.table("stop_times"), [row.trip_id for row in rows], stop_ids, notes
    )
    short = 0
    for of_trip in by_trip:
        if len(of_trip.stops) > 1:
            gathering.add(of_trip)
        else:
            short += 1
            notes.add("unusable", FILE, "a trip with one stop", rows[of_trip.trip].trip_id)
    if idle := len(rows) - short - len(gathering.trips):
        notes.add("unusable", FILE, "trips without a row of stop_times.txt", count=idle)
    return gathering.found()


class _Gathering:
    """Finds what trips share."""

    def __init__(self, rows: list[TripRow]) -> None:
        self._rows = rows
        self._patterns: dict[PatternKey, int] = {}
        self._sequences: list[tuple[TripRow, TripRows]] = []
        self._timings: dict[bytes, int] = {}
        self._timed: list[Timing] = []
        self.trips: list[Trip] = []

    def add(self, rows: TripRows) -> None:
        """Take the rows of one trip."""
        row = self._rows[rows.trip]
        key = (row.route_id, row.direction_id, row.shape, rows.stops.tobytes())
        pattern = self._patterns.setdefault(key, len(self._patterns))
        if pattern == len(self._sequences):
            self._sequences.append((row, rows))
        self.trips.append(
            Trip(
                row.trip_id,
                pattern,
                self._timing(rows),
                row.service,
                rows.starts_s,
                row.block_id,
                row.headsign,
            )
        )

    def _timing(self, rows: TripRows) -> int:
        timing = self._timings.setdefault(rows.times.tobytes(), len(self._timings))
        if timing == len(self._timed):
            arrivals_s, departures_s, points = rows.times.T.tolist()
            self._timed.append(
                Timing(tuple(arrivals_s), tuple(departures_s), tuple(map(bool, points)))
            )
        return timing

    def found(self) -> FeedTrips:
        """All of it; patterns get names of their own, the most used one the plain name."""
        used = Counter(trip.pattern for trip in self.trips)
        names: dict[int, str] = {}
        taken: Counter[str] = Counter()
        for pattern, _ in used.most_common():
            row, _ = self._sequences[pattern]
            direction = "" if row.direction_id is None else str(row.direction_id)
            plain = "-".join(filter(None, (row.route_id, direction)))
            taken[plain] += 1
            names[pattern] = plain if taken[plain] == 1 else f"{plain}-{taken[plain]}"
        patterns = [
            Pattern(
                names[place],
                row.route_id,
                row.direction_id,
                row.shape,
                tuple(rows.stops.tolist()),
                tuple(rows.sequences.tolist()),
            )
            for place, (row, rows) in enumerate(self._sequences)
        ]
        return FeedTrips(tuple(patterns), tuple(self._timed), tuple(self.trips))


def _trip_rows(
    frame: pl.DataFrame, shapes: tuple[Shape, ...], services: list[Service], notes: Notes
) -> list[TripRow]:
    """Each trip_id once."""
    of_shapes = {shape.shape_id: place for place, shape in enumerate(shapes)}
    of_services = {service.service_id: place for place, service in enumerate(services)}
    found: dict[str, TripRow] = {}
    again: list[int] = []
    for row in frame.iter_rows(named=True):
        trip_id, service_id = row["trip_id"], row.get("service_id", "")
        if trip_id in found:
            again.append(row[ROW])
            continue
        if service_id not in of_services:
            of_services[service_id] = len(services)
            services.append(every_day(service_id))
            fault = "names a service_id without days: taken as every day"
            notes.add("marked", FILE, fault, service_id or f"row {row[ROW]}")
        shape_id = row.get("shape_id", "")
        if shape_id and shape_id not in of_shapes:
            fault = "names a shape_id without a line in shapes.txt: from stop to stop"
            notes.add_rows("mended", FILE, fault, [row[ROW]])
        found[trip_id] = TripRow(
            trip_id,
            row["route_id"],
            _direction(row.get("direction_id", "")),
            of_shapes.get(shape_id),
            of_services[service_id],
            row.get("block_id") or None,
            row.get("trip_headsign", ""),
        )
    notes.add_rows("mended", FILE, "trip_id is there twice: the first counts", again)
    return list(found.values())


def _direction(text: str) -> int | None:
    return int(text) if text in {"0", "1"} else None
