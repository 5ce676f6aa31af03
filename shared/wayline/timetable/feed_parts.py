"""Agencies, routes, stops, shapes and frequencies of a feed."""

from collections.abc import Mapping, Sequence

import polars as pl

from wayline.timetable.clock_times import seconds_of_clock
from wayline.timetable.model import (
    Agency,
    Frequency,
    Pattern,
    Shape,
    TimetableRoute,
    TimetableStop,
    Trip,
)
from wayline.timetable.notes import Notes
from wayline.timetable.tables import ROW

NOWHERE_DEG = 0.01
"""Nearer than this to 0 N 0 E is no place, but two numbers that nobody filled in."""


def agencies_of(frame: pl.DataFrame) -> tuple[Agency, ...]:
    """The agencies; the only one of a feed may have no id."""
    return tuple(
        Agency(row.get("agency_id", ""), row.get("agency_name", ""), row["agency_timezone"])
        for row in frame.iter_rows(named=True)
    )


def routes_of(
    frame: pl.DataFrame, patterns: Sequence[Pattern], notes: Notes
) -> tuple[TimetableRoute, ...]:
    """The routes, with those that patterns name and the table lacks."""
    routes = {
        row["route_id"]: TimetableRoute(
            row["route_id"],
            row.get("agency_id", ""),
            row.get("route_short_name", ""),
            row.get("route_long_name", ""),
        )
        for row in frame.iter_rows(named=True)
    }
    for pattern in patterns:
        if pattern.route_id not in routes:
            notes.add("mended", "routes.txt", "lacks a route_id of trips.txt", pattern.route_id)
            routes[pattern.route_id] = TimetableRoute(pattern.route_id, "", pattern.route_id, "")
    return tuple(routes.values())


def stops_of(frame: pl.DataFrame, notes: Notes) -> tuple[TimetableStop, ...]:
    """The stops that have a place, their own or their station's; the first of equal ids counts."""
    rows = {row["stop_id"]: row for row in reversed(frame.rows(named=True))}
    if again := len(frame) - len(rows):
        notes.add("mended", "stops.txt", "stop_id is there twice: the first counts", count=again)
    stops: list[TimetableStop] = []
    misplaced: list[int] = []
    for stop_id, row in reversed(rows.items()):
        place = _place(row) or _place(rows.get(row.get("parent_station", ""), {}))
        if place is None:
            misplaced.append(row[ROW])
        else:
            stops.append(TimetableStop(stop_id, row.get("stop_name") or stop_id, *place))
    notes.add_rows("unusable", "stops.txt", "stop_lat and stop_lon are no place", misplaced)
    return tuple(stops)


def _place(row: Mapping[str, str]) -> tuple[float, float] | None:
    return place_of(row.get("stop_lat", ""), row.get("stop_lon", ""))


def place_of(lat: str, lon: str) -> tuple[float, float] | None:
    """Degrees of two texts; None where they are no place on Earth."""
    try:
        lat_deg, lon_deg = float(lat), float(lon)
    except ValueError:
        return None
    on_earth = abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0
    nowhere = max(abs(lat_deg), abs(lon_deg)) < NOWHERE_DEG
    return (lat_deg, lon_deg) if on_earth and not nowhere else None


def shapes_of(frame: pl.DataFrame, notes: Notes) -> tuple[Shape, ...]:
    """The shapes of two points or more, their points in order."""
    if "shape_pt_sequence" not in frame.columns:
        frame = frame.with_columns(pl.col(ROW).cast(pl.String).alias("shape_pt_sequence"))
    points = frame.select(
        ROW,
        "shape_id",
        pl.col("shape_pt_lat").cast(pl.Float64, strict=False).alias("lat"),
        pl.col("shape_pt_lon").cast(pl.Float64, strict=False).alias("lon"),
        pl.col("shape_pt_sequence").cast(pl.Float64, strict=False).alias("at"),
    )
    on_earth = (pl.col("lat").abs() <= 90.0) & (pl.col("lon").abs() <= 180.0)
    nowhere = pl.max_horizontal(pl.col("lat").abs(), pl.col("lon").abs()) < NOWHERE_DEG
    good = (on_earth & ~nowhere).fill_null(value=False)
    wrong = points.filter(~good)[ROW].to_list()
    notes.add_rows("mended", "shapes.txt", "a point is no place: left out", wrong)
    ordered = points.filter(good).sort("shape_id", "at", maintain_order=True)
    shapes = []
    for (shape_id,), part in ordered.group_by("shape_id", maintain_order=True):
        if len(part) > 1:
            shapes.append(Shape(str(shape_id), tuple(part["lat"]), tuple(part["lon"])))
        else:
            notes.add("unusable", "shapes.txt", "a shape of one point", str(shape_id))
    return tuple(shapes)


def frequencies_of(
    frame: pl.DataFrame, trips: Sequence[Trip], notes: Notes
) -> tuple[Frequency, ...]:
    """The repeated trips; rows that name no trip or no times are left out and noted."""
    places = {trip.trip_id: place for place, trip in enumerate(trips)}
    found: list[Frequency] = []
    wrong: list[int] = []
    for row in frame.iter_rows(named=True):
        start_s, end_s = seconds_of_clock(row["start_time"]), seconds_of_clock(row["end_time"])
        headway, trip = row["headway_secs"], places.get(row["trip_id"])
        if trip is None or start_s is None or end_s is None or not headway.isdecimal():
            wrong.append(row[ROW])
        elif int(headway) > 0:
            exact = row.get("exact_times") == "1"
            found.append(Frequency(trip, start_s, end_s, int(headway), exact))
    notes.add_rows("unusable", "frequencies.txt", "names no trip, time or headway", wrong)
    return tuple(found)
