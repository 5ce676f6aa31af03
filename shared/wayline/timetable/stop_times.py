"""Cleans the rows of stop_times.txt and puts them in order, a million at a time."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import polars as pl
from numpy.typing import NDArray

from wayline.timetable.clock_times import seconds_of_clock
from wayline.timetable.model import UNTIMED
from wayline.timetable.notes import Notes
from wayline.timetable.tables import ROW

Ints = NDArray[np.int32]
FILE = "stop_times.txt"
TRIP, STOP, SEQUENCE = "trip", "stop", "sequence"
ARRIVAL, DEPARTURE, TIMEPOINT = "arrival", "departure", "timepoint"
LATEST_S = 2**30
OPTIONAL = ("arrival_time", "departure_time", "stop_sequence", "timepoint")


class TripRows(NamedTuple):
    """The rows of one trip in order of travel."""

    trip: int
    """Row of trips.txt, counted from 0."""
    starts_s: int
    """The first time that the trip has; 0 where it has none."""
    stops: Ints
    """Shape (rows,)."""
    sequences: Ints
    """Shape (rows,)."""
    times: Ints
    """Arrivals and departures after the start, whether it is a timepoint: shape (rows, 3)."""


def rows_by_trip(
    frame: pl.DataFrame, trip_ids: list[str], stop_ids: list[str], notes: Notes
) -> Iterator[TripRows]:
    """The usable rows, trip after trip; times that are none are UNTIMED.

    Rows of unknown trips and stops, and rows that are there twice, are left out and noted.
    """
    rows = _ordered(_known(_complete(frame), trip_ids, stop_ids, notes), notes)
    trips, stops, sequences = (rows[name].to_numpy() for name in (TRIP, STOP, SEQUENCE))
    if not len(trips):
        return
    begins = np.concatenate(([0], np.flatnonzero(np.diff(trips)) + 1))
    ends = np.append(begins[1:], len(trips))
    times = np.ascontiguousarray(rows.select(ARRIVAL, DEPARTURE, TIMEPOINT).to_numpy())
    starts_s = _count_from_the_start(times, begins, ends)
    for begin, end, start_s in zip(begins.tolist(), ends.tolist(), starts_s, strict=True):
        part = slice(begin, end)
        yield TripRows(int(trips[begin]), start_s, stops[part], sequences[part], times[part])


def _count_from_the_start(times: Ints, begins: Ints, ends: Ints) -> list[int]:
    """Make times relative to the first one of their trip, and return those first ones."""
    clock = times[:, :2]
    timed = clock != UNTIMED
    earliest = np.where(timed, clock, LATEST_S).min(axis=1)
    firsts_s = np.where(timed[:, 0], clock[:, 0], earliest)
    row = np.where(timed.any(axis=1), np.arange(len(times)), len(times))
    first_rows = np.minimum.reduceat(row, begins)
    has_time = first_rows < ends
    starts_s = np.where(has_time, firsts_s[np.minimum(first_rows, len(times) - 1)], 0)
    clock[...] = np.where(timed, clock - np.repeat(starts_s, ends - begins)[:, None], UNTIMED)
    return list(starts_s.tolist())


def _complete(frame: pl.DataFrame) -> pl.DataFrame:
    missing = [name for name in OPTIONAL if name not in frame.columns]
    return frame.with_columns(pl.lit("").alias(name) for name in missing)


def _known(
    frame: pl.DataFrame, trip_ids: list[str], stop_ids: list[str], notes: Notes
) -> pl.DataFrame:
    """Codes for ids and seconds for times; without rows whose ids nobody knows."""
    rows = frame.select(
        ROW,
        _coded("trip_id", trip_ids).alias(TRIP),
        _coded("stop_id", stop_ids).alias(STOP),
        pl.col("stop_sequence")
        .cast(pl.Float64, strict=False)
        .cast(pl.Int32, strict=False)
        .alias(SEQUENCE),
        _seconds(frame, "arrival_time", notes).alias(ARRIVAL),
        _seconds(frame, "departure_time", notes).alias(DEPARTURE),
        pl.when(pl.col("timepoint") == "1").then(1).otherwise(0).cast(pl.Int32).alias(TIMEPOINT),
    )
    _note(rows, pl.col(TRIP).is_null(), "trip_id is not in trips.txt", notes)
    no_stop = pl.col(TRIP).is_not_null() & pl.col(STOP).is_null()
    _note(rows, no_stop, "stop_id has no place in stops.txt", notes)
    return rows.filter(pl.col(TRIP).is_not_null() & pl.col(STOP).is_not_null())


def _coded(column: str, ids: list[str]) -> pl.Expr:
    """Places of ids in a list, null for those that are not in it; ids there are distinct."""
    codes = pl.Series(range(len(ids)), dtype=pl.Int32)
    return pl.col(column).replace_strict(
        pl.Series(ids, dtype=pl.String), codes, default=None, return_dtype=pl.Int32
    )


def _seconds(frame: pl.DataFrame, column: str, notes: Notes) -> pl.Expr:
    """Times in seconds; each text is looked at once, as a day has few."""
    texts = frame[column].unique().to_list()
    seconds = {text: seconds_of_clock(text) for text in texts if text}
    wrong = [text for text, each in seconds.items() if each is None]
    if wrong:
        lines = frame.filter(pl.col(column).is_in(wrong))[ROW].to_list()
        notes.add_rows("mended", FILE, f"{column} is no time: taken as not given", lines)
    known = {text: each for text, each in seconds.items() if each is not None}
    return pl.col(column).replace_strict(
        pl.Series(list(known), dtype=pl.String),
        pl.Series(list(known.values()), dtype=pl.Int32),
        default=UNTIMED,
        return_dtype=pl.Int32,
    )


def _ordered(rows: pl.DataFrame, notes: Notes) -> pl.DataFrame:
    """By trip and sequence, each once; a trip that lacks sequences keeps its rows' order."""
    lacking = rows.filter(pl.col(SEQUENCE).is_null())
    if not lacking.is_empty():
        fault = "stop_sequence is not a whole number: taken in the order of the rows"
        notes.add_rows("mended", FILE, fault, lacking[ROW].to_list())
        by_row = pl.col(TRIP).is_in(lacking[TRIP].unique().to_list())
        renumbered = pl.int_range(pl.len(), dtype=pl.Int32).over(TRIP)
        rows = rows.with_columns(
            pl.when(by_row).then(renumbered).otherwise(pl.col(SEQUENCE)).alias(SEQUENCE)
        )
    if not _is_ordered(rows):
        rows = rows.sort(TRIP, SEQUENCE, maintain_order=True)
    again = _again(rows)
    if again.any():
        fault = "trip_id and stop_sequence are there twice: the first row counts"
        notes.add_rows("mended", FILE, fault, rows.filter(again)[ROW].to_list())
        rows = rows.filter(~again)
    return rows


def _is_ordered(rows: pl.DataFrame) -> bool:
    trips, sequences = rows[TRIP].to_numpy(), rows[SEQUENCE].to_numpy()
    steps = np.diff(trips)
    return bool(np.all((steps > 0) | ((steps == 0) & (np.diff(sequences) >= 0))))


def _again(rows: pl.DataFrame) -> pl.Series:
    trips, sequences = rows[TRIP].to_numpy(), rows[SEQUENCE].to_numpy()
    same = (np.diff(trips) == 0) & (np.diff(sequences) == 0)
    return pl.Series(np.concatenate(([False], same))[: len(trips)], dtype=pl.Boolean)


def _note(rows: pl.DataFrame, condition: pl.Expr, fault: str, notes: Notes) -> None:
    found = rows.filter(condition)[ROW].to_list()
    notes.add_rows("unusable", FILE, fault, found)
