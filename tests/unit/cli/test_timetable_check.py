"""`wayline timetable check` and a route a pattern, as a user calls them."""

from pathlib import Path

from typer.testing import CliRunner

from unit.timetable.faulty_feeds import FAULTS, good_feed, write_folder
from wayline.errors import InputError
from wayline.route_file import load_route
from wayline_cli.__main__ import app


def told(*arguments: str) -> str:
    result = CliRunner().invoke(app, [*arguments], env={"COLUMNS": "200"})
    if isinstance(result.exception, InputError):
        raise result.exception
    assert result.exit_code == 0, result.output
    return result.output


def test_faults_are_a_table_with_file_and_row(tmp_path: Path) -> None:
    tables = good_feed()
    for fault in FAULTS:
        if fault.name in {"far", "doubled", "slow"}:
            fault.put(tables)
    shown = told("timetable", "check", str(write_folder(tables, tmp_path)))
    assert "marked" in shown
    assert "S3, 8" in shown.replace("│", "")  # some 800 m off
    assert "row 12, row 13, row 14" in shown
    assert "slower than 1 m/s" in shown


def test_a_calendar_that_has_ended_is_marked(tmp_path: Path) -> None:
    tables = good_feed()
    tables["calendar.txt"] = tables["calendar.txt"].replace("2026", "2015")
    shown = told("timetable", "check", str(write_folder(tables, tmp_path)))
    assert "no service runs any longer" in shown
    assert "ended 2015-12-31" in shown


def test_a_folder_gets_a_file_a_pattern(tmp_path: Path) -> None:
    tables = good_feed()
    tables["trips.txt"] += "R,S,V,1,B,\n"
    tables["stop_times.txt"] += "V,10:00:00,10:00:00,S1,1\nV,10:02:00,10:02:00,S0,2\n"
    feed, out = write_folder(tables, tmp_path / "feed"), tmp_path / "routes"
    told("route", "import", str(feed), "--out", str(out))
    assert sorted(path.name for path in out.iterdir()) == ["R-0.geojson", "R-1.geojson"]
    assert load_route(out / "R-1.geojson").route_id == "R-1"
