"""A computer without a time of its own has that of its receiver."""

import time

import pytest
from msgspec.structs import replace

from builders import fix
from wayline.view import Receipt
from wayline_can_ingest.receiver_clock import WINDOW_NS, ReceiverClock

SECOND_NS = 1_000_000_000
TRUE_NS = 1_800_000_000 * SECOND_NS
"""When the monotonic clock began."""
WALL_1970_NS = 60 * SECOND_NS


class Host:
    """A computer's two clocks, set by the test."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.wall_ns, self.monotonic_ns = WALL_1970_NS, 0
        monkeypatch.setattr(time, "time_ns", lambda: self.wall_ns)
        monkeypatch.setattr(time, "monotonic_ns", lambda: self.monotonic_ns)


@pytest.fixture
def host(monkeypatch: pytest.MonkeyPatch) -> Host:
    return Host(monkeypatch)


def hear(clock: ReceiverClock, at_s: float, delay_s: float, source: str = "gps-ingest") -> None:
    """A fix that took so long from its instant to its receipt, `at_s` after the start."""
    at_ns = round(at_s * 1e9)
    heard = replace(fix(0, 55.0, 10.0), t_ns=TRUE_NS + at_ns - round(delay_s * 1e9))
    clock.put("bus-7", heard, source, Receipt(at_ns))


def test_before_a_fix_it_is_what_the_host_says(host: Host) -> None:
    assert ReceiverClock((), 0.0).now_ns() == WALL_1970_NS


def test_the_fastest_fix_tells_the_time(host: Host) -> None:
    clock = ReceiverClock((), 0.0)
    for at_s, delay_s in ((1.0, 0.5), (2.0, 0.1), (3.0, 0.9)):
        hear(clock, at_s, delay_s)
    host.monotonic_ns = 10 * SECOND_NS
    assert clock.now_ns() == TRUE_NS + 10 * SECOND_NS - SECOND_NS // 10


def test_a_receiver_whose_time_goes_back_is_followed_after_two_windows(host: Host) -> None:
    clock = ReceiverClock((), 0.0)
    hear(clock, 1.0, 0.0)
    for second in range(2, 3 * WINDOW_NS // SECOND_NS):
        hear(clock, second, 5.0)
    assert clock.now_ns() == TRUE_NS - 5 * SECOND_NS


def test_what_fixes_had_taken_off_is_no_delay(host: Host) -> None:
    clock = ReceiverClock((), 0.2)
    hear(clock, 1.0, 0.2)
    assert clock.now_ns() == TRUE_NS


def test_fixes_of_the_frames_themselves_and_empty_ones_tell_no_time(host: Host) -> None:
    clock = ReceiverClock({"can-ingest"}, 0.0)
    hear(clock, 1.0, 0.0, "can-ingest")
    clock.put("bus-7", replace(fix(0, 55.0, 10.0), valid=False), "gps-ingest", Receipt(0))
    assert clock.now_ns() == WALL_1970_NS


@pytest.mark.parametrize("ahead_s", [-59, 0, 3600])
def test_a_clock_that_is_not_far_behind_is_the_hosts(host: Host, ahead_s: int) -> None:
    clock = ReceiverClock((), 0.0)
    hear(clock, 1.0, 0.0)
    host.wall_ns = TRUE_NS + ahead_s * SECOND_NS
    assert clock.now_ns() == host.wall_ns


def test_a_clock_of_the_last_shutdown_is_the_receivers(host: Host) -> None:
    clock = ReceiverClock((), 0.0)
    hear(clock, 1.0, 0.0)
    host.wall_ns = TRUE_NS - 3600 * SECOND_NS
    assert clock.now_ns() == TRUE_NS
