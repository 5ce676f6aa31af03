"""A town bus that keeps its timetable, through `wayline replay`: told early by as much as late.

Whatever its timetable tells: arrivals and departures, one time a stop, or whole minutes of either.
"""

import datetime as dt
import json
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from wayline_replay.replay import replay

SECOND_NS = 1_000_000_000
LAT_DEG, LON_DEG, DEGREE_M = 48.0, 9.0, 111_200.0
LEG_M, STOPS, DRIVES_S, DWELL_S = 420.0, 26, 47.0, 26.0
BEGINS = dt.datetime(2026, 6, 3, 8, 0, tzinfo=dt.UTC)
Told = Callable[[float], float]


def lat_deg(place_m: float) -> float:
    return LAT_DEG + place_m / DEGREE_M


def driven(seed: int) -> tuple[list[float], list[float]]:
    """Places in metres at every second after the departure, and when the bus comes to each stop."""
    random = np.random.default_rng(seed)
    places_m, comes_s = [], [0.0]
    for leg in range(STOPS - 1):
        drives_s = round(DRIVES_S + random.normal(0.0, 4.0))
        share = np.arange(1, drives_s + 1) / drives_s
        places_m += ((leg + 0.5 - 0.5 * np.cos(np.pi * share)) * LEG_M).tolist()
        comes_s.append(float(len(places_m)))
        places_m += [places_m[-1]] * round(random.uniform(DWELL_S - 8.0, DWELL_S + 8.0))
    return places_m, comes_s


def clock(seconds: float) -> str:
    return f"{BEGINS + dt.timedelta(seconds=round(seconds)):%H:%M:%S}"


def stop_times(arrival: Told, departure: Told) -> Iterator[str]:
    yield "trip_id,arrival_time,departure_time,stop_id,stop_sequence"
    for stop in range(STOPS):
        comes_s = stop * DRIVES_S + max(stop - 1, 0) * DWELL_S
        leaves_s = comes_s + (DWELL_S if 0 < stop < STOPS - 1 else 0.0)
        arrives = clock(arrival(comes_s))
        departs = clock(max(departure(leaves_s), arrival(comes_s)))
        yield f"T,{arrives},{departs},S{stop},{stop}"


def write_drive(folder: Path, places_m: list[float], arrival: Told, departure: Told) -> None:
    """The feed, and reports every half minute from two minutes before the departure on."""
    tables = {
        "agency": "agency_name,agency_url,agency_timezone\nA,http://localhost,UTC",
        "routes": "route_id,route_short_name,route_type\nR,R,3",
        "trips": "route_id,service_id,trip_id\nR,S,T",
        "calendar_dates": "service_id,date,exception_type\nS,20260603,1",
        "stops": "stop_id,stop_name,stop_lat,stop_lon\n"
        + "\n".join(f"S{at},{at},{lat_deg(at * LEG_M)},{LON_DEG}" for at in range(STOPS)),
        "stop_times": "\n".join(stop_times(arrival, departure)),
    }
    (folder / "gtfs").mkdir(parents=True)
    for name, text in tables.items():
        (folder / "gtfs" / f"{name}.txt").write_text(text + "\n", encoding="utf-8")
    rows = [
        f"{BEGINS + dt.timedelta(seconds=at):%Y-%m-%d %H:%M:%S},"
        f"{lat_deg(places_m[max(at, 0)])},{LON_DEG}"
        for at in range(-120, len(places_m), 30)
    ]
    (folder / "avl.csv").write_text("\n".join(["time,lat,lon", *rows]), encoding="utf-8")
    (folder / "drive.toml").write_text(
        '[drive]\nvehicle_id = "bus-7"\n[[avl]]\npath = "avl.csv"\ntimezone = "UTC"\n'
        'columns = { time = "time", lat_deg = "lat", lon_deg = "lon" }\n',
        encoding="utf-8",
    )


def errors_s(out: Path, comes_s: list[float]) -> list[float]:
    """Of what was told up to three minutes ahead, after the departure: actual minus told."""
    errors = []
    for line in (out / "arrivals.jsonl").read_text(encoding="utf-8").splitlines():
        told = json.loads(line)
        at_s = told["t_ns"] / SECOND_NS - BEGINS.timestamp()
        for stop in told["stops"] if at_s >= 0.0 else ():
            came_s = comes_s[int(stop["stop_id"][1:])]
            if 0.0 < came_s - at_s < 180.0:
                errors.append(came_s - stop["arrival_ns"] / SECOND_NS + BEGINS.timestamp())
    return errors


def exact(seconds: float) -> float:
    return seconds


def to_the_minute(seconds: float) -> float:
    return 60.0 * round(seconds / 60.0)


@pytest.mark.parametrize("rounded", [exact, to_the_minute])
@pytest.mark.parametrize("has_departures", [True, False])
def test_a_bus_that_keeps_its_timetable_is_told_at_its_time(
    tmp_path: Path, rounded: Told, *, has_departures: bool
) -> None:
    """One time a stop was taken for driving alone: every stop was told 15 s late and more."""
    errors = []
    for seed in (1, 2):
        places_m, comes_s = driven(seed)
        folder = tmp_path / str(seed)
        departure = rounded if has_departures else lambda _: -np.inf
        write_drive(folder, places_m, rounded, departure)
        replay(folder, folder / "out", feed_paths=[folder / "gtfs"])
        errors += errors_s(folder / "out", comes_s)
    assert abs(np.mean(errors)) < 6.0
    assert np.mean(np.abs(errors)) < 20.0
