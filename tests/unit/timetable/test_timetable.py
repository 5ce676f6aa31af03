"""What a feed becomes: calendars, patterns, trips, blocks, repeated trips, zones, waits."""

import datetime as dt
from collections.abc import Callable
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from unit.timetable.faulty_feeds import good_feed, write_folder
from wayline.errors import InputError
from wayline.timetable.calendar import SECOND_NS, instant_ns, seconds_of
from wayline.timetable.notes import Notes
from wayline.timetable.reading import read_timetable
from wayline.timetable.trip_route import PatternRoutes
from wayline_cli.route_import import Wishes, import_route

BERLIN = ZoneInfo("Europe/Berlin")


def test_a_real_feed_with_days_by_exceptions_only(recorded: Callable[[str], Path]) -> None:
    """Both directions' lengths as measured; the block's trips of one day are those driven."""
    timetable = read_timetable(recorded("wmata-5a-8062") / "gtfs")
    assert (len(timetable.trips), len(timetable.patterns)) == (372, 2)
    lengths_m = {
        pattern.direction_id: PatternRoutes(timetable, pattern, Notes()).line.length_m
        for pattern in timetable.patterns
    }
    assert lengths_m == {0: pytest.approx(48_300, abs=100), 1: pytest.approx(50_800, abs=100)}
    day = dt.date(2016, 5, 5)
    running = [
        trip
        for trip in timetable.trips
        if trip.block_id == "SE-08" and timetable.services[trip.service].runs_on(day)
    ]
    running.sort(key=lambda trip: trip.starts_s)
    driven = [trip.trip_id for trip in running if 10.5 * 3600 < trip.starts_s < 12 * 3600]
    assert driven == ["868590120", "868588920"]


def test_a_wait_at_two_bays_is_a_dwell(tmp_path: Path) -> None:
    """Seven minutes at a hub, written as two rows four metres apart."""
    tables = good_feed()
    tables["stops.txt"] += "S2b,Stop 2 b,48.118036,11.5\n"
    rows = tables["stop_times.txt"].split("U,")[0]
    rows = rows.replace("08:06", "08:13").replace("08:08", "08:15")
    tables["stop_times.txt"] = (
        rows.replace("S3,4", "S3,5")
        .replace("S4,5", "S4,6")
        .replace("T,08:13", "T,08:11:00,08:11:00,S2b,4\nT,08:13")
    )
    route = import_route(write_folder(tables, tmp_path), Wishes(trip="T"))
    times_s = route.time_at(route.stop_distances_m)
    assert [stop.stop_id for stop in route.stops] == ["S0", "S1", "S2", "S2b", "S3", "S4"]
    assert route.stop_dwells_s.tolist() == pytest.approx([0, 0, 0, 420, 0, 0], abs=1.0)
    assert times_s[3] - times_s[2] < 1.0  # reached with the first of them
    assert times_s[4] - times_s[3] == pytest.approx(120.0, abs=0.1)
    assert times_s[-1] + route.stop_dwells_s.sum() == pytest.approx(900.0, abs=0.5)


def test_a_stop_in_two_rows_is_one_stop_with_a_dwell(tmp_path: Path) -> None:
    tables = good_feed()
    rows = tables["stop_times.txt"].split("U,")[0]
    tables["stop_times.txt"] = (
        rows.replace("08:08", "08:11")
        .replace("08:06", "08:09")
        .replace("S2,3", "S2,3\nT,08:07:00,08:07:00,S2,3.5")
        .replace("S4,5", "S4,7")
        .replace("S3,4", "S3,6")
        .replace("3.5", "4")
    )
    route = import_route(write_folder(tables, tmp_path), Wishes(trip="T"))
    assert [stop.stop_id for stop in route.stops] == ["S0", "S1", "S2", "S3", "S4"]
    assert route.stop_dwells_s.tolist() == pytest.approx([0, 0, 180, 0, 0], abs=0.1)


@pytest.mark.parametrize("day", ["2026-03-29", "2026-10-25", "2026-07-01"])
def test_a_clock_on_the_wall_shows_the_timetable_s_time(day: str) -> None:
    """Also on the days when summer time begins and ends, and past midnight."""
    date = dt.date.fromisoformat(day)
    for hours in (8, 25):
        shown = dt.datetime.fromtimestamp(
            instant_ns(date, hours * 3600.0, BERLIN) / SECOND_NS, BERLIN
        )
        assert (shown.hour, shown.minute) == (hours % 24, 0)
        assert seconds_of(date, instant_ns(date, hours * 3600.0, BERLIN), BERLIN) == hours * 3600


def test_a_trip_that_is_under_way_when_summer_time_begins_takes_as_long_as_ever() -> None:
    """01:00 to 03:30 of a service day that lost an hour at 02:00: GTFS counts from noon."""
    day = dt.date(2026, 3, 29)
    took_ns = instant_ns(day, 3.5 * 3600, BERLIN) - instant_ns(day, 1.0 * 3600, BERLIN)
    assert took_ns == 2.5 * 3600 * SECOND_NS


def test_repeated_trips_of_both_kinds(tmp_path: Path) -> None:
    tables = good_feed()
    tables["frequencies.txt"] = (
        "trip_id,start_time,end_time,headway_secs,exact_times\n"
        "T,06:00:00,09:00:00,600,0\nU,09:00:00,25:00:00,900,1\nV,1,2,3,0\n"
    )
    timetable = read_timetable(write_folder(tables, tmp_path))
    told = [(each.headway_s, each.exact, each.end_s) for each in timetable.frequencies]
    assert told == [(600, False, 32_400), (900, True, 90_000)]
    assert "row 4" in timetable.notes[-1].places


def test_trips_that_share_a_name_get_patterns_of_their_own(tmp_path: Path) -> None:
    """A short turn of the same route and direction: today's `R-0` names only the full one."""
    tables = good_feed()
    tables["trips.txt"] += "R,S,V,0,B,SH\n"
    tables["stop_times.txt"] += "V,10:00:00,10:00:00,S0,1\nV,10:02:00,10:02:00,S1,2\n"
    timetable = read_timetable(write_folder(tables, tmp_path))
    assert [pattern.pattern_id for pattern in timetable.patterns] == ["R-0", "R-0-2"]


def test_a_line_over_the_antimeridian(tmp_path: Path) -> None:
    """Fiji: longitudes jump from 180 to -180 and the line is as long as on a globe."""
    tables = good_feed()
    del tables["shapes.txt"]
    places = [(-17.0, 179.98), (-17.0, 179.99), (-17.0, -180.0), (-17.0, -179.99), (-17.0, -179.98)]
    tables["stops.txt"] = "stop_id,stop_name,stop_lat,stop_lon\n" + "".join(
        f"S{at},S,{lat},{lon}\n" for at, (lat, lon) in enumerate(places)
    )
    route = import_route(write_folder(tables, tmp_path), Wishes(trip="T"))
    assert route.length_m == pytest.approx(4 * 1_065.0, abs=10.0)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (dict.fromkeys(good_feed(), ""), "holds no trip"),
        ({"stop_times.txt": "trip_id,stop_id,stop_sequence\nT,S0,1\n"}, "a trip with one stop"),
        ({"stops.txt": "stop_id,stop_lat,stop_lon\n"}, "stop_id has no place in stops.txt"),
        ({"stop_times.txt": "trip,stop\n"}, "holds no trip"),
    ],
)
def test_a_feed_of_which_nothing_is_left_is_refused(
    change: dict[str, str], says: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=says) as refused:
        read_timetable(write_folder({**good_feed(), **change}, tmp_path))
    assert "\n" not in str(refused.value)


def test_stops_on_another_continent_are_refused_with_their_pattern(tmp_path: Path) -> None:
    """Latitudes and longitudes exchanged in one row, and no shape to hold the line."""
    tables = good_feed()
    del tables["shapes.txt"]
    tables["stops.txt"] = tables["stops.txt"].replace("48.118000,11.5", "11.5,48.118000")
    with pytest.raises(InputError, match=r"a leg of .* km"):
        import_route(write_folder(tables, tmp_path), Wishes(trip="T"))


@pytest.mark.parametrize("number", ["1e93", "nan", "-7e20"])
def test_a_sequence_that_no_integer_holds_is_none(number: str, tmp_path: Path) -> None:
    """That trip is taken in the order of its rows."""
    tables = good_feed()
    tables["stop_times.txt"] = tables["stop_times.txt"].replace("S2,3", f"S2,{number}")
    route = import_route(write_folder(tables, tmp_path), Wishes(trip="T"))
    assert [stop.stop_id for stop in route.stops] == ["S0", "S1", "S2", "S3", "S4"]
