"""Timetables kept in a database by the hash of their feed, on SQLite and PostgreSQL."""

from pathlib import Path

import pytest

from unit.timetable.faulty_feeds import FAULTS, good_feed, write_folder, write_zip
from wayline.timetable import loading
from wayline.timetable.loading import load_timetable
from wayline.timetable.reading import read_timetable


def test_a_second_start_reads_no_rows(
    database_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Packed or not: it is the content that counts. Notes are kept with it."""
    tables = good_feed()
    next(fault for fault in FAULTS if fault.name == "doubled").put(tables)
    tables["calendar_dates.txt"] = "service_id,date,exception_type\nS,20260501,2\n"
    tables["frequencies.txt"] = (
        "trip_id,start_time,end_time,headway_secs\nT,06:00:00,07:00:00,600\n"
    )
    feed = write_folder(tables, tmp_path / "feed")
    first = load_timetable(feed, database_url)
    assert first == read_timetable(feed)
    monkeypatch.delattr(loading, "read_files")
    again = load_timetable(write_zip(tables, tmp_path / "feed.zip"), database_url)
    assert again.source.endswith("feed.zip")
    assert (again.trips, again.services, again.notes) == (first.trips, first.services, first.notes)


def test_a_changed_feed_is_read_anew(database_url: str, tmp_path: Path) -> None:
    feed = write_folder(good_feed(), tmp_path)
    assert len(load_timetable(feed, database_url).trips) == 2
    changed = good_feed()
    changed["trips.txt"] = changed["trips.txt"].replace("R,S,U,0,B,SH\n", "")
    assert len(load_timetable(write_folder(changed, tmp_path), database_url).trips) == 1
