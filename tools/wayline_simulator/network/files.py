"""Writes a simulated network: its feed, and a drive folder for each bus and day."""

import datetime as dt
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple
from zoneinfo import ZoneInfo

import msgspec
import numpy as np

from wayline.errors import InputError
from wayline.timetable.calendar import SECOND_NS, instant_ns
from wayline_simulator.network.feed_text import feed_tables
from wayline_simulator.network.model import ZONE, NetworkModel
from wayline_simulator.network.simulation import VehicleDay, drive_days, make_network

FEED_NAME, REPORTS_NAME, TRUTH_NAME, VISITS_NAME = "feed", "reports.csv", "truth.csv", "visits.csv"
FACTS_NAME = "network.json"
DRIVE = """[drive]
vehicle_id = "bus-{vehicle}"
description = "A bus of a simulated network (seed {seed}, day {number})"

[[avl]]
path = "{reports}"

[avl.columns]
time = "time"
lat_deg = "lat"
lon_deg = "lon"
heading_deg = "heading"
speed_mps = "speed_mps"
{assignment}
[truth]
path = "{truth}"
"""


class DayFacts(msgspec.Struct, frozen=True, kw_only=True):
    """What a bus's day was made with, but its reports: it can be driven again."""

    seed: int
    hours: float
    headway_min: int
    start: dt.date
    vehicle: int
    """From 1."""
    number: int
    """Of the day, from 1."""

    @property
    def network(self) -> NetworkModel:
        """The network that it drove in."""
        return NetworkModel(
            seed=self.seed, hours=self.hours, headway_min=self.headway_min, start=self.start
        )


class WrittenDay(NamedTuple):
    """A bus's day that was written."""

    folder: Path
    trips: int
    reports: int


def simulate_network(
    model: NetworkModel, out: Path, written: Callable[[WrittenDay], None] = lambda _: None
) -> list[WrittenDay]:
    """Write `out/feed` and `out/bus-1-day-1`, ...; `written` is told of each as it is done.

    Raises InputError for a folder that cannot be written.
    """
    network = make_network(model)
    found = []
    try:
        tables = feed_tables(model, network.ways, network.trips)
        for name, text in tables.items():
            _write(out / FEED_NAME / name, text)
        for day in drive_days(model, network):
            folder = out / f"bus-{day.vehicle}-day-{day.number}"
            _write_day(model, day, folder)
            trips = sum(stage.trip is not None for stage in day.ride.stages)
            found.append(WrittenDay(folder, trips, len(day.reports.times_s)))
            written(found[-1])
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(str(out), reason, "name a folder that can be written") from None
    return found


def _write_day(model: NetworkModel, day: VehicleDay, folder: Path) -> None:
    midnight_s = instant_ns(day.day, 0.0, ZoneInfo(ZONE)) // SECOND_NS
    assignment = 'assignment = "block"\n' if model.assigned else ""
    _write(
        folder / "drive.toml",
        DRIVE.format(
            vehicle=day.vehicle,
            seed=model.seed,
            number=day.number,
            reports=REPORTS_NAME,
            truth=TRUTH_NAME,
            assignment=assignment,
        ),
    )
    _write_rows(
        folder / REPORTS_NAME, "time,lat,lon,heading,speed_mps,block", _reports(day, midnight_s)
    )
    header = "t_s,lat_deg,lon_deg,heading_deg,speed_mps,route_id,direction_id,trip_id,distance_m"
    _write_rows(folder / TRUTH_NAME, header, _truth(day, midnight_s))
    header = "trip_id,stop_id,stop_sequence,arrival_s,departure_s,stood"
    _write_rows(folder / VISITS_NAME, header, _visits(day, midnight_s))
    facts = DayFacts(
        seed=model.seed,
        hours=model.hours,
        headway_min=model.headway_min,
        start=model.start,
        vehicle=day.vehicle,
        number=day.number,
    )
    text = msgspec.json.format(msgspec.json.encode(facts), indent=2).decode()
    _write(folder / FACTS_NAME, text + "\n")


def read_day_facts(folder: Path) -> DayFacts | None:
    """The facts of a bus's day; None of any other drive. Raises InputError."""
    path = folder / FACTS_NAME
    if not path.exists():
        return None
    try:
        return msgspec.json.decode(path.read_bytes(), type=DayFacts)
    except msgspec.DecodeError as error:
        raise InputError(str(path), str(error), "simulate the network again") from None


def _reports(day: VehicleDay, midnight_s: int) -> Iterable[str]:
    trip = next(stage.trip for stage in day.ride.stages if stage.trip is not None)
    for time_s, lat_deg, lon_deg, heading_deg, speed_mps, _ in zip(
        *map(np.ndarray.tolist, day.reports), strict=True
    ):
        yield (
            f"{midnight_s + time_s:.0f},{lat_deg:.6f},{lon_deg:.6f},{heading_deg:.0f},"
            f"{speed_mps:.1f},{trip.block_id}"
        )


def _truth(day: VehicleDay, midnight_s: int) -> Iterable[str]:
    named = [
        ("", "", "")
        if stage.trip is None
        else (stage.trip.way.line_id, stage.trip.way.direction_id, stage.trip.trip_id)
        for stage in day.ride.stages
    ]
    for time_s, lat_deg, lon_deg, heading_deg, speed_mps, along_m, stage in zip(
        *map(np.ndarray.tolist, day.track), strict=True
    ):
        route_id, direction_id, trip_id = named[stage]
        distance = f"{along_m:.1f}" if trip_id else ""
        yield (
            f"{midnight_s + time_s:.0f},{lat_deg:.7f},{lon_deg:.7f},{heading_deg:.1f},"
            f"{speed_mps:.2f},{route_id},{direction_id},{trip_id},{distance}"
        )


def _visits(day: VehicleDay, midnight_s: int) -> Iterable[str]:
    sequences: dict[str, int] = {}
    for visit in day.ride.visits:
        sequences[visit.trip_id] = sequences.get(visit.trip_id, 0) + 1
        arrives_s, departs_s = midnight_s + visit.arrives_s, midnight_s + visit.departs_s
        yield (
            f"{visit.trip_id},{visit.stop_id},{sequences[visit.trip_id]},"
            f"{arrives_s:.1f},{departs_s:.1f},{int(visit.stood)}"
        )


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def _write_rows(path: Path, header: str, rows: Iterable[str]) -> None:
    _write(path, "\n".join([header, *rows]) + "\n")
