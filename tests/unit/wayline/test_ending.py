"""Requests to end: by signals, and out of calls that no signal interrupts."""

import signal
import threading

import pytest

from wayline.ending import Ending, ending_on_signals, unless_ended
from wayline.errors import InputError

WAIT_S = 10.0


def test_a_stop_is_requested_by_a_signal_and_handlers_come_back() -> None:
    before = signal.getsignal(signal.SIGTERM)
    with ending_on_signals() as ending:
        assert not ending.wait(0.0)
        signal.raise_signal(signal.SIGTERM)
        assert ending.wait(WAIT_S)
        assert ending.wait()
    assert signal.getsignal(signal.SIGTERM) is before


def test_a_call_is_left_when_stopped() -> None:
    ending, forever = Ending(), threading.Event()
    found = unless_ended(forever.wait, ending, patience_s=0.0, waiting=ending.request)
    forever.set()
    assert found is None


def test_a_call_that_fails_says_why_and_one_that_works_says_what() -> None:
    def fail() -> None:
        raise InputError("bus", "is closed", "open it")

    with pytest.raises(InputError, match="bus: is closed"):
        unless_ended(fail, Ending(), patience_s=WAIT_S, waiting=lambda: None)
    assert unless_ended(lambda: 7, Ending(), patience_s=WAIT_S, waiting=lambda: None) == 7
