"""Trips that are repeated, run while the clock is changed, or cross the antimeridian."""

import datetime as dt
from pathlib import Path

import pytest

from unit.eta.rides import BERLIN, Ride, trips
from unit.timetable.faulty_feeds import LAT_DEG, good_feed, write_folder
from wayline.messages import Arrivals, Message, Progress
from wayline.timetable.calendar import instant_ns
from wayline.timetable.reading import read_timetable
from wayline.timetable.runs import Runs

FREQUENCIES = "trip_id,start_time,end_time,headway_secs,exact_times\nT,08:00:00,10:00:00,900,"


def north(ride: Ride, seconds: int) -> list[Message]:
    """So many seconds along the line; the last that was told."""
    told: list[Message] = []
    for second in range(seconds):
        told = ride.at(8.34 * second)
    return told


def delays(told: list[Message]) -> list[float | None]:
    return [each.delay_s for each in told if isinstance(each, Progress)]


def scheduled(told: list[Message]) -> list[int | None]:
    [arrivals] = [each for each in told if isinstance(each, Arrivals)]
    return [stop.scheduled_ns for stop in arrivals.stops]


def repeated(folder: Path, exact: str) -> Runs:
    return Runs(
        [
            read_timetable(
                write_folder(good_feed() | {"frequencies.txt": f"{FREQUENCIES}{exact}\n"}, folder)
            )
        ]
    )


def test_a_trip_that_is_repeated_at_its_times_has_a_delay(tmp_path: Path) -> None:
    """The one at a quarter past eight, two minutes late."""
    told = north(Ride(repeated(tmp_path, "1"), start="08:17"), 60)
    assert trips(told) == ["T"]
    assert delays(told) == [pytest.approx(120.0, abs=3.0)]
    assert None not in scheduled(told)


def test_where_only_a_headway_is_promised_nobody_is_late(tmp_path: Path) -> None:
    told = north(Ride(repeated(tmp_path, "0"), start="08:17"), 60)
    assert trips(told) == ["T"]
    assert delays(told) == [None]
    assert set(scheduled(told)) == {None}


@pytest.mark.parametrize("day", [dt.date(2026, 3, 29), dt.date(2026, 10, 25)])
def test_a_trip_goes_on_while_summer_time_begins_or_ends(tmp_path: Path, day: dt.date) -> None:
    """At two or three on a Sunday: the timetable counts from noon, whatever the clocks do."""
    tables = good_feed()
    tables["calendar.txt"] = tables["calendar.txt"].replace("0,0,2026", "0,1,2026")
    changes_s = instant_changes_s(day)
    begins_s = changes_s - 240
    hours, minutes = divmod(begins_s // 60, 60)
    header, *_ = tables["stop_times.txt"].splitlines()
    rows = [
        f"T,{hours:02d}:{minutes + 2 * at:02d}:00,{hours:02d}:{minutes + 2 * at:02d}:00,S{at},{at}"
        for at in range(5)
    ]
    tables["stop_times.txt"] = "\n".join([header, *rows]) + "\n"
    ride = Ride(Runs([read_timetable(write_folder(tables, tmp_path))]))
    ride.t_ns = instant_ns(day, begins_s, BERLIN)
    told = north(ride, 400)
    assert trips(told) == ["T"]
    assert delays(told) == [pytest.approx(0.0, abs=5.0)]


def instant_changes_s(day: dt.date) -> int:
    """When the clock is changed on a day, by its timetable: at one o'clock UTC."""
    changed = dt.datetime.combine(day, dt.time(1), dt.UTC)
    return round(changed.timestamp() - instant_ns(day, 0.0, BERLIN) * 1e-9)


def test_a_trip_over_the_antimeridian_is_found_and_followed(tmp_path: Path) -> None:
    tables = good_feed()
    lons_deg = [(179.98 + 0.0134 * at + 180.0) % 360.0 - 180.0 for at in range(5)]
    tables["stops.txt"] = "stop_id,stop_name,stop_lat,stop_lon\n" + "".join(
        f"S{at},Stop {at},{LAT_DEG},{lon_deg:.6f}\n" for at, lon_deg in enumerate(lons_deg)
    )
    del tables["shapes.txt"]
    ride = Ride(Runs([read_timetable(write_folder(tables, tmp_path))]), lon_deg=179.98)
    for second in range(300):
        told = ride.at(0.0, east_m=8.29 * second, heading_deg=90.0)
    assert trips(told) == ["T"]
    [progress] = [each for each in told if isinstance(each, Progress)]
    assert progress.on_route
    assert progress.distance_m == pytest.approx(8.29 * 299, abs=25.0)
    assert -180.0 <= progress.lon_deg < -179.9


def versions_at_midnight(folder: Path) -> Runs:
    """T leaves at 23:56 until the third of June; by the newer feed, from the fourth, at 00:20."""
    feeds = []
    for name, times, dates in (
        ("older", ("23:5", (6, 8)), ("20260101", "20260603")),
        ("newer", ("00:2", (0, 2, 4, 6, 8)), ("20260604", "20261231")),
    ):
        tables = good_feed()
        clock, minutes = times
        clocks = [f"{clock}{minute}:00" for minute in minutes]
        clocks += [f"24:0{minute}:00" for minute in (0, 2, 4)][: 5 - len(clocks)]
        rows = [f"T,{at},{at},S{stop},{stop + 1}" for stop, at in enumerate(clocks)]
        head = tables["stop_times.txt"].splitlines()[0]
        tables["stop_times.txt"] = "\n".join((head, *rows)) + "\n"
        tables["calendar.txt"] = f"{head_of(tables)}S,1,1,1,1,1,0,0,{','.join(dates)}\n"
        feeds.append(read_timetable(write_folder(tables, folder / name)))
    return Runs(feeds)


def head_of(tables: dict[str, str]) -> str:
    return tables["calendar.txt"].splitlines(keepends=True)[0]


def test_a_feed_that_changes_at_midnight_leaves_a_running_vehicle_its_trip(tmp_path: Path) -> None:
    """It is late on the old one's last trip, and runs the new one's first half an hour later."""
    runs = versions_at_midnight(tmp_path)
    told = north(Ride(runs, start="23:57"), 470)
    assert trips(told) == ["T"]
    assert delays(told) == [pytest.approx(60.0, abs=3.0)]
    told = north(Ride(runs, start="24:20"), 60)
    assert trips(told) == ["T"]
    assert delays(told) == [pytest.approx(0.0, abs=3.0)]
