"""A real express bus with a detour and a spur, its sparse reports given to eta as poses.

The truths (where the detour was, when each stop was passed) are those of the drive's README.
"""

import csv
import datetime as dt
import itertools
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple
from zoneinfo import ZoneInfo

import pytest

from wayline.geo import step_between
from wayline.inputs import Tick
from wayline.messages import Arrivals, Message, Pose, Progress
from wayline.tuning import Tuning
from wayline_cli.gtfs_route import route_from_gtfs
from wayline_eta.core import EtaCore

ZONE = ZoneInfo("America/New_York")
SECOND_NS = 1_000_000_000
WEST, EAST = "868590120", "868588920"


class Told(NamedTuple):
    """What was said at one second of the day."""

    clock: str
    progress: Progress
    arrivals: Arrivals


def reported(path: Path) -> list[Pose]:
    """The reports as poses; speed and distance from the straight way between two of them."""
    poses: list[Pose] = []
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            time = dt.datetime.fromisoformat(row["time"]).replace(tzinfo=ZONE)
            t_ns = int(time.timestamp()) * SECOND_NS
            lat_deg, lon_deg = float(row["latitude"]), float(row["longitude"])
            last = poses[-1] if poses else None
            moved_m = 0.0
            if last and last.lat_deg is not None and last.lon_deg is not None:
                moved_m = step_between(last.lat_deg, last.lon_deg, lat_deg, lon_deg).distance_m
            poses.append(
                Pose(
                    t_ns=t_ns,
                    mode="gps",
                    lat_deg=lat_deg,
                    lon_deg=lon_deg,
                    heading_deg=float(row["heading"]) % 360.0,
                    speed_mps=moved_m * SECOND_NS / (t_ns - last.t_ns) if last else 0.0,
                    distance_m=moved_m + (last.distance_m if last else 0.0),
                    east_std_m=5.0,
                    north_std_m=5.0,
                )
            )
    return poses


@pytest.fixture
def told(recorded: Callable[[str], Path]) -> list[Told]:
    """What eta says at each report, with both directions of the line to choose from."""
    folder = recorded("wmata-5a-8062")
    routes = [route_from_gtfs(folder / "gtfs", trip_id) for trip_id in (WEST, EAST)]
    assert [route.length_m for route in routes] == pytest.approx([50_800, 48_300], abs=100.0)
    core, said = EtaCore(routes, Tuning()), []
    for pose in reported(folder / "avl.csv"):
        core.handle(pose, "fusion")
        said.append(core.handle(Tick(pose.t_ns), "clock"))
    return [one for messages in said for one in _told(messages)]


def _told(outputs: Iterable[object]) -> list[Told]:
    # what happened at stops goes before them, what is to be kept comes after
    match [each for each in outputs if isinstance(each, Progress | Arrivals)]:
        case [Progress() as progress, Arrivals() as arrivals]:
            return [Told(clock_of(progress), progress, arrivals)]
    return []


def clock_of(message: Message) -> str:
    return f"{dt.datetime.fromtimestamp(message.t_ns / SECOND_NS, ZONE):%H:%M:%S}"


def test_the_detour_is_seen_and_nothing_is_predicted_in_it(told: list[Told]) -> None:
    on_route = {one.clock: one.progress.on_route for one in told}
    assert on_route["10:51:20"]
    assert not on_route["10:52:23"]
    assert not on_route["10:52:56"]
    assert on_route["10:54:00"]  # the second report after it
    assert all(bool(one.arrivals.stops) <= one.progress.on_route for one in told)


def test_the_direction_driven_is_the_route_followed(told: list[Told]) -> None:
    routes = [name for name, _ in itertools.groupby(one.progress.route_id for one in told)]
    assert routes == ["5A-1", "5A-0"]
    assert {one.progress.route_id for one in told if one.clock < "11:55"} == {"5A-1"}
    assert told[-1].progress.on_route


def test_progress_does_not_go_back_but_on_the_spur(told: list[Told]) -> None:
    """Within km 8 to 10 the route passes the same ground twice and reports are 30 s apart."""
    west = [one.progress.distance_m for one in told if one.progress.route_id == "5A-1"]
    outside = [place_m for place_m in west if not 8_000.0 < place_m < 10_000.0]
    assert len(outside) > 80
    assert all(after >= before for before, after in itertools.pairwise(outside))


@pytest.mark.parametrize(
    ("stop_id", "passed"),
    [
        ("4632", "10:49:14"),
        ("14078", "11:02:50"),
        ("13056", "11:34:49"),
        ("13060", "11:42:14"),
        ("14253", "11:45:00"),
    ],
)
def test_stops_are_passed_when_the_bus_was_there(
    told: list[Told], stop_id: str, passed: str
) -> None:
    """A stop leaves the list of arrivals with the first report at or past it: within 30 s."""
    west = [one for one in told if one.progress.route_id == "5A-1" and one.progress.on_route]
    first = next(
        one.clock for one in west if stop_id not in {stop.stop_id for stop in one.arrivals.stops}
    )
    apart_s = dt.datetime.strptime(first, "%H:%M:%S") - dt.datetime.strptime(passed, "%H:%M:%S")
    assert abs(apart_s.total_seconds()) <= 30.0


def test_the_last_stop_is_predicted_from_the_timetable_s_running_time(told: list[Told]) -> None:
    """Made at Herndon it is 11:44:49, 11 s early; the bare timetable is 136 s late."""
    at_herndon = next(one for one in told if one.clock == "11:34:49")
    dulles = next(stop for stop in at_herndon.arrivals.stops if stop.stop_id == "14253")
    predicted = dt.datetime.fromtimestamp(dulles.arrival_ns / SECOND_NS, ZONE)
    expected = predicted.replace(hour=11, minute=44, second=49, microsecond=0)
    assert abs((predicted - expected).total_seconds()) <= 3.0
    arrived = int(expected.replace(minute=45, second=0).timestamp()) * SECOND_NS
    assert dulles.early_ns < arrived < dulles.late_ns
