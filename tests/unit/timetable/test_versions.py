"""A newer version of a timetable counts from its first day on; feeds that have ended say so."""

import datetime as dt
from pathlib import Path
from zoneinfo import ZoneInfo

from unit.timetable.faulty_feeds import Tables, good_feed, write_folder
from wayline.timetable.calendar import instant_ns
from wayline.timetable.loading import timetable_warnings
from wayline.timetable.model import Timetable
from wayline.timetable.reading import read_timetable
from wayline.timetable.runs import Runs
from wayline.timetable.versions import NEVER, ended_line, superseded_days

BERLIN = ZoneInfo("Europe/Berlin")
CHANGE = dt.date(2026, 6, 10)
"""A Wednesday; the older version has days until the end of the year."""


def versions(folder: Path) -> list[Timetable]:
    """The newer one, whose trip T leaves a quarter of an hour later, is named first."""
    newer = good_feed()
    newer["calendar.txt"] = newer["calendar.txt"].replace("20260101", f"{CHANGE:%Y%m%d}")
    newer["stop_times.txt"] = newer["stop_times.txt"].replace(",08:0", ",08:2")
    return [named(newer, folder / "newer"), named(good_feed(), folder / "older")]


def named(tables: Tables, folder: Path) -> Timetable:
    return read_timetable(write_folder(tables, folder))


def departures(feeds: list[Timetable], day: dt.date) -> list[str]:
    """When T leaves on a day, by the clock."""
    found = Runs(feeds).assigned("T", instant_ns(day, 8 * 3600.0, BERLIN))
    times = [dt.datetime.fromtimestamp(run.departs_ns * 1e-9, BERLIN) for run in found]
    return [f"{time:%H:%M}" for time in times if time.date() == day]


def test_a_newer_version_takes_over_on_its_first_day(tmp_path: Path) -> None:
    feeds = versions(tmp_path)
    assert departures(feeds, CHANGE - dt.timedelta(days=1)) == ["08:00"]
    assert departures(feeds, CHANGE) == ["08:20"]
    assert superseded_days(feeds) == [NEVER, CHANGE.toordinal()]


def test_that_it_does_is_said_and_its_ids_are_no_warning(tmp_path: Path) -> None:
    [said] = timetable_warnings(versions(tmp_path), [])
    assert said == f"{tmp_path / 'older'}: a newer version counts from 2026-06-10 on"


def test_the_same_ids_elsewhere_are_another_timetable(tmp_path: Path) -> None:
    """Both count, whatever their days are."""
    far = good_feed()
    far["stops.txt"] = far["stops.txt"].replace(",48.", ",47.")
    del far["shapes.txt"]
    far["calendar.txt"] = far["calendar.txt"].replace("20260101", "20260301")
    feeds = [named(far, tmp_path / "far"), named(good_feed(), tmp_path / "near")]
    assert superseded_days(feeds) == [NEVER, NEVER]
    assert departures(feeds, CHANGE) == ["08:00", "08:00"]


def test_of_two_versions_of_the_same_days_the_one_named_last_counts(tmp_path: Path) -> None:
    feeds = [named(good_feed(), tmp_path / "first"), named(good_feed(), tmp_path / "second")]
    assert departures(feeds, CHANGE) == ["08:00"]
    assert superseded_days(feeds)[1] == NEVER


def test_a_calendar_that_has_ended_is_told_with_its_last_day(tmp_path: Path) -> None:
    feeds = [named(good_feed(), tmp_path / "feed")]
    assert ended_line(feeds, dt.date(2026, 12, 31)) is None
    said = ended_line(feeds, dt.date(2027, 1, 1))
    assert said is not None
    assert "last day 2026-12-31" in said
