"""Routes from a GTFS feed, a folder or a zip file."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from wayline.errors import InputError
from wayline_cli.gtfs_route import route_from_gtfs

FEED = {
    "trips.txt": "route_id,trip_id,trip_headsign,direction_id,shape_id\n7,t1,Harbour,1,s\n",
    "stops.txt": (
        "stop_id,stop_name,stop_lat,stop_lon\n"
        "a,Gate,60.0000,20.0001\nb,Mill,60.0100,20.0001\nc,Quay,60.0200,20.0001\n"
    ),
    # numbers jump and rows are unsorted, as feeds have them
    "shapes.txt": (
        "shape_id,shape_pt_sequence,shape_pt_lat,shape_pt_lon\n"
        "s,30,60.0200,20.0\ns,1,60.0,20.0\nother,2,0,0\ns,7,60.0150,20.0\n"
    ),
    "stop_times.txt": (
        "trip_id,stop_id,arrival_time,departure_time,stop_sequence\n"
        "t1,c,24:04:30,24:04:30,9\nt1,a,23:59:00,23:59:30,1\nt1,b,24:01:00,24:01:20,4\n"
    ),
}

MakeFeed = Callable[..., Path]


@pytest.fixture
def feed(tmp_path: Path) -> MakeFeed:
    def make(**changes: str) -> Path:
        for name, text in FEED.items():
            (tmp_path / name).write_text(changes.get(name.removesuffix(".txt"), text))
        return tmp_path

    return make


def test_the_planned_times_between_stops_are_those_of_the_timetable(feed: MakeFeed) -> None:
    route = route_from_gtfs(feed(), "t1")
    assert (route.route_id, route.name, route.loop) == ("7-1", "Harbour", False)
    assert [stop.stop_id for stop in route.stops] == ["a", "b", "c"]
    assert [stop.dwell_s for stop in route.stops] == [30.0, 20.0, 0.0]
    # 23:59:30 to 24:01:00, and 24:01:20 to 24:04:30, over midnight
    assert np.diff(route.time_at(route.stop_distances_m)) == pytest.approx([90.0, 190.0], abs=0.1)
    assert route.length_m == pytest.approx(2228.3, abs=1.0)


def test_a_zip_file_is_a_feed_too(feed: MakeFeed, tmp_path: Path) -> None:
    folder = feed()
    archive = tmp_path / "feed.zip"
    with zipfile.ZipFile(archive, "w") as file:
        for name in FEED:
            file.write(folder / name, name)
    zipped, plain = route_from_gtfs(archive, "t1"), route_from_gtfs(folder, "t1")
    assert zipped.stops == plain.stops
    assert zipped.speeds_mps.tolist() == plain.speeds_mps.tolist()


def test_an_untimed_stop_lies_between_timed_ones(feed: MakeFeed) -> None:
    untimed = FEED["stop_times.txt"].replace("24:01:00,24:01:20", ",")
    route = route_from_gtfs(feed(stop_times=untimed), "t1")
    assert route.stops[1].dwell_s == 0.0
    times_s = route.time_at(route.stop_distances_m)
    assert times_s == pytest.approx([0.0, 150.0, 300.0], abs=1.0)


def test_two_stops_in_the_same_minute_share_a_speed(feed: MakeFeed) -> None:
    hasty = FEED["stop_times.txt"].replace("24:01:00,24:01:20", "23:59:30,23:59:30")
    route = route_from_gtfs(feed(stop_times=hasty), "t1")
    assert np.ptp(route.speeds_mps) < 1e-3
    assert route.speeds_mps[0] == pytest.approx(2228.3 / 300.0, abs=0.01)


def test_a_trip_without_a_shape_goes_from_stop_to_stop(feed: MakeFeed) -> None:
    route = route_from_gtfs(feed(trips="route_id,trip_id\n7,t1\n"), "t1")
    assert (route.route_id, route.name) == ("7", "7")
    assert len(route.line.legs_m) == 2


@pytest.mark.parametrize(
    ("changes", "trip_id", "says"),
    [
        ({}, "t9", "no trip_id t9"),
        ({"trips": ""}, "t1", "trips.txt: holds no trip"),
        ({"stops": "stop_id,stop_lat,stop_lon\na,60,20\n"}, "t1", "stop_id has no place"),
        ({"stops": "stop_id,name\na,60\n"}, "t1", "has no column stop_lat"),
    ],
)
def test_a_feed_that_does_not_fit_is_refused(
    feed: MakeFeed, changes: dict[str, str], trip_id: str, says: str
) -> None:
    with pytest.raises(InputError, match=says):
        route_from_gtfs(feed(**changes), trip_id)


@pytest.mark.parametrize(
    ("changes", "stops"),
    [
        ({"shapes": ""}, "abc"),
        ({"stop_times": FEED["stop_times.txt"].replace("24:01:00", "1 am")}, "abc"),
        ({"stops": FEED["stops.txt"].replace("60.0100", "north")}, "ac"),
        ({"stops": FEED["stops.txt"].replace("60.0100", "60.0150")}, "abc"),
        ({"stop_times": FEED["stop_times.txt"].replace(",4\n", ",x\n")}, "abc"),
    ],
)
def test_one_bad_row_takes_no_trip_away(
    feed: MakeFeed, changes: dict[str, str], stops: str
) -> None:
    """The trip goes on as long as the feed says: no time is lost by what was mended."""
    route = route_from_gtfs(feed(**changes), "t1")
    assert "".join(stop.stop_id for stop in route.stops) == stops
    planned_s = route.time_at(route.stop_distances_m)[-1] + route.stop_dwells_s[1:-1].sum()
    assert planned_s == pytest.approx(300.0, abs=0.5)


def test_what_is_no_feed_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        route_from_gtfs(tmp_path / "none", "t1")
    (tmp_path / "text").write_text("hello")
    with pytest.raises(InputError, match="is not a GTFS feed"):
        route_from_gtfs(tmp_path / "text", "t1")


def test_a_trip_that_ends_where_it_began_is_a_loop(feed: Callable[..., Path]) -> None:
    """A circular shuttle: its terminus is one stop, where the next lap begins."""
    tables = {
        "stops": "stop_id,stop_name,stop_lat,stop_lon\n"
        "a,A,55.0,10.0\nb,B,55.01,10.0\nc,C,55.01,10.02\n",
        "stop_times": "trip_id,arrival_time,departure_time,stop_id,stop_sequence\n"
        "t1,08:00:00,08:00:00,a,1\nt1,08:03:00,08:03:00,b,2\n"
        "t1,08:06:00,08:06:00,c,3\nt1,08:10:00,08:11:00,a,4\n",
        "trips": "route_id,service_id,trip_id\n7,s,t1\n",
    }
    route = route_from_gtfs(feed(**tables), "t1")
    assert route.loop
    assert [stop.stop_id for stop in route.stops] == ["a", "b", "c"]
    assert route.duration_s == pytest.approx(600.0, abs=1.0)
    assert route.stops[0].dwell_s == 60.0
