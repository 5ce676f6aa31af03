"""The slope database as CSV."""

import csv
import io
from pathlib import Path

import pytest

from unit.slope_map.hilly_road import core, drive, runs_of
from wayline.database import open_database
from wayline.errors import InputError
from wayline_cli.slope_export import export_slope_csv
from wayline_slope_map.store import SlopeStore

HEADER = (
    "road_id,distance_m,lat_deg,lon_deg,heading_deg,grade_pct,grade_std_pct,alt_m,runs,updated,"
    "flagged_runs"
)


@pytest.fixture
def url(tmp_path: Path) -> str:
    address = f"sqlite:///{tmp_path}/slope.db"
    engine = open_database(address, "wayline_slope_map")
    for record in runs_of(core(), drive(seed=1, length_m=1000.0)):
        SlopeStore(engine).save(record)
    engine.dispose()
    return address


def test_every_bin_is_a_row_under_the_contracts_header(url: str) -> None:
    text = io.StringIO()
    count = export_slope_csv(url, None, text)
    lines = text.getvalue().splitlines()
    assert lines[0] == HEADER
    assert len(lines) == count + 1
    rows = list(csv.DictReader(lines))
    assert [float(row["distance_m"]) for row in rows] == [10.0 + 20.0 * i for i in range(count)]
    assert count == pytest.approx(50, abs=1)


def test_a_file_gets_the_same_as_the_terminal(url: str, tmp_path: Path) -> None:
    text = io.StringIO()
    export_slope_csv(url, None, text)
    export_slope_csv(url, tmp_path / "slope.csv", io.StringIO())
    assert (tmp_path / "slope.csv").read_text() == text.getvalue()


def test_a_database_or_a_folder_that_is_not_there_is_said(url: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file"):
        export_slope_csv(f"sqlite:///{tmp_path}/typo.db", None, io.StringIO())
    with pytest.raises(InputError, match="cannot be written"):
        export_slope_csv(url, tmp_path / "nowhere" / "slope.csv", io.StringIO())
