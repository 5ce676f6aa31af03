"""Real drives through the whole system, as `wayline replay` runs it."""

import csv
import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from wayline.database import open_database
from wayline.drive_file import load_drive
from wayline.messages import TOPICS
from wayline_evaluation.outages import score_outage
from wayline_evaluation.pose_errors import compared
from wayline_evaluation.reference import fixes_reference
from wayline_evaluation.replays import read_replay
from wayline_replay.outages import Outage
from wayline_replay.replay import replay
from wayline_replay.stream import DriveStream
from wayline_slope_map.export import export_rows

ROOT = Path(__file__).parents[2]
DEMO = ROOT / "deploy" / "demo" / "avl-shuttle"
Row = dict[str, Any]


def read_topic(out: Path, topic: str) -> list[Row]:
    with (out / f"{topic}.jsonl").open("rb") as file:
        return [json.loads(line) for line in file]


class Runs(NamedTuple):
    """The real drive replayed twice into one database, into a fresh one, and with an outage."""

    first: Path
    second: Path
    fresh: Path
    outage: Path
    database_url: str
    fastest: float


@pytest.fixture(scope="module")
def css(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Path], Runs]:
    done: list[Runs] = []

    def run(drive: Path) -> Runs:
        if not done:
            folder = tmp_path_factory.mktemp("css-164")
            url = f"sqlite:///{folder / 'wayline.db'}"
            first = replay(drive, folder / "1", database_url=url)
            second = replay(drive, folder / "2", database_url=url)
            replay(drive, folder / "3", database_url=f"sqlite:///{folder / 'fresh.db'}")
            replay(drive, folder / "4", outages=[Outage(600.0, 60.0)])
            fastest = max(first.real_time_factor, second.real_time_factor)
            first_out, second_out, fresh, outage = (folder / name for name in "1234")
            done.append(Runs(first_out, second_out, fresh, outage, url, fastest))
        return done[0]

    return run


def test_css_164_poses_lie_on_the_recorded_fixes(
    recorded: Callable[[str], Path], css: Callable[[Path], Runs]
) -> None:
    first = read_replay(recorded("css-164"), css(recorded("css-164")).first)
    apart_m = compared(first.estimates, fixes_reference(first.fixes, first.estimates)).horizontal_m
    assert len(apart_m) == 2161
    assert np.mean(apart_m <= 15.0) >= 0.95
    assert np.nanpercentile(apart_m, 95) < 5.0


def test_css_164_is_dead_reckoned_through_a_minute_without_gps(
    recorded: Callable[[str], Path], css: Callable[[Path], Runs]
) -> None:
    """Scored at the last fix before GPS comes back, without alignment."""
    drive = recorded("css-164")
    runs = css(drive)
    first, blind = (read_replay(drive, out) for out in (runs.first, runs.outage))
    score = score_outage(
        Outage(600.0, 60.0),
        drive="css-164",
        name="fusion",
        pass_number=1,
        drive_start_s=first.start_s,
        estimates=blind.estimates,
        reference=fixes_reference(first.fixes, first.estimates),
    )
    assert score is not None
    assert score.horizontal_m < 60.0
    start_ns = first.start_s * 1e9

    def during(topic: str, from_s: float) -> list[Row]:
        rows = read_topic(runs.outage, topic)
        return [row for row in rows if from_s <= (row["t_ns"] - start_ns) * 1e-9 < 660.0]

    assert {pose["mode"] for pose in during("pose", 603.0)} == {"dead_reckoning"}
    blanked = during("gps_fix", 600.0)
    assert len(blanked) > 50
    assert {(f["valid"], f["lat_deg"], f["speed_mps"], f["alt_m"]) for f in blanked} == {
        (False, None, None, None)
    }


def test_css_164_counts_and_calibration_are_the_known_ones(
    recorded: Callable[[str], Path], css: Callable[[Path], Runs]
) -> None:
    runs = css(recorded("css-164"))
    counts = {
        topic: len(read_topic(runs.first, topic)) for topic in ("gyro", "odometer", "barometer")
    }
    assert counts == {"gyro": 240_211, "odometer": 4785, "barometer": 797}
    valid = [row for row in read_topic(runs.first, "gyro") if row["yaw_rate_degps"] is not None]
    assert len(valid) == 240_208
    status = read_topic(runs.first, "fusion_status")[-1]
    assert status["odometer_scale"] == pytest.approx(0.992, abs=0.003)
    assert status["gyro_bias_degps"] == pytest.approx(-0.37, abs=0.05)


def test_css_164_replays_the_same_to_the_last_bit(
    recorded: Callable[[str], Path], css: Callable[[Path], Runs]
) -> None:
    """Each time that its database is a new one."""
    runs = css(recorded("css-164"))
    names = {path.name for path in runs.first.iterdir()}
    assert names == {f"{topic}.jsonl" for topic in TOPICS if topic != "health"}
    for name in names:
        assert (runs.first / name).read_bytes() == (runs.fresh / name).read_bytes(), name


def test_css_164_is_calibrated_from_the_start_once_it_has_been_driven(
    recorded: Callable[[str], Path], css: Callable[[Path], Runs]
) -> None:
    """Also through the two minutes without GPS at its start; nothing is learned wrong thereby."""
    runs = css(recorded("css-164"))
    first, second = (read_topic(out, "fusion_status") for out in (runs.first, runs.second))
    assert first[0]["calibration"] == "none"
    assert {status["calibration"] for status in second} == {"calibrated"}
    for name, std_name in (
        ("gyro_bias_degps", "gyro_bias_std_degps"),
        ("odometer_scale", "odometer_scale_std"),
    ):
        assert second[0][name] == pytest.approx(first[-1][name], abs=2.0 * first[-1][std_name])
        assert second[-1][name] == pytest.approx(first[-1][name], abs=2.0 * first[-1][std_name])
    assert read_topic(runs.second, "pose")[0]["mode"] == "starting"


def test_css_164_twice_is_one_run_of_the_slope_map(
    recorded: Callable[[str], Path], css: Callable[[Path], Runs]
) -> None:
    runs = css(recorded("css-164"))
    rows = list(export_rows(open_database(runs.database_url, "wayline_slope_map")))
    assert {row.runs for row in rows} == {1}
    assert 35.0 < len(rows) * 20.0 / 1000.0 < 42.0
    known = [row for row in read_topic(runs.second, "horizon") if row["road_id"]]
    assert len(known) > 2000
    assert all(row["road_id"] is None for row in read_topic(runs.first, "horizon"))


def test_comma_seg40_wheel_speeds_decode_to_the_known_values(
    recorded: Callable[[str], Path], tmp_path: Path
) -> None:
    """All four wheels, each mapped in turn: 4974 frames, 28.46 to 71.77 km/h, 1003.8 m."""
    source = recorded("comma-seg40-can")
    text = (source / "drive.toml").read_text(encoding="utf-8")
    for name in ("gps.nmea", "can.log.gz", "toyota.dbc"):
        text = text.replace(f'"{name}"', f'"{source / name}"')
    wheels = '{ message = "WHEEL_SPEEDS", signal = ["WHEEL_SPEED_FL", "WHEEL_SPEED_FR", '
    wheels += '"WHEEL_SPEED_RL", "WHEEL_SPEED_RR"], scale = 0.2777777777777778 }'
    old = next(line for line in text.splitlines() if line.startswith('"odometer.speed_mps"'))
    (tmp_path / "drive.toml").write_text(
        text.replace(old, f'"odometer.speed_mps" = {wheels}'), encoding="utf-8"
    )
    arrivals = list(DriveStream(load_drive(tmp_path), "drive.toml"))
    wheel = [a.message for a in arrivals if a.message.topic == "odometer"]
    speeds = np.array([getattr(message, "speed_mps") for message in wheel])  # noqa: B009
    times_s = np.array([message.t_ns for message in wheel]) * 1e-9
    assert len(wheel) == 4974
    assert 28.46 / 3.6 <= speeds.min() < speeds.max() <= 71.77 / 3.6
    assert np.trapezoid(speeds, times_s) == pytest.approx(1003.8, abs=0.5)
    assert [a.received_ns for a in arrivals] == sorted(a.received_ns for a in arrivals)


@pytest.fixture(scope="module")
def lap(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("lap")
    replay(DEMO, out)
    return out


def test_the_shuttles_lap_has_progress_from_start_to_end(lap: Path) -> None:
    progress = read_topic(lap, "progress")
    totals = [row["lap"] * 1830.3 + row["distance_m"] for row in progress]
    assert totals[0] == pytest.approx(91.0, abs=15.0)
    assert totals[-1] == pytest.approx(1830.3 + 91.0, abs=30.0)
    assert min(np.diff(totals)) > -3.0
    assert all(row["on_route"] for row in progress)
    seconds = np.diff([row["t_ns"] for row in progress]) / 1e9
    assert set(seconds) == {1.0}


def test_the_shuttles_lap_has_an_arrival_at_every_stop(lap: Path) -> None:
    stops = json.loads((DEMO / "route.geojson").read_text(encoding="utf-8"))["features"][1:]
    for row in read_topic(lap, "arrivals"):
        assert {stop["stop_id"] for stop in row["stops"]} == {
            stop["properties"]["stop_id"] for stop in stops
        }
        for stop in row["stops"]:
            assert row["t_ns"] <= stop["early_ns"] <= stop["arrival_ns"] <= stop["late_ns"]


def test_the_reference_filter_reproduces_the_printed_estimates_in_a_drive(
    recorded: Callable[[str], Path], tmp_path: Path
) -> None:
    """papers/000, appendix D: 187 rows, as progress of a drive with route_filter = "avl"."""
    text = (DEMO / "drive.toml").read_text(encoding="utf-8")
    for name in ("gps.nmea", "route.geojson"):
        text = text.replace(f'"{name}"', f'"{DEMO / name}"')
    (tmp_path / "drive.toml").write_text(
        text + '\n[tuning]\nroute_filter = "avl"\n', encoding="utf-8"
    )
    replay(tmp_path, tmp_path / "out")
    progress = read_topic(tmp_path / "out", "progress")
    with (recorded("papers") / "avl-ekf-estimates.csv").open(encoding="utf-8") as file:
        printed = list(csv.DictReader(file))
    assert len(printed) == 187
    pairs = [(progress[int(row["gps_row_inferred"]) - 1], row) for row in printed]
    lat_m = [abs(p["lat_deg"] - float(r["latitude_deg"])) * 111_036.0 for p, r in pairs]
    east_m_per_deg = 111_320.0 * math.cos(math.radians(39.9))
    lon_m = [abs(p["lon_deg"] - float(r["longitude_deg"])) * east_m_per_deg for p, r in pairs]
    assert np.mean(lat_m) <= 0.45
    assert np.max(lat_m) <= 1.8
    assert np.mean(lon_m) <= 2.1


BAD_DRIVES = {
    "missing file": ('[[nmea]]\npath = "none.nmea"\n', "file none.nmea is missing"),
    "undated log": ('[[nmea]]\npath = "undated.nmea"\n', "add date = YYYY-MM-DD"),
    "missing signal": (
        '[[can]]\npath = "a.log"\ndbc = ["a.dbc"]\n[can.signals]\n'
        '"odometer.speed_mps" = { message = "Wheels", signal = "Sped" }\n',
        "did you mean Speed?",
    ),
    "broken database": ('[[can]]\npath = "a.log"\ndbc = ["bad.dbc"]\n', "is no CAN database"),
    "unknown key": (
        '[[nmea]]\npath = "undated.nmea"\ndate = 2024-01-01\n[vehicle]\nmas_kg = 1.0\n',
        "unknown key vehicle.mas_kg",
    ),
    "route with one point": (
        '[[nmea]]\npath = "undated.nmea"\ndate = 2024-01-01\n[route]\npath = "point.geojson"\n',
        "point.geojson",
    ),
}
GGA = "$GPGGA,120000.000,5600.0000,N,01000.0000,E,1,08,1.0,10.0,M,40.0,M,,*61"


@pytest.mark.parametrize("name", BAD_DRIVES)
def test_bad_input_is_one_line_and_status_2(tmp_path: Path, name: str) -> None:
    table, says = BAD_DRIVES[name]
    (tmp_path / "undated.nmea").write_text(GGA + "\n", encoding="ascii")
    (tmp_path / "a.log").write_text("(1.0) can0 100#00\n", encoding="ascii")
    dbc = 'BO_ 256 Wheels: 1 X\n SG_ Speed : 0|8@1+ (1,0) [0|255] "km/h" X\n'
    (tmp_path / "a.dbc").write_text(dbc, encoding="ascii")
    (tmp_path / "bad.dbc").write_text("BO_ 256 Wheels 1 X\n", encoding="ascii")
    point = {"type": "Feature", "properties": {"route_id": "r", "name": "R", "loop": False}}
    line = {**point, "geometry": {"type": "LineString", "coordinates": [[10.0, 56.0]]}}
    collection = {"type": "FeatureCollection", "features": [line]}
    (tmp_path / "point.geojson").write_text(json.dumps(collection), encoding="utf-8")
    drive = f'[drive]\nvehicle_id = "car"\n{table}'
    (tmp_path / "drive.toml").write_text(drive, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "wayline_cli", "replay", tmp_path, "--out", tmp_path / "out"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert says in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_corrupt_sentence_and_frame_are_counted_and_dropped(tmp_path: Path) -> None:
    times_s = range(1_704_110_401, 1_704_110_405)
    frames = zip(times_s, ("24", "25", "2\x00", "26"), strict=True)
    log = "".join(f"({time_s}.0) can0 100#{data}\n" for time_s, data in frames)
    (tmp_path / "a.log").write_text(log, encoding="ascii")
    dbc = 'BO_ 256 Wheels: 1 X\n SG_ Speed : 0|8@1+ (1,0) [0|255] "km/h" X\n'
    (tmp_path / "a.dbc").write_text(dbc, encoding="ascii")
    wrong = GGA.replace("*61", "*00")
    (tmp_path / "a.nmea").write_text(f"{GGA}\n{wrong}\n$GPGGA,1200", encoding="ascii")
    drive = """[drive]
vehicle_id = "car"
[[nmea]]
path = "a.nmea"
date = 2024-01-01
[[can]]
path = "a.log"
dbc = ["a.dbc"]
[can.signals]
"odometer.speed_mps" = { message = "Wheels", signal = "Speed", scale = 0.2777777777777778 }
"""
    (tmp_path / "drive.toml").write_text(drive, encoding="utf-8")
    summary = replay(tmp_path, tmp_path / "out")
    assert summary.counts["odometer"] == 3
    assert summary.bad_input["can-ingest"] == 1
    assert summary.bad_input["gps-ingest"] >= 1
    assert summary.counts["gps_fix"] == 1
