"""What each sensor alone says of the slope, from a drive's files to `fusion_status`."""

import csv
import json

import numpy as np
import pytest

from wayline_fusion.evidence.slopes_told import OVER_M
from wayline_replay.replay import replay
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario import Scenario, overlaid

TRUCK = overlaid(
    Scenario(preset="thesis", vehicle="truck"),
    {"seed": 64, "road": {"kind": "main", "length_m": 6000.0, "open_sky": True}},
)


Beside = tuple[list[float], list[float]]


@pytest.fixture(scope="module")
def slopes_pct(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Beside]:
    """By sensor what it told, and the road's mean slope over the same way."""
    folder = tmp_path_factory.mktemp("truck")
    (drive,) = simulate(TRUCK, folder)
    replay(drive.folder, folder / "out")
    with (drive.folder / "truth.csv").open() as file:
        rows = [
            [float(row[name]) for name in ("t_s", "speed_mps", "grade_pct")]
            for row in csv.DictReader(file)
        ]
    t_s, speed_mps, grade_pct = np.array(rows).T
    steps_m = speed_mps[1:] * np.diff(t_s)
    along_m = np.concatenate(([0.0], np.cumsum(steps_m)))
    height_m = np.concatenate(([0.0], np.cumsum(grade_pct[1:] / 100.0 * steps_m)))
    beside: dict[str, Beside] = {}
    for line in (folder / "out" / "fusion_status.jsonl").read_text().splitlines():
        status = json.loads(line)
        now_m = np.interp(status["t_ns"] * 1e-9, t_s, along_m)
        climb_m = np.subtract(*np.interp([now_m, now_m - OVER_M], along_m, height_m))
        for slope in status["slopes"]:
            told_pct, true_pct = beside.setdefault(slope["sensor"], ([], []))
            told_pct.append(slope["slope_pct"])
            true_pct.append(100.0 * climb_m / OVER_M)
    return beside


def test_each_sensor_that_the_drive_has_tells_the_slope(slopes_pct: dict[str, Beside]) -> None:
    """What the vehicle reports has a bias; the thesis's barometer a noise of 3 m."""
    alike = {sensor: np.corrcoef(*beside)[0, 1] for sensor, beside in slopes_pct.items()}
    assert set(alike) == {"gps_altitude", "barometer", "torque", "vehicle_slope"}
    assert min(alike["torque"], alike["gps_altitude"]) > 0.9
    assert alike["barometer"] > 0.7
    assert alike["vehicle_slope"] > 0.6
    for sensor, most_pct in (("torque", 1.0), ("gps_altitude", 1.2)):
        assert np.sqrt(np.mean(np.square(np.subtract(*slopes_pct[sensor])))) < most_pct
