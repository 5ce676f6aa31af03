"""Who is believed when positions or courses go on being rejected."""

import math

from builders import at
from wayline.tuning import Tuning
from wayline_fusion.evidence.lockout import (
    CourseLockout,
    Lockout,
    course_rejected,
    patience_s,
    rejected,
)

TUNING = Tuning()


def courses(*offs_deg: float) -> CourseLockout:
    lockout: CourseLockout | None = None
    for second, off_deg in enumerate(offs_deg):
        lockout = course_rejected(lockout, at(second), math.radians(off_deg))
    assert lockout is not None
    return lockout


def positions(*offs_m: float, unaided_s: float = 0.0) -> Lockout:
    lockout: Lockout | None = None
    for second, off_m in enumerate(offs_m):
        lockout = rejected(lockout, at(second), (off_m, 0.0), 2.0, unaided_s)
    assert lockout is not None
    return lockout


def test_courses_to_one_side_agree_also_while_the_vehicle_turns() -> None:
    assert courses(3.0, 3.5, 5.0, 9.0).agreed_s == 3.0


def test_courses_that_scatter_do_not_agree() -> None:
    assert courses(3.0, -3.0, 3.0).agreed_s == 0.0
    assert courses(4.0, 3.0, 0.8, 4.0).agreed_s == 1.0


def test_rejected_courses_are_forgotten_after_a_while() -> None:
    lockout = course_rejected(courses(3.0, 3.0, 3.0), at(60), math.radians(3.0))
    assert lockout.agreed_s == 0.0


def test_positions_agree_that_are_displaced_alike() -> None:
    assert positions(50.0, 52.0, 49.0).agreed_s == 2.0
    assert positions(50.0, 52.0, 90.0).agreed_s == 0.0


def test_positions_are_believed_after_as_long_as_the_others_had_agreed() -> None:
    lockout = positions(50.0)
    assert patience_s(lockout, 60.0, TUNING, is_likely=False) == 60.0
    assert patience_s(lockout, 1.0, TUNING, is_likely=False) == TUNING.relock_at_once_s
    assert patience_s(lockout, 9999.0, TUNING, is_likely=False) == TUNING.relock_after_s


def test_after_an_outage_dead_reckoning_is_doubted_sooner_and_likely_positions_at_once() -> None:
    lockout = positions(700.0, unaided_s=460.0)
    waits_s = [patience_s(lockout, 300.0, TUNING, is_likely=likely) for likely in (False, True)]
    assert waits_s == [TUNING.relock_after_outage_s, TUNING.relock_at_once_s]
