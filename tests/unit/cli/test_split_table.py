"""One table of many drives becomes a folder each, which replay and evaluation read."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from wayline.drive_file import load_drive
from wayline.errors import InputError
from wayline_cli.__main__ import app
from wayline_cli.split_table import split_table
from wayline_replay.stream import DriveStream

TEMPLATE = """[drive]
vehicle_id = "car-$id"
[[avl]]
path = "$table"
where = { trip = "$value" }
[avl.columns]
time = "t"
lat_deg = "lat"
lon_deg = "lon"
speed_mps = { name = "mph", scale = 0.44704 }
"""
ROWS = """trip,t,lat,lon,mph
1.0,1700000000,56.0,10.0,20
1.0,1700000001,56.0001,10.0,20
Two "B",1700000002,57.0,10.0,30
,1700000003,57.0,10.0,30
"""


def table(folder: Path, text: str = ROWS) -> Path:
    path = folder / "table.csv"
    path.write_text(text)
    return path


def template(folder: Path, text: str = TEMPLATE) -> Path:
    path = folder / "drive.toml"
    path.write_text(text)
    return path


def test_every_value_is_a_drive_of_its_own_rows(tmp_path: Path) -> None:
    command = ["split", str(table(tmp_path)), "--by", "trip", "--out", str(tmp_path / "out")]
    answer = CliRunner().invoke(app, [*command, "--template", str(template(tmp_path))])
    assert answer.exit_code == 0, answer.output
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["1-0", "two--b-"]
    for name, speeds_mps in (("1-0", [8.94, 8.94]), ("two--b-", [13.41])):
        drive = load_drive(tmp_path / "out" / name)
        assert drive.drive.vehicle_id == f"car-{name}"
        fixes = [received.message for received in DriveStream(drive, name)]
        told = [getattr(fix, "speed_mps") for fix in fixes]  # noqa: B009 -- of any message
        assert told == pytest.approx(speeds_mps, abs=0.01)


@pytest.mark.parametrize(
    ("rows", "text", "said"),
    [
        ("t,lat\n1,2\n", TEMPLATE, "no column trip; name one of its columns: t, lat"),
        ("trip,t\n,1\n", TEMPLATE, "no value in trip"),
        ("trip,t\nA/1,1\na-1,2\n", TEMPLATE, "'A/1' and 'a-1' of trip are both a-1"),
        ("trip,t\n//,1\n", TEMPLATE, "nothing of '//' in trip can be a vehicle id"),
        (ROWS, TEMPLATE.replace("$id", "$name"), "$name is not known"),
        (ROWS, TEMPLATE.replace("$value", "1"), "has no $value"),
        (ROWS, TEMPLATE.replace("speed_mps", "speed"), "speed"),
    ],
)
def test_what_cannot_be_split_is_one_line(tmp_path: Path, rows: str, text: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        split_table(table(tmp_path, rows), "trip", template(tmp_path, text), tmp_path / "out")
    assert said in str(error.value)
    assert "\n" not in str(error.value)
