"""A simulated town with canyons: walls displace altitudes by tens of metres, and air does not."""

from pathlib import Path

import numpy as np

from wayline_evaluation.pose_errors import compared
from wayline_evaluation.replays import needed_truth, replayed
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario_file import load_scenario


def test_the_altitude_neither_jumps_nor_claims_too_much(tmp_path: Path) -> None:
    """Files in, poses out; without the gate's patience it jumped by 79 m at a claimed 3 m."""
    folder = tmp_path / "canyon"
    simulate(load_scenario("canyon"), folder)
    run = replayed(folder, (), None)
    errors = compared(run.estimates, needed_truth(folder))
    known = ~np.isnan(errors.alt_m)
    off_m, std_m = np.abs(errors.alt_m[known]), errors.alt_std_m[known]
    raw_m = np.array([fix.alt_m for fix in run.fixes if fix.alt_m is not None])
    assert np.max(np.abs(np.diff(raw_m))) > 30.0
    assert np.max(np.abs(np.diff(run.estimates.alts_m[known]))) < 3.0
    assert np.mean(off_m <= 2.0 * std_m) >= 0.92
    assert np.percentile(off_m, 95.0) < 3.0
