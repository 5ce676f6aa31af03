"""Writes the demo's second drive: a car on a lap of known motion, as its devices would log it.

It stands in for `wayline simulate`: a lap of 198 s and 1.6 km that begins where it ends, with
bends, two stops, a hill and a tunnel; the same bytes each time.
"""

import datetime as dt
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from wayline.errors import InputError
from wayline.line import Line
from wayline.route import Route, write_route
from wayline.stops import StopPlace, place_stops
from wayline_cli.demo_can import DBC, can_log
from wayline_cli.demo_motion import (
    DWELL_S,
    ORIGIN,
    STOPS_M,
    Motion,
    drive_lap,
    lay_out_lap,
    places_at,
)
from wayline_cli.demo_receiver import receiver_log

VEHICLE_ID = "demo-car"
START = dt.datetime(2026, 5, 4, 10, 0, 0, tzinfo=dt.UTC)
SEED = 20260504
STOP_NAMES = ("Elm Street", "Mill Bridge")
ROUTE_STEP_M = 10.0
"""Between the vertices of the route, so that it follows the bends."""
PLANNED_MPS = 9.5
"""Between stops: the lap's length over the time that the car moves."""

DRIVE_TOML = f"""[drive]
vehicle_id = "{VEHICLE_ID}"
description = "Made by wayline demo: a lap of 198 s, 1.6 km, with two stops, a hill and a tunnel"

[[nmea]]
path = "gps.nmea"

[[can]]
path = "can.log"
dbc = ["demo-car.dbc"]

[can.signals]
"gyro.yaw_rate_degps" = {{ message = "Yaw", signal = "YawRate" }}
"odometer.speed_mps" = {{ message = "Wheels", signal = "Speed", scale = 0.2777777777777778 }}
"barometer.pressure_pa" = {{ message = "Air", signal = "Pressure" }}

[route]
path = "route.geojson"

[truth]
path = "truth.csv"
"""


def write_demo_drive(folder: Path) -> None:
    """Write the drive into a folder, made if missing. Raises InputError where that is not had."""
    start_s = round(START.timestamp())
    random = np.random.default_rng(SEED)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _write(folder / "drive.toml", DRIVE_TOML.splitlines())
        _write(folder / "demo-car.dbc", DBC.splitlines())
        _write(folder / "gps.nmea", receiver_log(drive_lap(1.0), start_s, random))
        _write(folder / "can.log", can_log(drive_lap(50.0), start_s, random))
        _write(folder / "truth.csv", truth_rows(drive_lap(10.0), start_s))
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(str(folder), reason, "name a folder that can be written") from None
    write_route(lap_route(), folder / "route.geojson")


def lap_route() -> Route:
    """The lap as a route with the car's stops: its start and the two on the way."""
    lap = lay_out_lap()
    distances_m = np.linspace(0.0, lap.length_m, round(lap.length_m / ROUTE_STEP_M) + 1)
    east_m, north_m, _ = places_at(lap, np.array([*distances_m, *STOPS_M]))
    # both ends are one place to the last digit, as a loop's must be
    east_m[len(distances_m) - 1], north_m[len(distances_m) - 1] = east_m[0], north_m[0]
    places = [ORIGIN.to_geodetic(*place) for place in zip(east_m, north_m, strict=True)]
    vertices, stops = places[: len(distances_m)], [places[0], *places[len(distances_m) :]]
    line = Line(*np.array(vertices).T)
    named = [
        StopPlace(name.lower().replace(" ", "-"), name, *place, DWELL_S)
        for name, place in zip(("Garage", *STOP_NAMES), stops, strict=True)
    ]
    return Route(
        route_id="demo-loop",
        name="Demo loop",
        loop=True,
        line=line,
        speeds_mps=np.full(len(vertices) - 1, PLANNED_MPS),
        stops=place_stops("demo route", line, named, loop=True),
    )


def truth_rows(motion: Motion, start_s: int) -> Iterator[str]:
    """The columns of SPEC section 3."""
    yield "t_s,lat_deg,lon_deg,alt_m,heading_deg,speed_mps,grade_pct"
    for time_s, lat, lon, alt, heading, speed, grade in zip(
        motion.times_s,
        motion.lats_deg,
        motion.lons_deg,
        motion.alts_m,
        motion.headings_deg,
        motion.speeds_mps,
        motion.grades_pct,
        strict=True,
    ):
        yield (
            f"{start_s + time_s:.1f},{lat:.8f},{lon:.8f},{alt:.3f},"
            f"{heading:.3f},{speed:.3f},{grade:.3f}"
        )


def _write(path: Path, lines: Iterable[str]) -> None:
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(f"{line}\n" for line in lines)
