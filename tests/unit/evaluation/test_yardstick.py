from functools import cache

import numpy as np
import pytest
from scipy.stats import chi2

from unit.evaluation.drives import eastwards
from unit.evaluation.told_drives import FACTS, blocks, poses_s, sensed, truth
from wayline_evaluation.pose_errors import PoseErrors, compared, pooled
from wayline_evaluation.sensed import Sensed, Series
from wayline_evaluation.wheel_wander import wheel_wander
from wayline_evaluation.yardstick_run import told_estimates
from wayline_simulator.gps_events import Outage

DRIVES = 14
LAST = -50
"""A pose of the last side, after the outage."""
OUTAGE = Outage(start_s=60.0, length_s=40.0)


@cache
def drives() -> tuple[PoseErrors, ...]:
    """Independent drives round four blocks, with an outage."""
    journey = blocks(4)
    known = truth(journey)
    return tuple(
        compared(
            told_estimates(
                poses_s(journey),
                sensed(journey, seed, OUTAGE),
                FACTS,
                grade_walk_pct2_per_m=1e-4,
            ),
            known,
        )
        for seed in range(DRIVES)
    )


def band(dimensions: int) -> tuple[float, float]:
    """Where the mean of the drives' normalised squares lies in 99.9 % of all studies."""
    low, high = chi2.ppf([0.0005, 0.9995], dimensions * DRIVES) / DRIVES
    return float(low), float(high)


def test_the_positions_covariance_is_honest() -> None:
    """NEES over independent drives in its chi-square band, with GPS and in the outage."""
    low, high = band(2)
    for row in (LAST, int((OUTAGE.start_s + OUTAGE.length_s - 31.0) * 10.0)):
        nees = [errors.nees()[row] for errors in drives()]
        assert low < np.mean(nees) < high


def test_the_headings_std_is_honest() -> None:
    """The same of the heading's error squared in its variance."""
    low, high = band(1)
    squares = [
        np.square(errors.heading_deg[LAST] / errors.heading_std_deg[LAST]) for errors in drives()
    ]
    assert low < np.mean(squares) < high


def test_the_altitudes_std_is_honest() -> None:
    """The same of the altitude."""
    low, high = band(1)
    squares = [np.square(errors.alt_m[LAST] / errors.alt_std_m[LAST]) for errors in drives()]
    assert low < np.mean(squares) < high


def test_it_is_better_than_its_fixes() -> None:
    """Heading to 0.2 degrees and speed to 0.05 m/s: Doppler and gyro each tell half of it."""
    errors = pooled(drives())
    assert np.sqrt(np.nanmean(np.square(errors.heading_deg))) < 0.2
    assert np.sqrt(np.nanmean(np.square(errors.speed_mps))) < 0.05


def test_it_knows_when_it_is_blind() -> None:
    """From 2 s after the last fix until the first one."""
    seconds = np.arange(len(drives()[0].times_s)) / 10.0 + 30.0
    blind = seconds[drives()[0].dead_reckoning]
    assert blind.min() == pytest.approx(OUTAGE.start_s + 1.0, abs=0.3)
    assert blind.max() >= OUTAGE.start_s + OUTAGE.length_s - 0.2


def test_wheels_that_wander_are_measured_against_the_truth() -> None:
    """Wheels that read 1 % high and low by turns of 40 s: std 1 %, correlated over such a time."""
    known = eastwards(400.0)
    high = np.where((known.times_s - known.times_s[0]) % 80.0 < 40.0, 1.01, 0.99)
    wheels = Series(known.times_s, 10.0 * high)
    nothing = Series(np.array([]), np.array([]))
    drive = Sensed(known.times_s[0], known.times_s[-1], (), wheels, nothing, nothing, nothing)
    wander = wheel_wander(drive, known)
    assert wander is not None
    assert wander.std == pytest.approx(0.01, abs=0.001)
    assert 5.0 < wander.time_s < 40.0
