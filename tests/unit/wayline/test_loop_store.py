"""The loop and a service's store: what it tells, what it says of itself, how it ends."""

import threading
from collections.abc import Callable

import pytest

from loops import Run
from wayline.errors import InputError
from wayline.service import Service
from wayline.settings import Settings

WAIT_S = 10.0


class FakeStore:
    """A store that is in trouble, and notes what is asked of it."""

    problem: str | None = "away"
    detail: str | None = "database away"

    def __init__(self, failure: InputError | None = None) -> None:
        self.handed_over, self.closed = threading.Event(), threading.Event()
        self._failure = failure

    def start(self, failed: Callable[[], None]) -> None:
        if self._failure is not None:
            failed()

    def hand_over(self) -> None:
        self.handed_over.set()

    def close(self) -> None:
        self.closed.set()
        if self._failure is not None:
            raise self._failure


def test_health_says_what_is_wrong_with_the_store(run: Run) -> None:
    store = FakeStore()
    running = run(Service("keeper", store=store), Settings(vehicle_id="bus-7"))
    running.await_health(lambda health: health.detail == "database away")
    assert store.handed_over.wait(WAIT_S)
    running.end()
    assert store.closed.is_set()


def test_what_the_store_lacks_makes_its_service_unready(run: Run) -> None:
    running = run(Service("keeper", store=FakeStore()), Settings(vehicle_id="bus-7"))
    health = running.await_health(lambda health: health.detail is not None)
    assert ("database", "away") in [(each.subject, each.what) for each in health.missing]


def test_a_store_that_cannot_go_on_ends_the_service_with_its_reason(run: Run) -> None:
    store = FakeStore(InputError("database", "is of a newer version", "update"))
    running = run(Service("keeper", store=store), Settings(vehicle_id="bus-7"))
    with pytest.raises(InputError, match="newer version"):
        running.result()
