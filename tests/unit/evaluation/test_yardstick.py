import dataclasses
from functools import cache

import msgspec
import numpy as np
import pytest
from scipy.stats import chi2

from unit.evaluation.told_drives import FACTS, START_S, blocks, poses_s, sensed, truth
from unit.simulator.journeys import WHEEL_RADIUS_M
from wayline_evaluation.pose_errors import PoseErrors, compared, pooled
from wayline_evaluation.sensed import Series
from wayline_evaluation.yardstick_run import told_estimates
from wayline_simulator.course import Surroundings
from wayline_simulator.gps_events import GpsEvents, Outage
from wayline_simulator.happenings import Happenings, Span, happenings
from wayline_simulator.journey import Journey

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


def test_told_of_walls_it_stays_honest_among_them() -> None:
    """Reflections of 3 m: NEES in its band, and outside where it believes in an open sky."""
    journey = among(Surroundings.STREET)
    told = happenings(journey, GpsEvents(), START_S, WHEEL_RADIUS_M)
    low, high = band(2)
    assert low < np.mean(last_nees(journey, told)) < high
    assert np.mean(last_nees(journey, Happenings())) > high


def test_a_fix_that_an_event_moved_moves_nothing() -> None:
    """It is told which one; 1e-9 degrees are 0.1 mm, by which the grid's north changes."""
    journey = blocks(1)
    drive = sensed(journey, 1)
    row = len(drive.fixes) // 2
    lat_deg = drive.fixes[row].lat_deg
    assert lat_deg is not None
    moved = msgspec.structs.replace(drive.fixes[row], lat_deg=lat_deg + 7e-5)
    fixes = (*drive.fixes[:row], moved, *drive.fixes[row + 1 :])
    stamped_s = moved.t_ns * 1e-9
    told = Happenings(displaced=(Span(stamped_s - 0.5, stamped_s + 0.5),))
    facts = msgspec.structs.replace(FACTS, happenings=told)
    one, other = (
        told_estimates(
            poses_s(journey),
            dataclasses.replace(drive, fixes=each),
            facts,
            grade_walk_pct2_per_m=1e-4,
        )
        for each in (drive.fixes, fixes)
    )
    assert one.lats_deg == pytest.approx(other.lats_deg, abs=1e-9)


def test_it_bridges_wheels_that_are_locked() -> None:
    """Half a second of zeros at 12 m/s costs it less than 0.5 m instead of 6 m."""
    journey = blocks(1)
    drive = sensed(journey, 2)
    wheels, lock = drive.speed_mps, Span(START_S + 30.0, START_S + 30.5)
    stuck = (wheels.times_s >= lock.start_s) & (wheels.times_s < lock.end_s)
    locked = Series(wheels.times_s, np.where(stuck, 0.0, wheels.values))
    facts = msgspec.structs.replace(FACTS, happenings=Happenings(slips=(lock,)))
    free, bridged = (
        told_estimates(
            poses_s(journey),
            dataclasses.replace(drive, speed_mps=each),
            facts,
            grade_walk_pct2_per_m=1e-4,
        ).distances_m[-1]
        for each in (wheels, locked)
    )
    assert bridged == pytest.approx(free, abs=0.5)


def among(surroundings: Surroundings) -> Journey:
    """The blocks, with the same surroundings everywhere."""
    journey = blocks(4)
    kinds = np.full_like(journey.course.surroundings, surroundings)
    return dataclasses.replace(
        journey, course=dataclasses.replace(journey.course, surroundings=kinds)
    )


def last_nees(journey: Journey, told: Happenings) -> list[float]:
    """Of independent drives, at one instant."""
    facts = msgspec.structs.replace(FACTS, happenings=told)
    known, found = truth(journey), []
    for seed in range(DRIVES):
        drive = sensed(journey, seed)
        estimates = told_estimates(poses_s(journey), drive, facts, grade_walk_pct2_per_m=1e-4)
        found.append(float(compared(estimates, known).nees()[LAST]))
    return found
