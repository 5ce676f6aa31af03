"""The papers' architectures through the whole system, on a simulated drive with outages."""

from pathlib import Path
from typing import get_args

import msgspec
import pytest

from wayline.tuning import ArchitectureName
from wayline_evaluation.architectures import ArchitectureRow, architecture_rows
from wayline_evaluation.commands.positions import outages_command
from wayline_evaluation.outages import OutageReport
from wayline_replay.outages import Outage
from wayline_replay.replay import replay
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario import Scenario, overlaid

HILLS = {"road": {"kind": "hills", "length_m": 5000.0}}
ALL: tuple[ArchitectureName, ...] = get_args(ArchitectureName)


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("hills")
    simulate(overlaid(Scenario(preset="mems"), HILLS), folder)
    return folder


def bytes_of(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.mark.parametrize("architecture", ALL)
def test_two_replays_are_identical(
    drive: Path, tmp_path: Path, architecture: ArchitectureName
) -> None:
    """To the last bit, an outage and what follows it included."""
    for run in ("1", "2"):
        replay(drive, tmp_path / run, outages=[Outage(120.0, 60.0)], architecture=architecture)
    assert bytes_of(tmp_path / "1") == bytes_of(tmp_path / "2")


def test_an_architecture_of_the_drives_own_tuning_is_the_one_that_is_replayed(
    drive: Path, tmp_path: Path
) -> None:
    tuned = tmp_path / "tuned" / "drive.toml"
    tuned.parent.mkdir()
    for file in drive.iterdir():
        (tuned.parent / file.name).symlink_to(file)
    tuned.unlink()
    text = (drive / "drive.toml").read_text(encoding="utf-8")
    assert "[tuning]" not in text
    tuned.write_text(text + '\n[tuning]\narchitecture = "gps_only"\n', encoding="utf-8")
    replay(tuned, tmp_path / "1")
    replay(drive, tmp_path / "2", architecture="gps_only")
    assert bytes_of(tmp_path / "1") == bytes_of(tmp_path / "2")


def test_the_study_tells_what_calibrating_by_gps_gains(drive: Path, tmp_path: Path) -> None:
    """One outage of a minute at 15 m/s; the gyro's bias is what the `mems` preset draws."""
    json, plot = tmp_path / "study.json", tmp_path / "study.png"
    outages_command(
        [drive],
        start=150.0,
        length=[60.0],
        architectures=",".join(ALL),
        json=json,
        plot=plot,
    )
    report = msgspec.json.decode(json.read_bytes(), type=OutageReport)
    rows = {row.architecture: row for row in architecture_rows(report.outages)}
    assert tuple(rows) == ALL
    assert {row.count for row in rows.values()} == {rows["loose"].count}
    assert p50_m(rows["uncoupled"]) > 3.0 * p50_m(rows["loose"])
    assert p50_m(rows["gps_only"]) > 10.0 * p50_m(rows["loose"])
    assert [growth.filter for growth in report.growths] == list(ALL)
    assert plot.read_bytes().startswith(b"\x89PNG")


def p50_m(row: ArchitectureRow) -> float:
    assert row.horizontal_m is not None
    return row.horizontal_m.p50
