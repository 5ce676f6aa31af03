"""`wayline evaluate slope` and `slope-map` from drives' files to the tables and pictures."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from wayline_evaluation.commands import evaluate_app
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario import Scenario, overlaid

ALONE = ("gps", "barometer", "torque")
TRUCK = overlaid(
    Scenario(preset="thesis", vehicle="truck", runs=2),
    {"seed": 63, "road": {"kind": "main", "length_m": 4000.0, "open_sky": True}},
)


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("truck")
    return [drive.folder for drive in simulate(TRUCK, folder)]


def evaluated(*arguments: str | Path) -> None:
    found = CliRunner().invoke(evaluate_app, [str(each) for each in arguments])
    assert found.exit_code == 0, found.output


def report_of(path: Path) -> Any:
    return json.loads(path.read_text())


def test_each_sensor_alone_and_all_of_them_live_and_in_the_map(
    drives: list[Path], tmp_path: Path
) -> None:
    path, plot = tmp_path / "slope.json", tmp_path / "slope.png"
    evaluated("slope", *drives, "--json", path, "--plot", plot)
    report = report_of(path)
    ways = report["ways"]
    assert set(ways) >= {*ALONE, "fusion", "map", "live_vehicle", "map_vehicle"}
    assert set(ways) >= {f"{how}_{sensor}" for how in ("live", "map") for sensor in ALONE}
    assert report["against"] == "truth"
    assert ways["map"]["grade_pct"]["rms"] < ways["fusion"]["grade_pct"]["rms"]
    assert ways["map"]["grade_pct"]["rms"] <= 1.05 * min(
        ways[f"map_{sensor}"]["grade_pct"]["rms"] for sensor in ALONE
    )
    assert abs(ways["map"]["hills_shift_m"]) < 10.0
    assert ways["gps"]["hills_shift_m"] is not None
    assert [each["bin_m"] for each in report["resolutions"]] == [1.0, 20.0, 100.0]
    rms_pct = [each["grade_pct"]["rms"] for each in report["resolutions"]]
    assert rms_pct[0] <= rms_pct[1] < rms_pct[2]
    assert report["masses"][0]["found_kg"] == pytest.approx(report["masses"][0]["true_kg"], rel=0.2)
    assert plot.stat().st_size > 10_000


def test_drives_without_a_truth_are_held_against_each_other(
    drives: list[Path], tmp_path: Path
) -> None:
    path = tmp_path / "slope.json"
    for folder in drives:
        text = (folder / "drive.toml").read_text()
        (folder / "unknown.toml").write_text(text.partition("[truth]")[0])
    evaluated("slope", *(folder / "unknown.toml" for folder in drives), "--json", path)
    report = report_of(path)
    assert report["against"] == "each other"
    assert report["ways"]["map"]["correlation"] > 0.9
    assert report["resolutions"][0]["grade_pct"] is None


def test_a_reference_goes_before_the_truth(drives: list[Path], tmp_path: Path) -> None:
    rows = ["lat_deg,lon_deg,heading_deg,grade_pct"]
    with (drives[0] / "truth.csv").open() as file:
        names = next(file).strip().split(",")
        for number, line in enumerate(file):
            row = dict(zip(names, line.strip().split(","), strict=True))
            if number % 10 == 0:
                grade_pct = float(row["grade_pct"]) + 1.0
                place = row["lat_deg"], row["lon_deg"], row["heading_deg"]
                rows.append(",".join((*place, f"{grade_pct}")))
    reference, path = tmp_path / "road.csv", tmp_path / "slope.json"
    reference.write_text("\n".join(rows) + "\n")
    evaluated("slope", drives[0], "--reference", reference, "--resolution", "20", "--json", path)
    report = report_of(path)
    assert report["against"] == "reference"
    assert report["ways"]["map"]["mean_pct"] == pytest.approx(-1.0, abs=0.1)


def test_the_map_after_each_run_is_told_with_the_shift_of_its_hills(
    drives: list[Path], tmp_path: Path
) -> None:
    path, plot = tmp_path / "map.json", tmp_path / "map.png"
    evaluated("slope-map", *drives, "--json", path, "--plot", plot)
    after = report_of(path)["after"]
    assert [each["runs"] for each in after] == [1, 2]
    assert all(abs(each["hills_shift_m"]) < 10.0 for each in after)
    assert plot.stat().st_size > 10_000
