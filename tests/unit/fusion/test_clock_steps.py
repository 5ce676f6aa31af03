"""Steps of the clock, told from late messages and from silence."""

from builders import fix, gyro, odometer
from wayline.messages import Message
from wayline_fusion.intake.clock_steps import ClockSteps


def steps_s(messages: list[Message]) -> list[float]:
    clock = ClockSteps()
    found = [clock.step_s(message) for message in messages]
    return [round(step_s, 6) for step_s in found if step_s is not None]


def gyros(*spans: tuple[float, float]) -> list[Message]:
    """Samples every 10 ms over spans of seconds."""
    return [
        gyro(start_s + 0.01 * step, 0.0)
        for start_s, end_s in spans
        for step in range(round((end_s - start_s) * 100.0))
    ]


def test_a_gap_in_all_times_is_a_step() -> None:
    assert steps_s(gyros((0.0, 5.0), (8.0, 12.0))) == [3.01]


def test_times_that_go_back_are_a_step_once() -> None:
    assert steps_s(gyros((0.0, 5.0), (2.0, 12.0))) == [-2.99]


def test_a_late_fix_is_no_step() -> None:
    """However late it is: other sensors come in order."""
    assert steps_s([*gyros((0.0, 5.0)), fix(1.0, 56.0, 10.0), *gyros((5.0, 6.0))]) == []


def test_disorder_among_sensors_is_no_step() -> None:
    assert steps_s([gyro(1.0, 0.0), odometer(0.2, 1.0), gyro(1.9, 0.0), odometer(1.0, 1.0)]) == []


def test_a_silent_bus_with_fixes_is_no_step() -> None:
    fixes: list[Message] = [fix(second, 56.0, 10.0) for second in range(6, 10)]
    assert steps_s([*gyros((0.0, 5.0)), *fixes, *gyros((10.0, 11.0))]) == []


def test_without_a_bus_nothing_is_known_of_steps() -> None:
    """A receiver that falls silent in a tunnel comes back with the right time."""
    assert steps_s([fix(0.0, 56.0, 10.0), fix(60.0, 56.0, 10.0)]) == []
