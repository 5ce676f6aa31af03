"""Which trip a vehicle runs: lines on a shared street, blocks, layovers, times."""

import datetime as dt
from pathlib import Path

import pytest

from unit.eta.rides import BERLIN, DAY, Ride, stops, trips, two_lines
from unit.timetable.faulty_feeds import LAT_DEG, LON_DEG, good_feed, write_folder
from wayline.messages import Arrivals, Progress
from wayline.route import make_route
from wayline.timetable.calendar import SECOND_NS, instant_ns
from wayline.timetable.reading import read_timetable
from wayline.timetable.runs import Runs
from wayline_eta.core import assigned_routes


def test_lines_on_one_street_are_told_apart_behind_the_fork(tmp_path: Path) -> None:
    """Until then no trip is named and no stop is told that only one of them serves."""
    ride = Ride(two_lines(tmp_path))
    for second in range(20, 230):
        told = ride.at(8.34 * second)
        if second > 25:
            assert trips(told) == [None]
            assert set(stops(told)) <= {"S1", "S2"}
    for second in range(125):
        told = ride.at(2_001.5, 8.34 * second, heading_deg=90.0)
        named = trips(told)
        assert named == ["V"] or second < 30
    assert stops(told) == []


def test_an_assignment_tells_the_line_at_once(tmp_path: Path) -> None:
    ride = Ride(two_lines(tmp_path), "V")
    told = ride.at(0.0)
    assert trips(told) == ["V"]
    ride.at(8.0)
    told = ride.at(16.0)
    assert stops(told) == ["S1", "S2", "E3"]


def test_a_report_s_block_is_believed(tmp_path: Path) -> None:
    ride = Ride(two_lines(tmp_path))
    ride.report(assignment="B")
    assert trips(ride.at(0.0)) == ["T"]


def test_an_unknown_block_tells_nothing(tmp_path: Path) -> None:
    """The trip is found from place and time as if nothing had been said."""
    ride = Ride(Runs([read_timetable(write_folder(good_feed(), tmp_path))]), "nobody")
    for second in range(40):
        told = ride.at(8.34 * second)
    assert trips(told) == ["T"]


def test_after_the_last_stop_the_block_s_next_trip_is_under_way(tmp_path: Path) -> None:
    """The layover belongs to it; its stops are told before the vehicle gets there."""
    ride = Ride(Runs([read_timetable(write_folder(good_feed(), tmp_path))]), "B")
    for second in range(482):
        told = ride.at(min(8.34 * second, 4_003.0))
        if second == 100:
            assert trips(told) == ["T"]
    for _ in range(5):
        told = ride.at(4_003.0)
    assert trips(told) == ["U"]


def test_before_its_first_departure_a_vehicle_waits_for_its_time(tmp_path: Path) -> None:
    """Two minutes early at the first stop: the next stop is told by the timetable."""
    ride = Ride(Runs([read_timetable(write_folder(good_feed(), tmp_path))]), "T", start="07:58")
    for _ in range(5):
        told = ride.at(0.0)
    [progress] = [each for each in told if isinstance(each, Progress)]
    [arrivals] = [each for each in told if isinstance(each, Arrivals)]
    assert progress.delay_s == 0.0
    first = next(stop for stop in arrivals.stops if stop.stop_id == "S1")
    assert first.scheduled_ns == instant_ns(DAY, 8 * 3600 + 120.0, BERLIN)
    assert first.arrival_ns == pytest.approx(first.scheduled_ns, abs=2 * SECOND_NS)


def test_feeds_with_the_same_ids_are_told_apart_by_place(tmp_path: Path) -> None:
    far = good_feed()
    for name in ("stops.txt", "shapes.txt"):
        far[name] = far[name].replace(",48.", ",47.")
    feeds = [
        read_timetable(write_folder(tables, tmp_path / name))
        for name, tables in (("far", far), ("near", good_feed()))
    ]
    ride = Ride(Runs(feeds), "T")
    ride.at(0.0)
    ride.at(8.0)
    told = ride.at(16.0)
    [progress] = [each for each in told if isinstance(each, Progress)]
    assert (progress.trip_id, progress.on_route) == ("T", True)


def test_a_feed_of_another_continent_tells_nothing(tmp_path: Path) -> None:
    ride = Ride(Runs([read_timetable(write_folder(good_feed(), tmp_path))]))
    for _ in range(5):
        assert ride.at(-8_000_000.0) == []


def test_on_a_day_without_service_no_trip_is_found(tmp_path: Path) -> None:
    """A Sunday; the timetable runs on weekdays."""
    ride = Ride(Runs([read_timetable(write_folder(good_feed(), tmp_path))]))
    ride.t_ns += 4 * 86_400 * SECOND_NS
    assert all(ride.at(8.34 * second) == [] for second in range(30))


def test_a_route_that_is_assigned_is_the_only_one_followed() -> None:
    """Two lines share a street; a name that no route has leaves both."""
    line = [(LAT_DEG, LON_DEG), (LAT_DEG + 0.02, LON_DEG)]
    lines = [
        make_route(
            "", route_id=name, name=name, loop=False, vertices=line, speeds_mps=None, stops=()
        )
        for name in "AB"
    ]
    assert [route.route_id for route in assigned_routes(lines, "B")] == ["B"]
    assert len(assigned_routes(lines, "C")) == len(assigned_routes(lines, None)) == 2


def test_an_assignment_holds_on_the_next_day(tmp_path: Path) -> None:
    """A service goes on for weeks: tomorrow the block's trips are tomorrow's."""
    ride = Ride(Runs([read_timetable(write_folder(good_feed(), tmp_path))]), "T")
    for second in range(490):
        ride.at(min(8.34 * second, 4_003.0))
    ride.t_ns = instant_ns(DAY + dt.timedelta(days=1), 8 * 3600.0 + 60.0, BERLIN)
    for second in range(60):
        told = ride.at(8.34 * second)
    [progress] = [each for each in told if isinstance(each, Progress)]
    assert progress.trip_id == "T"
    assert progress.delay_s == pytest.approx(60.0, abs=5.0)


def test_an_unknown_block_does_not_hold_a_vehicle_to_what_was_found(tmp_path: Path) -> None:
    """It names a block that nobody knows, is found on T, and goes on by Q's line instead."""
    ride = Ride(two_lines(tmp_path), "nobody")
    for second in range(250):
        ride.at(8.34 * second)
    for second in range(125):
        told = ride.at(2_001.5, 8.34 * second, heading_deg=90.0)
    assert trips(told) == ["V"]
