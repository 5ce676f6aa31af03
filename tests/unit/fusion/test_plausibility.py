"""Readings that no vehicle can cause, told from those that it can."""

import pytest

from builders import at, fix, gyro, odometer, only, run_core
from unit.fusion.drives import ORIGIN
from wayline.messages import Barometer, FusionStatus, GpsFix, Message
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.intake.plausibility import Plausibility, within_reason

FROZEN = "the receiver repeats a position that the vehicle has left"


def refusals(messages: list[Message]) -> list[str | None]:
    plausibility = Plausibility()
    return [plausibility.refusal(message, "gps-ingest") for message in messages]


def still_fix(seconds: float, **fields: float) -> GpsFix:
    return fix(seconds, 56.0, 10.0, **fields)


@pytest.mark.parametrize(
    ("speed_mps", "rate_degps", "refused"),
    [(0.0, 90.0, False), (3.0, 90.0, False), (15.0, 40.0, False), (15.0, 90.0, True),
     (0.0, 400.0, True), (15.0, -90.0, True)],
)  # fmt: skip
def test_a_turn_is_refused_where_no_tyre_holds_it(
    speed_mps: float, rate_degps: float, refused: bool
) -> None:
    _, reason = refusals([odometer(0.0, speed_mps), gyro(0.1, rate_degps)])
    assert (reason is not None) is refused


def test_an_old_speed_says_nothing_of_a_turn() -> None:
    assert refusals([odometer(0.0, 30.0), gyro(2.0, 90.0)]) == [None, None]


@pytest.mark.parametrize("source", ["wheels", "fixes"])
def test_a_repeated_position_is_refused_once_the_vehicle_has_left_it(source: str) -> None:
    """20 m by the wheels, or by the speed that the fixes themselves tell."""
    messages: list[Message] = []
    for second in range(10):
        if source == "wheels":
            messages += [odometer(second, 10.0), odometer(second + 0.5, 10.0)]
        messages.append(still_fix(second, speed_mps=10.0 if source == "fixes" else 0.0))
    reasons = [
        reason
        for message, reason in zip(messages, refusals(messages), strict=True)
        if isinstance(message, GpsFix)
    ]
    assert reasons[:3] == [None] * 3
    assert set(reasons[4:]) == {FROZEN}


def test_a_parked_vehicles_receiver_may_repeat_itself() -> None:
    messages: list[Message] = []
    for second in range(100):
        messages += [odometer(second, 0.0), still_fix(second, speed_mps=0.0)]
    assert set(refusals(messages)) == {None}


def test_a_receiver_that_moves_again_is_used_again() -> None:
    messages: list[Message] = [still_fix(second, speed_mps=10.0) for second in range(10)]
    messages.append(fix(10.0, 56.001, 10.0, speed_mps=10.0))
    assert refusals(messages)[-2:] == [FROZEN, None]


def test_one_frozen_receiver_does_not_speak_for_another() -> None:
    plausibility = Plausibility()
    frozen, alive = [], []
    for second in range(10):
        frozen.append(plausibility.refusal(still_fix(second, speed_mps=10.0), "gps-ingest"))
        moving = fix(second, 56.0 + second * 1e-4, 10.0, speed_mps=10.0)
        alive.append(plausibility.refusal(moving, "gps-ingest-2"))
    assert frozen[-1] == FROZEN
    assert set(alive) == {None}


def test_refusals_are_counted_each_and_told_once_a_second() -> None:
    """A gyro in wrong units must not flood the bus with verdicts."""
    messages: list[Message] = [fix(0.0, *ORIGIN)]
    messages += [gyro(step * 0.01, 1000.0) for step in range(500)]
    statuses = only(run_core(FusionCore(Tuning()), messages), FusionStatus)
    told = [v for status in statuses for v in status.verdicts if v.sensor == "gyro"]
    assert len(told) == 5
    assert statuses[-1].rejected > 300
    assert {verdict.reason for verdict in told} == {"no vehicle turns so fast"}


def test_a_receiver_is_neither_certain_nor_beyond_use() -> None:
    """Stds of 1e-30 or 1e300 would end in certainty for ever, or in an overflow."""
    claimed = still_fix(0.0, h_std_m=1e300, speed_std_mps=1e-30, hdop=1e300, alt_m=-1e16)
    used = within_reason(claimed)
    assert (used.h_std_m, used.speed_std_mps, used.hdop, used.alt_m) == (1e4, 1e-2, 100.0, None)
    ordinary = still_fix(0.0, h_std_m=3.0, speed_std_mps=0.1, hdop=1.2, alt_m=80.0)
    assert within_reason(ordinary) == ordinary


@pytest.mark.parametrize("what", ["h_std_m", "speed_std_mps", "course_std_deg", "v_std_m"])
@pytest.mark.parametrize("value", [1e-300, 1e300])
def test_absurd_stds_do_no_harm(what: str, value: float) -> None:
    messages: list[Message] = []
    for second in range(5):
        absurd = {"speed_mps": 10.0, "course_deg": 0.0, "alt_m": 50.0, what: value}
        messages += [odometer(second, 10.0), fix(second, 56.0 + 9e-5 * second, 10.0, **absurd)]
    statuses = only(run_core(FusionCore(Tuning()), messages), FusionStatus)
    assert not [v for status in statuses for v in status.verdicts if v.sensor == "filter"]


@pytest.mark.parametrize(("pressure_pa", "refused"), [(101_325.0, False), (5e299, True)])
def test_air_is_refused_that_no_road_has(pressure_pa: float, refused: bool) -> None:
    (reason,) = refusals([Barometer(t_ns=at(0), pressure_pa=pressure_pa)])
    assert (reason is not None) is refused
