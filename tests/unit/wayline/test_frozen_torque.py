"""A torque that stays the same however far the vehicle drives is none."""

from collections.abc import Sequence

import pytest

from wayline.messages import Torque
from wayline.vertical.frozen_torque import LONGEST_M, FrozenTorque

NOW_NS = 1_700_000_000_000_000_000


def frozen_over(torques_nm: Sequence[float | None], step_m: float) -> list[bool]:
    watch = FrozenTorque()
    return [
        watch.is_frozen(Torque(t_ns=NOW_NS + k, engine_torque_nm=torque_nm), k * step_m)
        for k, torque_nm in enumerate(torques_nm)
    ]


@pytest.mark.parametrize("torque_nm", [300.0, 0.0, -40.0])
def test_one_that_repeats_is_frozen_after_half_a_kilometre(torque_nm: float) -> None:
    found = frozen_over([torque_nm] * 20, 0.1 * LONGEST_M)
    assert found == [False] * 11 + [True] * 9


def test_one_that_changes_is_believed_again() -> None:
    assert frozen_over([300.0] * 20 + [310.0, 310.0], 50.0)[-3:] == [True, False, False]


def test_a_vehicle_that_stands_repeats_its_idling() -> None:
    assert not any(frozen_over([60.0] * 2_000, 0.0))


def test_frames_without_a_torque_neither_freeze_nor_free_it() -> None:
    found = frozen_over([300.0, None] * 12, 50.0)
    assert found[1::2] == [False] * 12
    assert found[-2]
