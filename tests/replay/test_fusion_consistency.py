"""Whether fusion is as sure as it may be, on a few simulated drives pooled.

Some wider than the bars of docs/fusion.md, which are measured on many more drives.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from builders import only, run_core
from wayline.drive_file import load_drive
from wayline.messages import FusionStatus, Pose, Verdict
from wayline_evaluation.estimates import estimates_of
from wayline_evaluation.pose_errors import PoseErrors, compared, pooled
from wayline_evaluation.replays import needed_truth
from wayline_fusion.core import FusionCore
from wayline_replay.outages import Outage, with_outages
from wayline_replay.stream import DriveStream
from wayline_simulator.drive_folder import simulate
from wayline_simulator.scenario import overlaid
from wayline_simulator.scenario_file import load_scenario

DRIVES = [("main-road", 11), ("main-road", 12), ("main-road", 13), ("town", 14), ("town", 15)]
SETTLED_S = 120.0
OUTAGE = Outage(200.0, 60.0)
ONE_SIGMA, TWO_SIGMA = (0.50, 0.86), (0.85, 1.0)
"""0.68 and 0.95, give or take what so few drives scatter."""
Floats = NDArray[np.float64]


class Driven(NamedTuple):
    """All drives together."""

    errors: PoseErrors
    verdicts: list[Verdict]

    def nis(self, sensor: str) -> Floats:
        """Of the accepted measurements of a sensor."""
        return np.array([v.nis for v in self.verdicts if v.sensor == sensor and v.accepted])


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Driven:
    errors, verdicts = [], []
    for scenario, seed in DRIVES:
        folder = tmp_path_factory.mktemp(f"{scenario}-{seed}")
        of_drive, told = drive(scenario, seed, folder)
        errors.append(of_drive)
        verdicts += told
    return Driven(pooled(errors), verdicts)


def drive(scenario: str, seed: int, folder: Path) -> tuple[PoseErrors, list[Verdict]]:
    few: dict[str, object] = {"sensors": ["gps", "gyro", "odometer"]}
    wanted = {**few, "seed": seed, "road": {"length_m": 5000.0}}
    simulate(overlaid(load_scenario(scenario), wanted), folder)
    loaded = load_drive(folder)
    messages = with_outages(DriveStream(loaded, str(folder)), [OUTAGE])
    outputs = run_core(FusionCore(loaded.tuning), [received.message for received in messages])
    errors = compared(estimates_of(only(outputs, Pose)), needed_truth(folder))
    settled = errors.where(errors.times_s - errors.times_s[0] >= SETTLED_S)
    statuses = only(outputs, FusionStatus)
    return settled, [verdict for status in statuses for verdict in status.verdicts]


def shares_within(errors: Floats, stds: Floats) -> tuple[float, float]:
    """Of one and of two sigmas, where known."""
    known = ~(np.isnan(errors) | np.isnan(stds))
    sigmas = np.abs(errors[known]) / stds[known]
    return float(np.mean(sigmas <= 1.0)), float(np.mean(sigmas <= 2.0))


def assert_consistent(errors: Floats, stds: Floats) -> None:
    one, two = shares_within(errors, stds)
    assert ONE_SIGMA[0] <= one <= ONE_SIGMA[1]
    assert TWO_SIGMA[0] <= two <= TWO_SIGMA[1]


def test_the_position_is_as_wrong_as_it_says(driven: Driven) -> None:
    errors = driven.errors
    assert_consistent(
        np.concatenate((errors.east_m, errors.north_m)),
        np.concatenate((errors.east_std_m, errors.north_std_m)),
    )


def test_the_heading_is_as_wrong_as_it_says(driven: Driven) -> None:
    assert_consistent(driven.errors.heading_deg, driven.errors.heading_std_deg)


def test_in_outages_it_is_as_wrong_as_it_says(driven: Driven) -> None:
    """A minute each: few, so only that two sigmas hold most and one not all."""
    blind = driven.errors.where(driven.errors.dead_reckoning)
    one, two = shares_within(blind.east_m, blind.east_std_m)
    assert 0.35 <= one <= 0.95
    assert two >= 0.8
    assert np.nanpercentile(blind.horizontal_m, 95) < 30.0


@pytest.mark.parametrize(
    ("sensor", "dimension"),
    [("gps_position", 2), ("gps_course", 1), ("gps_speed", 1)],
)
def test_innovations_are_as_large_as_expected(driven: Driven, sensor: str, dimension: int) -> None:
    """The mean of the NIS of accepted measurements, within a factor of three."""
    nis = driven.nis(sensor)
    assert len(nis) > 1000
    assert dimension / 3.0 < nis.mean() < dimension * 3.0


def test_few_good_measurements_are_rejected(driven: Driven) -> None:
    """Streets of a town reflect now and then; a main road does not."""
    positions = [v for v in driven.verdicts if v.sensor == "gps_position"]
    assert np.mean([v.accepted for v in positions]) > 0.75
    courses = [v for v in driven.verdicts if v.sensor == "gps_course"]
    assert np.mean([v.accepted for v in courses]) > 0.95
