"""Who is believed when measurements go on being rejected."""

import math
from functools import partial

import pytest

from builders import at
from wayline.agreement import Agreement, rejected
from wayline.tuning import Tuning
from wayline_fusion.aids.course import are_alike as courses_are_alike
from wayline_fusion.aids.position import are_alike as positions_are_alike
from wayline_fusion.aids.position import patience_s

TUNING = Tuning()


def courses(*offs_deg: float) -> Agreement:
    agreement: Agreement | None = None
    for second, off_deg in enumerate(offs_deg):
        off_rad = math.radians(off_deg)
        agreement = rejected(agreement, at(second), (off_rad,), courses_are_alike)
    assert agreement is not None
    return agreement


def positions(*offs_m: float) -> Agreement:
    agreement: Agreement | None = None
    for second, off_m in enumerate(offs_m):
        alike = partial(positions_are_alike, 10.0)
        agreement = rejected(agreement, at(second), (off_m, 0.0), alike)
    assert agreement is not None
    return agreement


def test_courses_to_one_side_agree_also_while_the_vehicle_turns() -> None:
    assert courses(3.0, 3.5, 5.0, 9.0).agreed_s == 3.0


def test_courses_that_scatter_do_not_agree() -> None:
    assert courses(3.0, -3.0, 3.0).agreed_s == 0.0
    assert courses(4.0, 3.0, 0.8, 4.0).agreed_s == 1.0


def test_rejected_courses_are_forgotten_after_a_while() -> None:
    agreement = rejected(courses(3.0, 3.0, 3.0), at(60), (math.radians(3.0),), courses_are_alike)
    assert agreement.agreed_s == 0.0
    assert agreement.first_ns == at(60)


def test_positions_agree_that_are_displaced_alike() -> None:
    assert positions(50.0, 52.0, 49.0).agreed_s == 2.0
    assert positions(50.0, 52.0, 90.0).agreed_s == 0.0
    assert positions(50.0, 52.0, 90.0).first_ns == at(0)
    assert positions(50.0, 52.0).distance == pytest.approx(52.0)


def test_positions_are_believed_after_as_long_as_the_others_had_agreed() -> None:
    assert patience_s(0.0, 60.0, TUNING, is_likely=False) == 60.0
    assert patience_s(0.0, 1.0, TUNING, is_likely=False) == TUNING.relock_at_once_s
    assert patience_s(0.0, 9999.0, TUNING, is_likely=False) == TUNING.relock_after_s


def test_after_an_outage_dead_reckoning_is_doubted_sooner_and_likely_positions_at_once() -> None:
    waits_s = [patience_s(460.0, 300.0, TUNING, is_likely=likely) for likely in (False, True)]
    assert waits_s == [TUNING.relock_after_outage_s, TUNING.relock_at_once_s]
