"""Raw measurements from a drive's files to `gps_raw`, as `wayline replay` runs them."""

import json
import math
import shutil
from collections.abc import Callable
from functools import reduce
from operator import xor
from pathlib import Path
from typing import Any

import pytest

from wayline_bench.made_up_sky import START_S, epoch, navigation, sky
from wayline_replay.outages import Outage
from wayline_replay.replay import replay

Row = dict[str, Any]
COLUMNS = (
    'time = "t_s", system = "system", prn = "prn", pseudorange_m = "pseudorange_m", '
    'pseudorange_std_m = "pseudorange_std_m", x_m = "x_m", y_m = "y_m", z_m = "z_m", '
    'elevation_deg = "elevation_deg", cn0_dbhz = "cn0_dbhz"'
)


def epochs(out: Path) -> list[Row]:
    with (out / "gps_raw.jsonl").open("rb") as file:
        return [json.loads(line) for line in file]


@pytest.fixture
def berlin(recorded: Callable[[str], Path], tmp_path: Path) -> Path:
    """The receiver of smartloc alone, the first 20 s."""
    folder = tmp_path / "berlin"
    folder.mkdir()
    with (recorded("smartloc") / "raw.csv").open() as table:
        kept = [line for line in table if line[0] == "t" or float(line.split(",")[0]) < 1400000020]
    (folder / "raw.csv").write_text("".join(kept))
    (folder / "drive.toml").write_text(
        '[drive]\nvehicle_id = "berlin"\n[[raw]]\npath = "raw.csv"\n'
        f"columns = {{ {COLUMNS} }}\n"
        'corrected = ["atmosphere", "satellite_clock"]\n'
    )
    return folder


def test_every_row_of_a_recorded_table_is_told(berlin: Path, tmp_path: Path) -> None:
    rows = (berlin / "raw.csv").read_text().splitlines()[1:]
    summary = replay(berlin, tmp_path / "out")
    told = epochs(tmp_path / "out")
    assert sum(len(epoch["satellites"]) for epoch in told) == len(rows) > 1000
    assert len(told) == len({row.partition(",")[0] for row in rows})
    assert summary.bad_input["gps-ingest"] == 0
    first = told[0]["satellites"][0]
    assert (first["system"], first["prn"], first["pseudorange_m"]) == ("gps", 12, 19949087.65382)


def test_satellites_move_as_satellites_do(berlin: Path, tmp_path: Path) -> None:
    """GPS satellites fly 3.9 km/s; seen from the turning earth 2.6 to 3.2."""
    replay(berlin, tmp_path / "out")
    speeds = [
        math.hypot(*(each[name] for name in ("vx_mps", "vy_mps", "vz_mps")))
        for epoch in epochs(tmp_path / "out")[10:]
        for each in epoch["satellites"]
        if each["system"] == "gps" and each["vx_mps"] is not None
    ]
    assert len(speeds) > 500
    assert 2400.0 < min(speeds) < max(speeds) < 3300.0


def test_an_outage_takes_the_satellites_too(berlin: Path, tmp_path: Path) -> None:
    replay(berlin, tmp_path / "out", outages=[Outage(5.0, 10.0)])
    told = epochs(tmp_path / "out")
    start_ns = told[0]["t_ns"]
    blind = [not epoch["satellites"] for epoch in told]
    assert blind == [5.0 <= (epoch["t_ns"] - start_ns) * 1e-9 < 15.0 for epoch in told]


def test_the_same_drive_tells_the_same_to_the_last_bit(berlin: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(berlin, tmp_path / "copy")
    replay(berlin, tmp_path / "first")
    replay(copy, tmp_path / "second")
    first, second = (tmp_path / name / "gps_raw.jsonl" for name in ("first", "second"))
    assert first.read_bytes() == second.read_bytes()


def test_one_log_of_a_receiver_is_fixes_and_measurements(tmp_path: Path) -> None:
    """Sentences and UBX as they come from one line: each table reads what is its own."""
    satellites = sky()
    parts = [navigation(satellites)]
    for second in range(12):
        body = f"GPRMC,0214{42 + second:02d}.00,A,4806.000,N,01136.000,E,0.0,0.0,080126,,"
        checksum = reduce(xor, body.encode())
        parts += [epoch(satellites, START_S + second), f"${body}*{checksum:02X}\r\n".encode()]
    (tmp_path / "log.ubx").write_bytes(b"".join(parts))
    (tmp_path / "drive.toml").write_text(
        '[drive]\nvehicle_id = "both"\n[[nmea]]\npath = "log.ubx"\n[[raw]]\npath = "log.ubx"\n'
    )
    summary = replay(tmp_path, tmp_path / "out")
    assert (summary.counts["gps_fix"], summary.counts["gps_raw"]) == (12, 12)
    assert summary.bad_input == {"gps-ingest": 0, "gps-ingest-2": 0}
    times_ns = [told["t_ns"] for told in epochs(tmp_path / "out")]
    with (tmp_path / "out" / "gps_fix.jsonl").open("rb") as file:
        assert [json.loads(line)["t_ns"] for line in file] == times_ns
