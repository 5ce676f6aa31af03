"""A simulated network: that what its files say belongs together."""

import csv
import datetime as dt
import itertools
from pathlib import Path
from zoneinfo import ZoneInfo

import numpy as np
import pytest

from wayline.geo import WGS84
from wayline.timetable.calendar import SECOND_NS, instant_ns
from wayline.timetable.model import Timetable
from wayline.timetable.reading import read_timetable
from wayline.timetable.runs import Run, Runs
from wayline_simulator.network.files import simulate_network
from wayline_simulator.network.model import NetworkModel
from wayline_simulator.network.motion import Driving
from wayline_simulator.network.schedule import LAYOVER_S, make_schedule
from wayline_simulator.network.streets import make_ways

DAY = "bus-2-day-1"
MONDAY = dt.date(2026, 5, 4)


@pytest.fixture(scope="module")
def network(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("network")
    simulate_network(NetworkModel(vehicles=2, hours=3.0), out)
    return out


@pytest.fixture(scope="module")
def timetable(network: Path) -> Timetable:
    return read_timetable(network / "feed")


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def numbers(table: list[dict[str, str]], column: str) -> np.ndarray:
    return np.array([float(row[column]) for row in table])


def texts(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): path.read_text()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_the_same_seed_makes_the_same_files(network: Path, tmp_path: Path) -> None:
    simulate_network(NetworkModel(vehicles=2, hours=3.0), tmp_path)
    assert texts(tmp_path) == texts(network)


def test_reports_more_seldom_are_of_the_same_drive(network: Path, tmp_path: Path) -> None:
    simulate_network(NetworkModel(vehicles=2, hours=3.0, every_s=60.0), tmp_path)
    seldom, usual = texts(tmp_path), texts(network)
    assert {name for name in usual if usual[name] != seldom[name]} == {
        "bus-1-day-1/reports.csv",
        "bus-2-day-1/reports.csv",
    }


def test_its_feed_has_no_fault(timetable: Timetable) -> None:
    assert timetable.notes == ()
    assert [pattern.pattern_id for pattern in timetable.patterns] == ["A-0", "A-1", "B-0", "B-1"]


def test_lines_share_their_stops_up_to_the_fork(timetable: Timetable) -> None:
    """Half of each line; beyond it none."""
    a, b = (
        {stop.stop_id: stop.along_m for stop in way.stops}
        for way in make_ways(NetworkModel())
        if way.direction_id == 0
    )
    common = set(a) & set(b)
    assert max(a[stop] for stop in common) == pytest.approx(5_000.0, abs=450.0)
    assert min(a[stop] for stop in set(a) - common) > 5_000.0


def test_blocks_are_trips_that_follow_each_other(timetable: Timetable) -> None:
    """Each begins where the one before ended, after a layover, also on another line."""
    model = NetworkModel()
    trips = make_schedule(model, make_ways(model))
    changes = 0
    for block_id in {trip.block_id for trip in trips}:
        block = [trip for trip in trips if trip.block_id == block_id]
        for before, after in itertools.pairwise(block):
            assert before.way.stops[-1].stop_id == after.way.stops[0].stop_id
            assert after.departs_s - before.ends_s >= LAYOVER_S
            changes += before.way.line_id != after.way.line_id
    assert changes > 0


def run_of(timetable: Timetable, trip_id: str) -> Run:
    noon_ns = instant_ns(MONDAY, 43_200.0, ZoneInfo(timetable.timezone))
    return next(
        run
        for run in Runs([timetable]).assigned(trip_id, noon_ns)
        if abs(run.starts_ns - noon_ns) < 43_200 * SECOND_NS
    )


def test_truth_lies_on_the_trip_that_it_names(network: Path, timetable: Timetable) -> None:
    """In a lane beside the pattern's line, as far along as it says, and never back."""
    truth = rows(network / DAY / "truth.csv")
    trip_id = next(row["trip_id"] for row in truth if row["trip_id"])
    of_trip = [row for row in truth if row["trip_id"] == trip_id]
    run = run_of(timetable, trip_id)
    for row in of_trip[::60]:
        place = run.trip_route.route.line.project(float(row["lat_deg"]), float(row["lon_deg"]))
        assert place is not None
        assert abs(place.cross_track_m) == pytest.approx(2.0, abs=0.2)
        assert place.distance_m == pytest.approx(float(row["distance_m"]), abs=1.5)
    assert np.all(np.diff(numbers(of_trip, "distance_m")) >= 0.0)
    assert (run.pattern.route_id, run.pattern.direction_id) == (
        of_trip[0]["route_id"],
        int(of_trip[0]["direction_id"]),
    )


def test_visits_are_when_the_truth_is_at_the_stops(network: Path, timetable: Timetable) -> None:
    truth = rows(network / DAY / "truth.csv")
    named = np.array([row["trip_id"] for row in truth])
    times_s = numbers(truth, "t_s")
    checked = 0
    for visit in rows(network / DAY / "visits.csv"):
        run = run_of(timetable, visit["trip_id"])
        stop_m = run.trip_route.route.stop_distances_m[int(visit["stop_sequence"]) - 1]
        of_trip = named == visit["trip_id"]
        alongs_m = np.array([float(row["distance_m"] or "nan") for row in truth])[of_trip]
        at_m = np.interp(float(visit["arrival_s"]), times_s[of_trip], alongs_m)
        assert at_m == pytest.approx(stop_m, abs=10.0)
        if visit["stood"] == "1":
            left_m = np.interp(float(visit["departure_s"]), times_s[of_trip], alongs_m)
            assert left_m == pytest.approx(stop_m, abs=1.0)
        checked += 1
    assert checked == 22 * len({row["trip_id"] for row in truth} - {""})


def test_nobody_leaves_a_timepoint_early(network: Path, timetable: Timetable) -> None:
    for visit in rows(network / DAY / "visits.csv"):
        run, row = run_of(timetable, visit["trip_id"]), int(visit["stop_sequence"]) - 1
        timing = timetable.timings[run.trip.timing]
        is_last = row == len(timing.timepoints) - 1
        if timing.timepoints[row] and not is_last:
            departs_s = run.starts_ns / SECOND_NS + timing.departures_s[row]
            assert float(visit["departure_s"]) >= departs_s - 0.1


def test_reports_come_so_often_and_lie_near_the_truth(network: Path) -> None:
    truth, told = rows(network / DAY / "truth.csv"), rows(network / DAY / "reports.csv")
    gaps_s = np.diff(numbers(told, "time"))
    assert np.median(gaps_s) == pytest.approx(30.0, abs=1.0)
    at = np.searchsorted(numbers(truth, "t_s"), numbers(told, "time"))
    there = [truth[each] for each in at]
    _, _, offs_m = WGS84.inv(
        numbers(told, "lon"), numbers(told, "lat"),
        numbers(there, "lon_deg"), numbers(there, "lat_deg"),
    )  # fmt: skip
    assert 2.0 < np.sqrt(np.mean(offs_m**2)) < 12.0


def test_a_motion_stands_at_its_stops_and_passes_between_them() -> None:
    """100 m at 10 m/s and 1 m/s2: exactly at the speed for no time, 20 s."""
    driving = Driving(5.0)
    driving.go(100.0, 10.0)
    driving.stand_until(60.0)
    motion = driving.motion()
    alongs_m, speeds_mps = motion.at(np.array([0.0, 15.0, 25.0, 99.0]))
    assert alongs_m == pytest.approx([0.0, 50.0, 100.0, 100.0])
    assert speeds_mps == pytest.approx([0.0, 10.0, 0.0, 0.0])
    assert motion.passes_s(50.0) == pytest.approx(15.0)
    assert motion.passes_s(87.5) == pytest.approx(20.0)
    assert motion.passes_s(100.0) == pytest.approx(25.0)
