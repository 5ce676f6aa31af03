"""The queue before the loop: in order, bounded, and what does not fit is counted."""

import pytest

from builders import at, gyro
from wayline.inbox import Inbox, Item, Raw, Sample

NOW_S = 0.0


def sample(number: int) -> Sample:
    return Sample(f"key-{number}", b"{}", at(number))


def taken(inbox: Inbox) -> list[Item]:
    found = []
    while (item := inbox.get(NOW_S)) is not None:
        found.append(item)
    return found


def test_items_come_out_in_the_order_in_which_they_came() -> None:
    inbox = Inbox()
    for number in range(3):
        inbox.put(sample(number))
    assert inbox.backlog == 3
    assert taken(inbox) == [sample(0), sample(1), sample(2)]
    assert inbox.backlog == 0


def test_what_does_not_fit_is_dropped_and_counted_and_what_is_there_stays() -> None:
    inbox = Inbox(capacity=2)
    for number in range(5):
        inbox.put(sample(number))
    assert inbox.dropped == 3
    assert taken(inbox) == [sample(0), sample(1)]


def test_a_source_that_can_wait_is_told_that_there_is_no_room_and_loses_nothing() -> None:
    inbox = Inbox(capacity=1)
    raw = Raw("bus-7", "can-ingest", gyro(0, 1), at(0))
    assert inbox.put_waiting(raw, NOW_S)
    assert not inbox.put_waiting(raw, NOW_S)
    assert inbox.dropped == 0
    assert taken(inbox) == [raw]


def test_a_source_that_can_wait_takes_the_room_that_its_pause_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The loop takes an item meanwhile; the next one is put without a second attempt."""
    inbox = Inbox(capacity=1)
    inbox.put(sample(0))
    monkeypatch.setattr("wayline.inbox.time.sleep", inbox.get)
    assert inbox.put_waiting(sample(1), NOW_S)
    assert taken(inbox) == [sample(1)]
