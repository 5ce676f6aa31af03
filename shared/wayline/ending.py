"""A request to end, by SIGTERM, Ctrl-C or another thread, that a loop looks at when it is safe.

An exception raised by a signal handler could strike in the middle of a write; a flag cannot.
"""

import queue
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TypeVar

from wayline.errors import InputError

POLL_S = 0.05
Result = TypeVar("Result")


class Ending:
    """False until requested; waiting on it ends at once when it is."""

    def __init__(self) -> None:
        self.requested = False
        # unlike an Event's, its put may run in a signal handler that interrupts its own get
        self._requests: queue.SimpleQueue[None] = queue.SimpleQueue()

    def request(self) -> None:
        """Ask for the end; may be called in a signal handler and more than once."""
        self.requested = True
        self._requests.put(None)

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait for the request, at most so long (None: for ever); whether it has come."""
        if not self.requested:
            try:
                self._requests.get(timeout=None if timeout_s is None else max(timeout_s, 0.0))
            except queue.Empty:
                return False
        return True


@contextmanager
def ending_on_signals() -> Iterator[Ending]:
    """An Ending that SIGTERM and Ctrl-C request while the block runs; main thread only."""
    ending = Ending()

    def handle(number: int, frame: FrameType | None) -> None:
        del number, frame
        ending.request()

    handled = (signal.SIGTERM, signal.SIGINT)
    before = [signal.signal(number, handle) for number in handled]
    try:
        yield ending
    finally:
        for number, handler in zip(handled, before, strict=True):
            signal.signal(number, handler)


def unless_ended(
    call: Callable[[], Result], ending: Ending, *, patience_s: float, waiting: Callable[[], None]
) -> Result | None:
    """What a call returns that no signal can interrupt (opening a session); None when stopped.

    `waiting` is called once when it takes longer than `patience_s`. Raises the call's InputError.
    """
    results: list[Result] = []
    errors: list[InputError] = []

    def run() -> None:
        try:
            results.append(call())
        except InputError as error:
            errors.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(patience_s)
    if thread.is_alive():
        waiting()
    while thread.is_alive() and not ending.requested:
        thread.join(POLL_S)
    if errors:
        raise errors[0]
    if not (results or ending.requested):
        raise RuntimeError("the call died, its traceback is above")
    return results[0] if results else None
