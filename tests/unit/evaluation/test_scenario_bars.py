import math
from dataclasses import replace

import numpy as np
import pytest

from unit.evaluation.drives import SPEED_MPS, START_S, eastwards, off
from wayline.messages import GpsFix
from wayline_evaluation.estimates import Floats
from wayline_evaluation.pose_errors import PoseErrors, compared
from wayline_evaluation.scenario_bars import (
    canyon_ratio,
    cluster,
    fix_errors_m,
    moved_m,
    start,
    surrounded,
    trip,
    worst_m,
)
from wayline_simulator.course import Surroundings
from wayline_simulator.happenings import Change, Happenings, Span

TRUTH = eastwards()
SECONDS = TRUTH.times_s - START_S
SPAN = Span(START_S + 50.0, START_S + 60.0)


def errors(right_m: Floats | float) -> PoseErrors:
    return compared(off(TRUTH, right_m=right_m), TRUTH)


def test_a_move_is_counted_from_the_error_before_it() -> None:
    """Poses 2 m off all the way have not moved; those that jump by 5 m then have."""
    assert moved_m(errors(2.0), SPAN) == pytest.approx(0.0, abs=1e-6)
    assert moved_m(errors(np.where(SECONDS >= 52.0, 7.0, 2.0)), SPAN) == pytest.approx(5.0, 1e-3)


def test_a_move_long_after_a_fix_is_not_its_doing() -> None:
    """Later fixes move poses, too."""
    assert moved_m(errors(np.where(SECONDS >= 70.0, 7.0, 2.0)), SPAN) == pytest.approx(0, abs=1e-6)


def test_a_cluster_pulls_until_good_fixes_win() -> None:
    """100 m off in the span and for 4 s more."""
    pulled = np.where((SECONDS >= 55.0) & (SECONDS < 64.0), 100.0, 1.0)
    found = cluster(errors(pulled), SPAN)
    assert found.pull_m == pytest.approx(99.0, rel=1e-3)
    assert found.recovery_s == pytest.approx(4.0, abs=0.11)


def test_a_lock_out_never_recovers() -> None:
    """What stays off until the end of the drive was not won."""
    assert math.isinf(cluster(errors(np.where(SECONDS >= 55.0, 100.0, 1.0)), SPAN).recovery_s)
    assert cluster(errors(1.0), SPAN).recovery_s == 0.0


def test_surroundings_last_until_they_change() -> None:
    """The last ones until the end."""
    changes = (
        Change(10.0, Surroundings.OPEN),
        Change(20.0, Surroundings.GARAGE),
        Change(30.0, Surroundings.OPEN),
        Change(40.0, Surroundings.GARAGE),
    )
    happened = Happenings(surroundings=changes)
    assert surrounded(happened, Surroundings.GARAGE, 55.0) == (Span(20.0, 30.0), Span(40.0, 55.0))


def test_only_what_is_inside_counts() -> None:
    """The worst error outside is another's."""
    inside = errors(np.where(SECONDS >= 60.0, 50.0, 3.0))
    assert worst_m(inside, [SPAN]) == pytest.approx(3.0, rel=1e-3)
    assert worst_m(inside, []) is None


def test_canyons_compare_poses_with_their_raw_fixes() -> None:
    """Poses 2 m off where fixes are 20 m off: a tenth; the same drive without a canyon: nothing."""
    fix_times_s = START_S + np.arange(100.0)
    fixes_m = np.where(fix_times_s >= SPAN.start_s, 20.0, 1.0)
    assert canyon_ratio(errors(2.0), fix_times_s, fixes_m, [SPAN]) == pytest.approx(0.1, rel=1e-3)
    assert canyon_ratio(errors(2.0), fix_times_s, fixes_m, []) is None


def test_a_start_is_judged_ten_seconds_after_the_first_fix() -> None:
    """Not before, however wrong it was."""
    found = start(errors(np.where(SECONDS < 29.0, 90.0, 3.0)), START_S + 20.0)
    assert found.horizontal_m == pytest.approx(3.0, rel=1e-3)
    assert found.speed_mps == pytest.approx(0.5)
    late = start(errors(np.where(SECONDS < 31.0, 90.0, 3.0)), START_S + 20.0)
    assert late.horizontal_m == pytest.approx(90.0, rel=1e-3)


def test_fixes_are_measured_against_the_truth() -> None:
    """One that is 30 m to the north; blind epochs are none."""
    lat_deg, lon_deg = float(TRUTH.lats_deg[100]), float(TRUTH.lons_deg[100])
    t_ns = round((START_S + 10.0) * 1e9)
    fixes = [
        GpsFix(t_ns=t_ns, valid=True, lat_deg=lat_deg + 30.0 / 111_340.0, lon_deg=lon_deg),
        GpsFix(t_ns=t_ns, valid=False),
    ]
    times_s, fixes_m = fix_errors_m(fixes, TRUTH)
    assert times_s == pytest.approx([START_S + 10.0])
    assert fixes_m == pytest.approx([30.0], rel=1e-3)


def test_a_trip_is_judged_by_place_speed_and_length() -> None:
    """Poses 2 m off by fixes 4 m off, 0.5 m/s too slow, one percent too far."""
    poses = off(TRUTH, right_m=2.0)
    poses = replace(poses, distances_m=1.01 * SPEED_MPS * SECONDS)
    found = trip(poses, compared(poses, TRUTH), np.full(100, 4.0), TRUTH)
    assert found.position_ratio == pytest.approx(0.5, rel=1e-3)
    assert found.speed_mps == pytest.approx(0.5)
    assert found.distance_pct == pytest.approx(1.0, abs=1e-3)
