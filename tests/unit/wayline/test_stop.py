"""Requests to end: by signals, and out of calls that no signal interrupts."""

import signal
import threading

import pytest

from wayline.errors import InputError
from wayline.stop import Stop, stop_on_signals, unless_stopped

WAIT_S = 10.0


def test_a_stop_is_requested_by_a_signal_and_handlers_come_back() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with stop_on_signals() as stop:
        assert not stop.wait(0.0)
        signal.raise_signal(signal.SIGTERM)
        assert stop.wait(WAIT_S)
        assert stop.wait()
    assert signal.getsignal(signal.SIGTERM) is before


def test_a_call_is_left_when_stopped() -> None:
    stop, forever = Stop(), threading.Event()
    found = unless_stopped(forever.wait, stop, patience_s=0.0, waiting=stop.request)
    forever.set()
    assert found is None


def test_a_call_that_fails_says_why_and_one_that_works_says_what() -> None:
    def fail() -> None:
        raise InputError("bus", "is closed", "open it")

    with pytest.raises(InputError, match="bus: is closed"):
        unless_stopped(fail, Stop(), patience_s=WAIT_S, waiting=lambda: None)
    assert unless_stopped(lambda: 7, Stop(), patience_s=WAIT_S, waiting=lambda: None) == 7
