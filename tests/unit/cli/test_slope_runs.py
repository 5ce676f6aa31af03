"""`wayline slope list` and `withdraw`, as a user calls them."""

import csv
from pathlib import Path

import pytest
from typer.testing import CliRunner

from unit.slope_map.test_store import run
from wayline.database import open_database
from wayline.errors import InputError
from wayline_cli.__main__ import app
from wayline_slope_map.store import SlopeStore


@pytest.fixture
def url(tmp_path: Path) -> str:
    address = f"sqlite:///{tmp_path}/slope.db"
    engine = open_database(address, "wayline_slope_map")
    for day in range(2):
        SlopeStore(engine).save(run(day))
    engine.dispose()
    return address


def slope(command: str, *arguments: str) -> str:
    result = CliRunner().invoke(app, ["slope", command, *arguments])
    if isinstance(result.exception, InputError):
        raise result.exception
    assert result.exit_code == 0, result.output
    return result.stdout


def listed(url: str) -> list[dict[str, str]]:
    return list(csv.DictReader(slope("list", "--database", url).splitlines()))


def exported(url: str) -> list[dict[str, str]]:
    return list(csv.DictReader(slope("export", "--database", url).splitlines()))


def test_every_run_is_a_row_in_order_of_time(url: str) -> None:
    rows = listed(url)
    assert list(rows[0]) == ["run", "vehicle_id", "road_id", "direction", "start", "end", "state"]
    assert [row["state"] for row in rows] == ["merged", "merged"]
    assert rows[0]["start"] < rows[1]["start"]
    assert rows[0]["start"].endswith("Z")


def test_a_run_that_is_withdrawn_is_out_of_the_export_and_still_listed(url: str) -> None:
    first, second = (row["run"] for row in listed(url))
    assert {row["runs"] for row in exported(url)} == {"2"}
    assert f"{second}: " in slope("withdraw", second, "--database", url)
    assert {row["run"]: row["state"] for row in listed(url)} == {
        first: "merged",
        second: "withdrawn",
    }
    assert {row["runs"] for row in exported(url)} == {"1"}


def test_a_run_that_cannot_be_withdrawn_is_said(url: str, tmp_path: Path) -> None:
    (first, *_) = (row["run"] for row in listed(url))
    slope("withdraw", first, "--database", url)
    with pytest.raises(InputError, match=first):
        slope("withdraw", first, "--database", url)
    with pytest.raises(InputError, match="no run of this database"):
        slope("withdraw", "0123456789", "--database", url)
    with pytest.raises(InputError, match="no file"):
        slope("list", "--database", f"sqlite:///{tmp_path}/typo.db")
