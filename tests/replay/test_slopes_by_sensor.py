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


@pytest.fixture(scope="module")
def errors_pct(tmp_path_factory: pytest.TempPathFactory) -> dict[str, float]:
    """RMS difference by sensor to the road's mean slope over the same way."""
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
    off_pct: dict[str, list[float]] = {}
    for line in (folder / "out" / "fusion_status.jsonl").read_text().splitlines():
        status = json.loads(line)
        now_m = np.interp(status["t_ns"] * 1e-9, t_s, along_m)
        climb_m = np.subtract(*np.interp([now_m, now_m - OVER_M], along_m, height_m))
        for slope in status["slopes"]:
            off = slope["slope_pct"] - 100.0 * climb_m / OVER_M
            off_pct.setdefault(slope["sensor"], []).append(off)
    return {sensor: float(np.sqrt(np.mean(np.square(off)))) for sensor, off in off_pct.items()}


def test_each_sensor_that_the_drive_has_tells_the_slope(errors_pct: dict[str, float]) -> None:
    """What the vehicle reports has a bias; the thesis's barometer a noise of 3 m."""
    assert set(errors_pct) == {"gps_altitude", "barometer", "torque", "vehicle_slope"}
    assert errors_pct["torque"] < 1.0
    assert errors_pct["gps_altitude"] < 1.2
    assert max(errors_pct.values()) < 3.0
