import numpy as np
import pytest

from unit.evaluation.drives import eastwards, off
from wayline_evaluation.accuracy import ScoredDrive, accuracy_report
from wayline_evaluation.figures import consistency_of, errors_of, figures_of
from wayline_evaluation.pose_errors import compared, pooled


def test_errors_have_their_sides() -> None:
    """Right and ahead of the truth are positive, and so is too much."""
    truth = eastwards()
    errors = compared(off(truth, right_m=3.0, ahead_m=-4.0, heading_deg=-2.0), truth)
    assert errors.cross_track_m == pytest.approx(3.0, abs=1e-3)
    assert errors.along_track_m == pytest.approx(-4.0, abs=1e-3)
    assert errors.horizontal_m == pytest.approx(5.0, abs=1e-3)
    assert errors.heading_deg == pytest.approx(-2.0)
    assert errors.speed_mps == pytest.approx(-0.5)
    assert errors.alt_m == pytest.approx(2.0)
    assert errors.north_m == pytest.approx(-3.0, abs=1e-3)


def test_cross_track_needs_no_true_heading() -> None:
    """The track of the truth has a direction of its own; headings are then not scored."""
    truth = eastwards(with_heading=False)
    errors = compared(off(truth, right_m=3.0), truth)
    assert errors.cross_track_m == pytest.approx(3.0, abs=0.01)
    assert errors_of(errors).heading_deg is None


def test_figures_are_of_absolute_values() -> None:
    """An error is as bad to the left as to the right; unknown ones do not count."""
    figures = figures_of(np.array([-3.0, 1.0, np.nan, 2.0]))
    assert figures is not None
    assert (figures.count, figures.p50, figures.max) == (3, 2.0, 3.0)
    assert figures.rms == pytest.approx(np.sqrt(14.0 / 3.0))
    assert figures_of(np.array([np.nan])) is None


def test_honest_stds_are_found_consistent() -> None:
    """Normal errors with the std that is told: 68.3 and 95.4 % inside, NEES 2 (within 4 sigma)."""
    truth, random = eastwards(1000.0), np.random.default_rng(1)
    shape = len(truth.times_s)
    right_m, ahead_m = 2.0 * random.standard_normal((2, shape))
    found = consistency_of(compared(off(truth, right_m=right_m, ahead_m=ahead_m, std_m=2.0), truth))
    for inside in (found.east, found.north, found.ellipse):
        assert inside is not None
        assert inside.one_sigma == pytest.approx(0.683, abs=0.02)
        assert inside.two_sigma == pytest.approx(0.954, abs=0.01)
    assert found.nees_mean == pytest.approx(2.0, abs=0.08)
    assert found.nees_p50 == pytest.approx(1.386, abs=0.07)


def test_boasting_stds_are_found_out() -> None:
    """Half the true std makes the NEES four times as large."""
    truth, random = eastwards(1000.0), np.random.default_rng(1)
    right_m, ahead_m = 2.0 * random.standard_normal((2, len(truth.times_s)))
    found = consistency_of(compared(off(truth, right_m=right_m, ahead_m=ahead_m, std_m=1.0), truth))
    assert found.nees_mean == pytest.approx(8.0, abs=0.3)


def test_dead_reckoning_has_figures_of_its_own() -> None:
    """An error in it does not hide among poses with GPS."""
    truth = eastwards()
    blind = truth.times_s >= truth.times_s[0] + 80.0
    poses = off(truth, right_m=np.where(blind, 9.0, 1.0), dead_from_s=80.0)
    report = accuracy_report([ScoredDrive("a", "truth", {"fusion": compared(poses, truth)})])
    parts = report.pooled.filters["fusion"].parts
    rms = {part: each.errors.horizontal_m.rms for part, each in parts.items()}  # type: ignore[union-attr]
    assert rms["gps"] == pytest.approx(1.0, abs=1e-3)
    assert rms["dead_reckoning"] == pytest.approx(9.0, abs=1e-3)


def test_many_drives_are_pooled_pose_by_pose() -> None:
    """A long drive counts more than a short one."""
    long, short = eastwards(99.9), eastwards(9.9)
    drives = [
        ScoredDrive("long", "truth", {"fusion": compared(off(long, right_m=1.0), long)}),
        ScoredDrive("short", "truth", {"fusion": compared(off(short, right_m=3.0), short)}),
    ]
    report = accuracy_report(drives)
    errors = report.pooled.filters["fusion"].parts["all"].errors.horizontal_m
    assert errors is not None
    assert errors.count == 1100
    assert errors.rms == pytest.approx(np.sqrt((1000.0 + 9.0 * 100.0) / 1100.0), abs=1e-3)
    assert len(pooled([drive.errors["fusion"] for drive in drives]).times_s) == 1100


def test_figures_are_told_as_multiples_of_the_yardstick() -> None:
    """Three metres where one is possible are 3."""
    truth = eastwards()
    errors = {
        "fusion": compared(off(truth, right_m=3.0), truth),
        "yardstick": compared(off(truth, right_m=1.0), truth),
    }
    ratios = accuracy_report([ScoredDrive("a", "truth", errors)]).pooled.ratios
    assert ratios["all"].horizontal_m is not None
    assert ratios["all"].horizontal_m.p95 == pytest.approx(3.0, abs=1e-3)


def test_poses_without_position_are_missing_and_not_near() -> None:
    """They are a share, not an error."""
    truth = eastwards()
    right_m = np.where(np.arange(len(truth.times_s)) < 101, np.nan, 1.0)
    report = accuracy_report(
        [ScoredDrive("a", "truth", {"fusion": compared(off(truth, right_m=right_m), truth)})]
    )
    fusion = report.pooled.filters["fusion"]
    assert fusion.missing_share == pytest.approx(101 / 1001)
    assert fusion.parts["all"].within_15_m_share == pytest.approx(900 / 1001)
