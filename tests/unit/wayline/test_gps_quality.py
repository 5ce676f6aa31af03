"""What a fix is worth before any filter has seen it."""

import pytest

from builders import fix
from wayline.gps_quality import horizontal_std_m
from wayline.messages import FixKind
from wayline.tuning import Tuning

TUNING = Tuning()


@pytest.mark.parametrize(
    ("kind", "std_m"), [("gps", 6.0), ("dgps", 3.0), ("rtk_float", 0.9), ("rtk_fixed", 0.12)]
)
def test_corrections_make_a_fix_worth_more(kind: FixKind, std_m: float) -> None:
    assert horizontal_std_m(fix(0.0, 56.0, 10.0, fix=kind, hdop=2.0), TUNING) == pytest.approx(
        std_m
    )


def test_a_receiver_that_claims_centimetres_is_believed_with_corrections_only() -> None:
    alone = fix(0.0, 56.0, 10.0, h_std_m=0.05)
    fixed = fix(0.0, 56.0, 10.0, h_std_m=0.05, fix="rtk_fixed")
    assert horizontal_std_m(alone, TUNING) == TUNING.gps_position_std_floor_m
    assert horizontal_std_m(fixed, TUNING) == pytest.approx(0.05)


def test_few_satellites_make_a_fix_bad_whatever_its_kind() -> None:
    good = fix(0.0, 56.0, 10.0, fix="dgps", hdop=2.0, satellites=8)
    bad = fix(0.0, 56.0, 10.0, fix="dgps", hdop=2.0, satellites=3)
    assert horizontal_std_m(bad, TUNING) == TUNING.bad_gps_factor * horizontal_std_m(good, TUNING)
