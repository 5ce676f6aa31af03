"""Pure: the stops of a pattern placed along its line, also where they do not fit it.

A stop that lies far from the line is put at its nearest place in order; two neighbours in the
wrong order change places; a line that most stops do not fit, or that runs the other way, is given
up for straight ones from stop to stop.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.errors import InputError
from wayline.line import Line
from wayline.stops import STOP_REACH_M, StopPlace, nearest_in_order
from wayline.timetable.model import Pattern, Timetable
from wayline.timetable.notes import Notes

Floats = NDArray[np.float64]
STOPS, SHAPES = "stops.txt", "shapes.txt"


class PlacedPattern(NamedTuple):
    """Where the stops of a pattern lie along its line."""

    line: Line
    rows: tuple[int, ...]
    """The pattern's rows in the order in which they are driven."""
    stops: tuple[StopPlace, ...]
    """One a row, in that order."""
    alongs_m: Floats
    """Shape (rows,), never falling."""


def place_pattern(timetable: Timetable, pattern: Pattern, notes: Notes) -> PlacedPattern:
    """The pattern on its line; what does not fit is noted.

    Raises InputError where no line can be made: all its stops are one place, or a continent apart.
    """
    stops = [_stop_place(timetable, stop) for stop in pattern.stops]
    if pattern.shape is not None:
        shape = timetable.shapes[pattern.shape]
        placed = _on_line(pattern, _line(np.array(shape.lats_deg), np.array(shape.lons_deg)), stops)
        if placed is not None and _fits(placed):
            _note_misfits(pattern, placed, notes)
            return placed
        fault = "a shape that its stops do not fit: from stop to stop instead"
        notes.add("mended", SHAPES, fault, f"{shape.shape_id} of pattern {pattern.pattern_id}")
    return _from_stop_to_stop(timetable, pattern, stops)


def _stop_place(timetable: Timetable, stop: int) -> StopPlace:
    place = timetable.stops[stop]
    return StopPlace(place.stop_id, place.name, place.lat_deg, place.lon_deg)


def _line(lats_deg: Floats, lons_deg: Floats) -> Line | None:
    """A line without its repeated points; None where that leaves one."""
    moves = Line(lats_deg, lons_deg).legs_m > 0.0
    kept = np.concatenate(([True], moves))
    return Line(lats_deg[kept], lons_deg[kept]) if moves.any() else None


def _on_line(
    pattern: Pattern, line: Line | None, stops: Sequence[StopPlace]
) -> PlacedPattern | None:
    if line is None:
        return None
    rows = tuple(range(len(pattern.stops)))
    alongs_m = nearest_in_order(line, stops)
    placed = PlacedPattern(line, rows, tuple(stops), alongs_m)
    offsets_m = offsets_of(placed)
    for first in np.flatnonzero(offsets_m[:-1] + offsets_m[1:] > STOP_REACH_M).tolist():
        swapped = _swapped(placed, first)
        better_m = offsets_of(placed).sum() - offsets_of(swapped).sum()
        if better_m > STOP_REACH_M:
            placed = swapped
    return placed


def _swapped(placed: PlacedPattern, first: int) -> PlacedPattern:
    """With two neighbours exchanged."""
    order = list(range(len(placed.rows)))
    order[first : first + 2] = [first + 1, first]
    stops = tuple(placed.stops[each] for each in order)
    rows = tuple(placed.rows[each] for each in order)
    return PlacedPattern(placed.line, rows, stops, nearest_in_order(placed.line, stops))


def offsets_of(placed: PlacedPattern) -> Floats:
    """How far each stop lies from its place on the line, shape (rows,)."""
    points = np.array([placed.line.point_at(float(along_m))[:2] for along_m in placed.alongs_m])
    apart = [
        Line(np.array([stop.lat_deg, lat_deg]), np.array([stop.lon_deg, lon_deg])).length_m
        for stop, (lat_deg, lon_deg) in zip(placed.stops, points, strict=True)
    ]
    return np.array(apart)


def _fits(placed: PlacedPattern) -> bool:
    """Whether most stops lie at the line, and not all at one end of it."""
    near = int(np.count_nonzero(offsets_of(placed) <= STOP_REACH_M))
    return 2 * near > len(placed.rows) and float(np.ptp(placed.alongs_m)) > 0.0


def _note_misfits(pattern: Pattern, placed: PlacedPattern, notes: Notes) -> None:
    for row, expected in zip(placed.rows, range(len(placed.rows)), strict=True):
        if row > expected:
            stop, other = placed.stops[expected : expected + 2]
            fault = "two neighbouring stops in the wrong order: exchanged"
            where = f"{other.stop_id}, {stop.stop_id} of pattern {pattern.pattern_id}"
            notes.add("mended", "stop_times.txt", fault, where)
    for stop, offset_m in zip(placed.stops, offsets_of(placed), strict=True):
        if offset_m > STOP_REACH_M:
            fault = "a stop far from its shape: put at its nearest place"
            where = f"{stop.stop_id}, {offset_m:.0f} m off pattern {pattern.pattern_id}"
            notes.add("marked", STOPS, fault, where)


def _from_stop_to_stop(
    timetable: Timetable, pattern: Pattern, stops: Sequence[StopPlace]
) -> PlacedPattern:
    where = f"{timetable.source} pattern {pattern.pattern_id}"
    lats_deg = np.array([stop.lat_deg for stop in stops])
    lons_deg = np.array([stop.lon_deg for stop in stops])
    line = _line(lats_deg, lons_deg)
    if line is None:
        raise InputError(where, "all its stops are one place", "correct stops.txt")
    alongs_m = Line(lats_deg, lons_deg).distances_m
    return PlacedPattern(line, tuple(range(len(stops))), tuple(stops), alongs_m)
