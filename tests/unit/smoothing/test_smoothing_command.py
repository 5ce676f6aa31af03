"""`wayline evaluate smoothing`: from a drive's folder to its tables."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from typer.testing import CliRunner, Result

from unit.trip_distance.journeys import Leg, journey
from wayline.errors import InputError
from wayline.messages import GpsFix
from wayline_cli.__main__ import app
from wayline_evaluation.smoothing.study import smoothing_study
from wayline_simulator.trips.files import simulate_trips
from wayline_simulator.trips.model import TripsModel

DRIVE = """[drive]
vehicle_id = "car"
[[avl]]
path = "fixes.csv"
[avl.columns]
time = "t"
lat_deg = "lat"
lon_deg = "lon"
heading_deg = "course"
speed_mps = "speed"
satellites = "satellites"
"""
TRIP = [Leg(60, 70.0, 12.0), Leg(20, 70.0, 0.0), Leg(120, 160.0, 15.0)]
FOUR = ["least_squares_spline", "kernel", "kalman", "modified_kalman"]


class Study(NamedTuple):
    """What a user sees, and what a program does."""

    shown: str
    report: dict[str, Any]


def written(folder: Path, fixes: Sequence[GpsFix], *, speed_scale: float = 1.0) -> Path:
    """The fixes as a drive of position reports."""
    folder.mkdir()
    rows = [
        f"{fix.t_ns * 1e-9:.0f},{fix.lat_deg:.7f},{fix.lon_deg:.7f},{fix.course_deg},"
        f"{(fix.speed_mps or 0.0) * speed_scale:.2f},{fix.satellites or 8}"
        for fix in fixes
    ]
    (folder / "fixes.csv").write_text("\n".join(["t,lat,lon,course,speed,satellites", *rows]))
    (folder / "drive.toml").write_text(DRIVE)
    return folder


def evaluated(*drives: Path, more: Sequence[str] = ()) -> Result:
    return CliRunner().invoke(app, ["evaluate", "smoothing", *map(str, drives), *more])


def studied(tmp_path: Path, *drives: Path) -> Study:
    path = tmp_path / "report.json"
    answer = evaluated(*drives, more=["--json", str(path)])
    assert answer.exit_code == 0, answer.output
    return Study(answer.output, json.loads(path.read_text()))


def refused(*drives: Path) -> str:
    """The one line of a study that ends with it (and status 2, as every command)."""
    answer = evaluated(*drives)
    assert isinstance(answer.exception, InputError)
    assert "\n" not in str(answer.exception)
    return str(answer.exception)


def test_six_methods_are_set_beside_the_receivers_own_speeds(tmp_path: Path) -> None:
    study = studied(tmp_path, written(tmp_path / "trip", journey(TRIP, speed_std_mps=0.1)))
    assert list(study.report["methods"]) == [*FOUR, "rts", "fusion"]
    assert study.report["references"] == {"receiver": 1}
    for method in study.report["methods"].values():
        assert method["distance"]["error_p50_pct"] < 3.0
    assert "table 4" in study.shown
    assert "(97.904)" in study.shown


def test_the_modified_filter_is_the_best_of_the_papers_four_on_simulated_trips(
    tmp_path: Path,
) -> None:
    trips = simulate_trips(TripsModel(vehicles=3, trips=4, seed=2), tmp_path / "trips")
    report = smoothing_study([trip.folder for trip in trips], 0, 1, lambda _, __: None)
    off_m = {name: report.methods[name].distance.errors_m.mean_absolute for name in report.methods}
    assert min(FOUR, key=lambda name: off_m[name]) == "modified_kalman"  # type: ignore[index]
    assert off_m["kernel"] > 10.0 * off_m["modified_kalman"]
    assert off_m["rts"] < 0.05 * 1_609.344
    assert report.references == {"truth": 12}


def test_three_fixes_are_too_few(tmp_path: Path) -> None:
    line = refused(written(tmp_path / "short", journey([Leg(3, 0.0, 10.0)])))
    assert "3 fixes are too few to smooth" in line


def test_a_short_trip_is_left_out_and_named(tmp_path: Path) -> None:
    short = written(tmp_path / "short", journey([Leg(3, 0.0, 10.0)]))
    study = studied(tmp_path, short, written(tmp_path / "long", journey(TRIP)))
    assert [trip["trip"] for trip in study.report["trips"]] == ["long"]
    assert "left out: 3 fixes" in study.report["notes"]["short"][0]
    assert "short" in study.shown


def test_knots_taken_as_metres_a_second_are_refused_with_the_mend(tmp_path: Path) -> None:
    line = refused(written(tmp_path / "knots", journey(TRIP), speed_scale=1.0 / 0.514444))
    assert "speeds are 1.94 times what positions say: knots taken as m/s" in line
    assert "scale = 0.514444" in line


def test_bad_fixes_throughout_are_told(tmp_path: Path) -> None:
    study = studied(tmp_path, written(tmp_path / "bad", journey(TRIP, satellites=3)))
    assert study.report["bad_fixes"] == 200
    assert "no fix is good" in study.report["notes"]["bad"][0]


def test_time_that_goes_back_is_told(tmp_path: Path) -> None:
    """Ingest lets a clock that was set back go on."""
    fixes = journey(TRIP)
    study = studied(tmp_path, written(tmp_path / "back", [*fixes[:100], *fixes[90:]]))
    assert "inputs were dropped or mended" in study.report["notes"]["back"][0]


def test_constant_speed_has_no_t_test_and_no_error(tmp_path: Path) -> None:
    """Nothing divides by a variance of 0."""
    study = studied(tmp_path, written(tmp_path / "even", journey([Leg(300, 30.0, 20.0)])))
    for method in study.report["methods"].values():
        assert abs(method["speed_mps"]["mean"]) < 0.01
        assert method["distance"]["against_reference"]["p_value"] is None


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_picture_is_drawn_and_jobs_change_nothing(tmp_path: Path, jobs: str) -> None:
    drives = [written(tmp_path / name, journey(TRIP, seed=n)) for n, name in enumerate("ab")]
    picture = tmp_path / "study.png"
    answer = evaluated(*drives, more=["--plot", str(picture), "--jobs", jobs, "--fusion", "0"])
    assert answer.exit_code == 0, answer.output
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert "fusion" not in answer.output
