"""Position reports as CSV, from the table to the pose."""

import json
from pathlib import Path
from typing import Any

import pytest

from wayline.errors import InputError
from wayline_replay.replay import Summary, replay

HEADER = "bus,time,lat,lon,course,kmh,sats,pdop,block\n"
DRIVE = """[drive]
vehicle_id = "bus-7"

[[avl]]
path = "avl.csv"
where = { bus = BUS }

[avl.columns]
time = "time"
lat_deg = "lat"
lon_deg = "lon"
heading_deg = "course"
speed_mps = { name = "kmh", scale = 0.2777777777777778 }
satellites = "sats"
pdop = "pdop"
assignment = "block"
"""
START_S = 1_462_459_500
NORTH_DEG = 10.0 * 20.0 / 111_000.0
"""Of 20 s at 10 m/s."""


def table(*, satellites: int = 9, pdop: float = 1.8) -> list[str]:
    """Twenty minutes to the north, every 20 s; another bus stands beside."""
    return [
        row
        for number in range(60)
        for row in (
            f"7,{START_S + 20 * number},{48.0 + NORTH_DEG * number:.7f},11.5,0,36,"
            f"{satellites},{pdop},SE-08\n",
            f"8,{START_S + 20 * number},49.0,11.5,0,0,9,1.8,SE-09\n",
        )
    ]


def replayed(folder: Path, rows: list[str], bus: int = 7) -> Summary:
    folder.mkdir(exist_ok=True)
    (folder / "avl.csv").write_text(HEADER + "".join(rows))
    (folder / "drive.toml").write_text(DRIVE.replace("BUS", str(bus)))
    return replay(folder, folder / "out")


def topic(folder: Path, name: str) -> list[dict[str, Any]]:
    text = (folder / "out" / f"{name}.jsonl").read_text()
    return [json.loads(line) for line in text.splitlines()]


def test_a_report_becomes_a_fix_with_all_that_it_says(tmp_path: Path) -> None:
    summary = replayed(tmp_path, table())
    fixes = topic(tmp_path, "gps_fix")
    assert len(fixes) == 60
    assert {fix["satellites"] for fix in fixes} == {9}
    assert {fix["pdop"] for fix in fixes} == {1.8}
    assert {fix["assignment"] for fix in fixes} == {"SE-08"}
    assert fixes[0]["speed_mps"] == pytest.approx(10.0)
    assert summary.left_out["gps-ingest"] == {"of other rows": 60}
    assert summary.bad_input["gps-ingest"] == 0


@pytest.mark.parametrize("bad", [{"satellites": 3}, {"pdop": 9.0}])
def test_reports_of_a_poor_sky_are_believed_less(tmp_path: Path, bad: dict[str, int]) -> None:
    """papers/003: good are at least 4 satellites and a PDOP of at most 8."""
    stds_m, nis = [], []
    for name, quality in (("good", {}), ("bad", bad)):
        replayed(tmp_path / name, table(**quality))
        stds_m.append(topic(tmp_path / name, "pose")[0]["east_std_m"])
        nis.append(
            sum(
                verdict["nis"]
                for status in topic(tmp_path / name, "fusion_status")
                for verdict in status["verdicts"]
                if verdict["sensor"] == "gps_position"
            )
        )
    assert stds_m[1] == pytest.approx(10.0 * stds_m[0])
    assert nis[1] < nis[0]


@pytest.mark.parametrize("number", [0, 30, 59])
def test_a_row_with_its_year_typed_wrong_costs_itself(tmp_path: Path, number: int) -> None:
    rows = [row for row in table() if row.startswith("7")]
    rows[number] = rows[number].replace(str(START_S + 20 * number), "2061-05-05 14:45:00")
    summary = replayed(tmp_path, rows)
    assert summary.bad_input["gps-ingest"] == 1
    poses = topic(tmp_path, "pose")
    assert len(topic(tmp_path, "gps_fix")) == 59
    assert max(pose["t_ns"] for pose in poses) <= (START_S + 20 * 59) * 10**9
    assert len(poses) > 1100


def test_rows_that_come_twice_or_late_move_no_pose(tmp_path: Path) -> None:
    rows = [row for row in table() if row.startswith("7")]
    mixed = list(rows)
    mixed[20], mixed[21] = mixed[21], mixed[20]
    mixed[40:40] = [rows[39], rows[30]]
    summary = replayed(tmp_path / "mixed", mixed)
    replayed(tmp_path / "once", rows[:20] + rows[21:])
    assert summary.bad_input["gps-ingest"] == 3
    assert topic(tmp_path / "mixed", "pose") == topic(tmp_path / "once", "pose")


def test_where_that_no_row_fits_is_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="none of its 120 rows has bus 9; correct where in its"):
        replayed(tmp_path, table(), bus=9)
