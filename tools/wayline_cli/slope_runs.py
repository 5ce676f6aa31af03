"""Lists and withdraws the runs of a slope database (SPEC section 4)."""

import csv
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

import sqlalchemy as sa

from wayline.database import open_database
from wayline.rfc3339 import rfc3339
from wayline_slope_map.ledger import listed_runs
from wayline_slope_map.left_out_rows import every
from wayline_slope_map.withdrawal import withdraw

COLUMNS = ("run", "vehicle_id", "road_id", "direction", "start", "end", "state")
LEFT_OUT_COLUMNS = (
    "vehicle_id",
    "start",
    "end",
    "length_m",
    "sensor",
    "reason",
    "start_lat_deg",
    "start_lon_deg",
    "end_lat_deg",
    "end_lon_deg",
)


def list_runs(database_url: str, stdout: TextIO) -> None:
    """Write a CSV of every run. Raises InputError for a database that is not there."""
    writer = csv.writer(stdout, lineterminator="\n")
    writer.writerow(COLUMNS)
    with _opened(database_url) as engine:
        for run in listed_runs(engine):
            times = rfc3339(run.start_ns), rfc3339(run.end_ns)
            writer.writerow((*run[:4], *times, run.state))


def list_left_out(database_url: str, stdout: TextIO) -> None:
    """Write a CSV of what was left out of all drives. Raises InputError as `list_runs`."""
    writer = csv.writer(stdout, lineterminator="\n")
    writer.writerow(LEFT_OUT_COLUMNS)
    with _opened(database_url) as engine, engine.connect() as connection:
        for part in every(connection):
            times = rfc3339(part.start_ns), rfc3339(part.end_ns)
            what = f"{part.length_m:.0f}", part.sensor or "", part.reason
            places = part.start_lat_deg, part.start_lon_deg, part.end_lat_deg, part.end_lon_deg
            shown = ("" if each is None else f"{each:.6f}" for each in places)
            writer.writerow((part.vehicle_id, *times, *what, *shown))


def withdraw_run(database_url: str, name: str) -> str:
    """What was withdrawn, for people. Raises InputError."""
    with _opened(database_url) as engine:
        run = withdraw(engine, name)
    return f"{name}: {run.vehicle_id} on {run.road_id} at {rfc3339(run.start_ns)} withdrawn"


@contextmanager
def _opened(database_url: str) -> Iterator[sa.Engine]:
    engine = open_database(database_url, "wayline_slope_map", create=False)
    try:
        yield engine
    finally:
        engine.dispose()
