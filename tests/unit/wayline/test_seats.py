"""How far a core's time has come, and when it has gone back for good."""

from typing import ClassVar

import msgspec
import pytest

from builders import at
from wayline.messages import Message
from wayline.node import Node
from wayline.seats import Seat


class Quiet:
    reads: ClassVar[frozenset[type[Message]]] = frozenset()
    period_ns: ClassVar[int | None] = None

    def handle(self, message: msgspec.Struct, source: str) -> tuple[()]:
        return ()


def seat() -> Seat:
    return Seat("bus-7", "", Node("quiet", Quiet()))


def back_after_s(times: list[tuple[float, float]]) -> float | None:
    """When the seat's time had gone back; times are of receipt and of the message."""
    one = seat()
    for now_s, t_s in times:
        one.hear(at(t_s), now_s)
        if one.is_back:
            return now_s
    return None


@pytest.mark.parametrize("rate_hz", [1, 10])
@pytest.mark.parametrize("ahead_s", [5.0, 50.0, 3600.0])
def test_older_times_that_go_on_are_the_right_ones(rate_hz: int, ahead_s: float) -> None:
    bad = [(0.1 * number, ahead_s + number) for number in range(3)]
    good = [(1.0 + n / rate_hz, 1.0 + n / rate_hz) for n in range(20 * rate_hz)]
    found_s = back_after_s(bad + good)
    assert found_s is not None
    assert found_s - good[0][0] <= 3.0


def test_a_little_ahead_is_waited_for() -> None:
    bad = [(0.0, 2.0)]
    assert back_after_s(bad + [(n / 10, n / 10) for n in range(100)]) is None


def test_late_messages_beside_timely_ones_take_no_time_back() -> None:
    late = [(n / 10, n / 10 - 4.0 * (n % 2)) for n in range(1_000)]
    assert back_after_s(late) is None


def test_one_old_message_again_and_again_is_no_time() -> None:
    assert back_after_s([(0.0, 100.0)] + [(1.0 + n / 10, 5.0) for n in range(100)]) is None


def test_what_was_recovered_at_once_is_late_and_no_time() -> None:
    burst = [(1.0 + n / 1_000, 10.0 + n / 10) for n in range(100)]
    assert back_after_s([(0.0, 100.0), *burst, (1.2, 100.2)]) is None


def back_beside_reports_s(poses: list[tuple[float, float]]) -> float | None:
    """When time had gone back; poses by receipt and time, beside a report of now every 30 s."""
    one = seat()
    reports = [(float(t_s), float(t_s), True) for t_s in range(0, 120, 30)]
    for now_s, t_s, timeless in sorted(reports + [(*each, False) for each in poses]):
        one.hear(at(t_s), now_s, timeless=timeless)
        if one.is_back:
            return now_s
    return None


def test_poses_of_a_busy_service_behind_the_reports_they_are_made_of_take_no_time_back() -> None:
    """Once a second, each of a quarter of a minute ago."""
    assert back_beside_reports_s([(n + 15.0, float(n)) for n in range(100)]) is None


def test_poses_that_go_back_themselves_do_also_beside_reports() -> None:
    """By 20 s, as where the service that makes them had a wrong clock."""
    forth = [(float(n), float(n)) for n in range(62)]
    found_s = back_beside_reports_s(forth + [(62.0 + n, 42.0 + n) for n in range(10)])
    assert found_s is not None
    assert found_s - 62.0 <= 3.0
