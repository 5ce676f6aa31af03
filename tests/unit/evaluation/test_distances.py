"""`wayline evaluate distance`: how far drives went, beside what they are judged by."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from unit.smoothing.test_smoothing_command import DRIVE, TRIP, written
from unit.trip_distance.journeys import Leg, journey, with_hole
from wayline.errors import InputError
from wayline.trip_distance.wording import in_km
from wayline_cli.__main__ import app
from wayline_simulator.trips.files import simulate_trips
from wayline_simulator.trips.model import TripsModel

AROUND = [Leg(60, 90.0, 12.0), Leg(60, 0.0, 12.0), Leg(60, 90.0, 12.0), Leg(61, 180.0, 12.0)]


def evaluated(tmp_path: Path, *drives: Path) -> tuple[str, dict[str, Any]]:
    """What a user sees, and what a program does."""
    path = tmp_path / "report.json"
    command = ["evaluate", "distance", *map(str, drives), "--json", str(path)]
    answer = CliRunner().invoke(app, command)
    assert answer.exit_code == 0, answer.output
    return answer.output, json.loads(path.read_text())


def test_simulated_trips_are_measured_within_a_hundredth(tmp_path: Path) -> None:
    """Holes of up to a kilometre and fixes of few satellites are in them."""
    trips = simulate_trips(TripsModel(vehicles=3, trips=8, seed=4), tmp_path / "trips")
    shown, report = evaluated(tmp_path, *(trip.folder for trip in trips))
    assert {drive["reference"] for drive in report["drives"]} == {"truth"}
    assert report["error_p50_pct"] < 0.2
    assert report["error_p95_pct"] < 1.0
    assert report["in_two_std"] >= 0.9
    assert "+/-" in shown


def test_a_drives_route_bridges_its_hole(tmp_path: Path) -> None:
    """1.8 km of the way are in it, and 1.0 km of chord."""
    fixes = journey(AROUND)
    folder = written(tmp_path / "around", with_hole(fixes, 50, 200))
    _, plain = evaluated(tmp_path, folder)
    line = [[fix.lon_deg, fix.lat_deg] for fix in fixes]
    feature = {
        "type": "Feature",
        "properties": {"route_id": "A", "name": "A", "loop": False, "speeds_mps": [12.0] * 240},
        "geometry": {"type": "LineString", "coordinates": line},
    }
    route = {"type": "FeatureCollection", "features": [feature]}
    (folder / "route.geojson").write_text(json.dumps(route))
    (folder / "drive.toml").write_text(DRIVE + '[route]\npath = "route.geojson"\n')
    _, along = evaluated(tmp_path, folder)
    assert along["drives"][0]["measured"]["distance_m"] == pytest.approx(240 * 12.0, rel=0.01)
    assert plain["drives"][0]["measured"]["distance_m"] < 230 * 12.0


def test_speeds_in_knots_are_measured_by_positions_and_judge_nothing(tmp_path: Path) -> None:
    folder = written(tmp_path / "knots", journey(TRIP), speed_scale=1.0 / 0.514444)
    shown, report = evaluated(tmp_path, folder)
    drive = report["drives"][0]
    assert drive["measured"]["basis"] == "positions"
    assert drive["measured"]["distance_m"] == pytest.approx(60 * 12.0 + 120 * 15.0, rel=0.01)
    assert (drive["reference"], drive["error_pct"]) == (None, None)
    assert "knots taken as m/s" in shown


def test_one_fix_tells_no_distance(tmp_path: Path) -> None:
    folder = written(tmp_path / "one", journey([Leg(1, 0.0, 10.0)]))
    answer = CliRunner().invoke(app, ["evaluate", "distance", str(folder)])
    assert isinstance(answer.exception, InputError)
    assert "nothing in it tells how far it went" in str(answer.exception)


@pytest.mark.parametrize(
    ("distance_m", "std_m", "text"),
    [
        (12_345.6, 104.0, "12.3 +/- 0.1"),
        (12_345.6, 21.0, "12.35 +/- 0.02"),
        (12_345.6, 3.0, "12.346 +/- 0.003"),
        (2_345.6, 1_400.0, "2.3 +/- 1.4"),
    ],
)
def test_a_distance_has_as_many_digits_as_its_std(
    distance_m: float, std_m: float, text: str
) -> None:
    assert in_km(distance_m, std_m) == text
