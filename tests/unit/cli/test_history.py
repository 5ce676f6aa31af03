"""`wayline history` and `wayline record --from`: lists, files that other readers open, refusals."""

import csv
import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from unit.history.driven import VEHICLE, legs
from unit.history.keeping import History
from wayline.errors import InputError
from wayline.gpx import read_gpx
from wayline.mcap_log import read_records
from wayline_cli.__main__ import app

FROM, TO = "2023-11-14T22:14:00Z", "2023-11-14T22:15:00Z"


@pytest.fixture
def url(tmp_path: Path) -> Iterator[str]:
    address = f"sqlite:///{tmp_path}/history.db"
    history = History(address)
    history.keep(legs((60, 0.0), (100, 10.0), (40, 0.0)))
    yield address
    history.engine.dispose()


def wayline(*arguments: str) -> str:
    """What a command writes; raises what it refuses."""
    result = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


def test_vehicles_are_listed(url: str) -> None:
    assert VEHICLE in wayline("history", "list", "--database", url)


def test_trips_as_a_table_for_people_and_for_programs(url: str) -> None:
    assert f"{VEHICLE}_20231114T221419Z" in wayline("history", "trips", "--database", url)
    (row,) = csv.DictReader(
        wayline("history", "trips", "--database", url, "--format", "csv").splitlines()
    )
    (trip,) = json.loads(wayline("history", "trips", "--database", url, "--format", "json"))[
        "trips"
    ]
    assert row["trip_key"] == trip["trip_key"]
    assert float(row["distance_m"]) == trip["distance_m"]


def test_a_track_is_written_as_gpx_that_is_read_again(url: str, tmp_path: Path) -> None:
    path = tmp_path / "track.gpx"
    wayline("history", "export", "--database", url, "--out", str(path))
    (line,) = read_gpx(path)
    assert len(line.points) == 200


def test_a_part_of_a_track_is_written_in_steps(url: str, tmp_path: Path) -> None:
    path = tmp_path / "track.csv"
    command = ("history", "export", "--database", url, "--format", "csv", "--out", str(path))
    wayline(*command, "--vehicle", VEHICLE, "--from", FROM, "--to", TO, "--step-s", "10")
    assert len(path.read_text().splitlines()) == 1 + 6


def test_a_past_minute_is_recorded_as_it_was_on_the_bus(url: str, tmp_path: Path) -> None:
    path = tmp_path / "past.mcap"
    said = wayline("record", str(path), "--from", FROM, "--to", TO, "--database", url)
    assert "pose" in said
    keys = [key for _, key, _ in read_records(path)]
    assert keys == [f"wayline/v1/{VEHICLE}/pose/fusion"] * 60


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("history", "export", "--format", "kml"), "--format: 'kml' is unknown; give gpx"),
        (("history", "export", "--kind", "cooked"), "--kind: Invalid enum value 'cooked'"),
        (("history", "export", "--from", "soon"), "--from: 'soon' is no time"),
        (("history", "export", "--vehicle", "bus-9"), "name one of which something is: bus-7"),
        (("history", "trips", "--format", "xml"), "--format: 'xml' is unknown"),
        (("record", "x.mcap", "--from", "2010-01-01", "--to", "2020-01-01"), "ask in parts"),
    ],
)
def test_what_makes_no_sense_is_one_line(url: str, arguments: tuple[str, ...], line: str) -> None:
    with pytest.raises(InputError, match=line):
        wayline(*arguments, "--database", url)


def test_a_database_that_is_not_there_is_not_made(tmp_path: Path) -> None:
    path = tmp_path / "none.db"
    with pytest.raises(InputError, match="no file"):
        wayline("history", "list", "--database", f"sqlite:///{path}")
    assert not path.exists()


def test_the_past_needs_a_database(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("WAYLINE_DATABASE_URL", raising=False)
    with pytest.raises(InputError, match="--database: is missing"):
        wayline("record", str(tmp_path / "past.mcap"), "--from", FROM)
