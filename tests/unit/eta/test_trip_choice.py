"""Which trip a vehicle runs: lines on a shared street, blocks, layovers, times."""

import datetime as dt
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from unit.timetable.faulty_feeds import LAT_DEG, LON_DEG, STEP_DEG, good_feed, write_folder
from wayline.inputs import Tick
from wayline.messages import Arrivals, GpsFix, Message, Pose, Progress
from wayline.route import make_route
from wayline.timetable.calendar import SECOND_NS, instant_ns
from wayline.timetable.reading import read_timetable
from wayline.timetable.runs import Runs
from wayline.tuning import Tuning
from wayline_eta.core import assigned_routes
from wayline_eta.timetable_core import timetable_node

BERLIN = ZoneInfo("Europe/Berlin")
DAY = dt.date(2026, 6, 3)
NORTH_M = 111_194.9


def two_lines(folder: Path) -> Runs:
    """R goes on to the north at S2, Q turns to the east there; both at eight."""
    tables = good_feed()
    tables["routes.txt"] += "Q,A,2,3\n"
    tables["trips.txt"] += "Q,S,V,0,C,\n"
    tables["stops.txt"] += f"E3,East,{LAT_DEG + 2 * STEP_DEG},{LON_DEG + 0.0134}\n"
    tables["stop_times.txt"] += "".join(
        f"V,08:0{2 * at}:00,08:0{2 * at}:00,{stop},{at}\n"
        for at, stop in enumerate(("S0", "S1", "S2", "E3"))
    )
    return Runs([read_timetable(write_folder(tables, folder))])


class Ride:
    """A vehicle that is driven and what is told of it."""

    def __init__(self, runs: Runs, assignment: str | None = None, start: str = "08:00") -> None:
        hours, minutes = (int(part) for part in start.split(":"))
        self.t_ns = instant_ns(DAY, 3600.0 * hours + 60.0 * minutes, BERLIN)
        self._node = timetable_node(runs, Tuning(), assignment)
        self._travelled_m = 0.0

    def at(self, north_m: float, east_m: float = 0.0, heading_deg: float = 0.0) -> list[Message]:
        """One second further, at a place in metres from S0."""
        pose = Pose(
            t_ns=self.t_ns,
            mode="gps",
            lat_deg=LAT_DEG + north_m / NORTH_M,
            lon_deg=LON_DEG + east_m / 74_250.0,
            heading_deg=heading_deg,
            speed_mps=8.34,
            distance_m=self._travelled_m,
            east_std_m=3.0,
            north_std_m=3.0,
        )
        self.report()
        told = list(self._node.take(pose, "fusion"))
        self.t_ns += SECOND_NS
        self._travelled_m += 8.34
        return told

    def report(self, assignment: str | None = None) -> None:
        """A fix, with what it names."""
        fix = GpsFix(t_ns=self.t_ns, valid=True, lat_deg=1.0, lon_deg=1.0, assignment=assignment)
        assert not list(self._node.take(fix, "gps-ingest"))

    def tick(self) -> list[Message]:
        return list(self._node.give(Tick(self.t_ns), "eta"))


def trips(told: list[Message]) -> list[str | None]:
    return [each.trip_id for each in told if isinstance(each, Progress)]


def stops(told: list[Message]) -> list[str]:
    [arrivals] = [each for each in told if isinstance(each, Arrivals)]
    return [stop.stop_id for stop in arrivals.stops]


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
    ride.report("B")
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
