"""Writes simulated trips: a drive's folder each, with its fixes as CSV and the truth beside."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wayline.errors import InputError
from wayline_simulator.driver import DriverModel
from wayline_simulator.driver import drawn as drawn_driver
from wayline_simulator.driving import drive
from wayline_simulator.journey import Journey
from wayline_simulator.road import make_course
from wayline_simulator.trips.model import Part, TripsModel, randomness
from wayline_simulator.trips.simulation import Planned, Trip, driven, plan
from wayline_simulator.vehicle import VEHICLES
from wayline_simulator.weather import Weather
from wayline_simulator.weather import drawn as drawn_weather

FIXES_NAME, TRUTH_NAME = "fixes.csv", "truth.csv"
DRIVE = """[drive]
vehicle_id = "vehicle-{vehicle}"
description = "Trip {number} of a simulated vehicle (seed {seed})"

[[avl]]
path = "{fixes}"

[avl.columns]
time = "time"
lat_deg = "lat"
lon_deg = "lon"
heading_deg = "course"
speed_mps = "speed_mps"
satellites = "satellites"
hdop = "hdop"
pdop = "pdop"

[truth]
path = "{truth}"
"""
FIXES_HEADER = "time,lat,lon,speed_mps,course,satellites,hdop,pdop"
FIXES_FORMATS = "%.0f,%.6f,%.6f,%.2f,%.1f,%.0f,%.1f,%.1f"
TRUTH_HEADER = "t_s,lat_deg,lon_deg,heading_deg,speed_mps"
TRUTH_FORMATS = "%.0f,%.8f,%.8f,%.2f,%.3f"


class WrittenTrip(NamedTuple):
    """A trip that was written."""

    folder: Path
    distance_m: float
    fixes: int


def simulate_trips(
    model: TripsModel, out: Path, written: Callable[[WrittenTrip], None] = lambda _: None
) -> list[WrittenTrip]:
    """Write `out/vehicle-1-trip-1`, ...; `written` is told of each as it is done.

    Raises InputError for a folder that cannot be written.
    """
    found = []
    for planned in plan(model):
        trip = driven(model, planned, _journey(model, planned))
        folder = out / f"vehicle-{trip.vehicle}-trip-{trip.number}"
        try:
            _write(model, trip, folder)
        except OSError as error:
            reason = error.strerror or str(error)
            raise InputError(str(folder), reason, "name a folder that can be written") from None
        found.append(WrittenTrip(folder, trip.distance_m, len(trip.fixes.times_s)))
        written(found[-1])
    return found


def _journey(model: TripsModel, planned: Planned) -> Journey:
    def random(part: Part) -> np.random.Generator:
        return randomness(model, planned.vehicle, planned.number, part)

    course = make_course(planned.road, planned.seed)
    weather = drawn_weather(Weather(), random(Part.WEATHER))
    driver = drawn_driver(DriverModel(), random(Part.DRIVER))
    motion = drive(course, VEHICLES["car"], driver, weather, random(Part.MOTION))
    return Journey(course, motion)


def _write(model: TripsModel, trip: Trip, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    text = DRIVE.format(
        vehicle=trip.vehicle,
        number=trip.number,
        seed=model.seed,
        fixes=FIXES_NAME,
        truth=TRUTH_NAME,
    )
    (folder / "drive.toml").write_text(text, encoding="utf-8")
    fixes, truth = trip.fixes, trip.truth
    rows = np.column_stack(
        (
            trip.start_s + fixes.times_s,
            fixes.lats_deg,
            fixes.lons_deg,
            fixes.speeds_mps,
            np.round(fixes.courses_deg, 1) % 360.0,
            fixes.satellites,
            fixes.hdop,
            fixes.pdop,
        )
    )
    _write_rows(folder / FIXES_NAME, FIXES_HEADER, FIXES_FORMATS, rows)
    rows = np.column_stack(
        (
            trip.start_s + truth.times_s,
            truth.lats_deg,
            truth.lons_deg,
            np.round(truth.headings_deg, 2) % 360.0,
            truth.speeds_mps,
        )
    )
    _write_rows(folder / TRUTH_NAME, TRUTH_HEADER, TRUTH_FORMATS, rows)


def _write_rows(path: Path, header: str, formats: str, rows: "np.ndarray") -> None:
    with path.open("w", encoding="ascii", newline="\n") as file:
        np.savetxt(file, rows, fmt=formats, header=header, comments="", newline="\n")
