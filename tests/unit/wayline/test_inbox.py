"""The queue before the loop: in order, bounded, and what does not fit is counted."""

import pytest

from builders import at, gyro
from wayline.inbox import Inbox, Item, Raw, Sample

NOW_S = 0.0


def sample(number: int, vehicle_id: str = "bus-7", payload: bytes = b"{}") -> Sample:
    return Sample(f"wayline/v1/{vehicle_id}/pose/test", payload, at(number))


def times(inbox: Inbox, vehicle_id: str) -> list[int]:
    """What can be taken of a vehicle, by number."""
    return [
        (item.received_ns - at(0)) // 10**9
        for item in taken(inbox)
        if isinstance(item, Sample) and item.vehicle_id == vehicle_id
    ]


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


def test_vehicles_take_turns_so_none_waits_for_anothers_flood() -> None:
    inbox = Inbox()
    for number in range(100):
        inbox.put(sample(number, "flood"))
    for number in range(3):
        inbox.put(sample(number, "bus-7"))
    first = [inbox.get(NOW_S) for _ in range(6)]
    assert [item.vehicle_id for item in first if item] == ["flood", "bus-7"] * 3


def test_a_flood_loses_its_own_messages_and_nobody_elses() -> None:
    inbox = Inbox(capacity=100)
    for number in range(500):
        inbox.put(sample(number, "flood"))
        if number % 20 == 0:
            inbox.put(sample(number // 20, "bus-7"))
    assert inbox.take_dropped() == {"flood": 425}
    assert inbox.dropped == 425
    assert inbox.backlog == 100
    assert times(inbox, "bus-7") == list(range(25))


def test_several_floods_leave_a_share_for_each_other_vehicle() -> None:
    inbox = Inbox(capacity=100)
    for number in range(1_000):
        for flood in range(4):
            inbox.put(sample(number, f"flood-{flood}"))
        if number % 100 == 0:
            inbox.put(sample(number // 100, "bus-7"))
    assert "bus-7" not in inbox.take_dropped()
    assert times(inbox, "bus-7") == list(range(10))


def test_heavy_messages_count_for_as_many_as_they_weigh() -> None:
    """An inbox of half-megabyte messages would not fit into the machine."""
    inbox = Inbox(capacity=100)
    heavy = b"x" * 4_096 * 49
    for number in range(10):
        inbox.put(sample(number, "heavy", heavy))
    assert inbox.backlog == 2
    for number in range(30):
        inbox.put(sample(number))
    assert inbox.take_dropped() == {"heavy": 9}
    assert times(inbox, "bus-7") == list(range(30))


def test_what_was_dropped_leaves_nothing_behind_that_would_be_waited_for() -> None:
    inbox = Inbox(capacity=2)
    for number in range(2):
        inbox.put(sample(number, "flood"))
    for number in range(1_000):
        inbox.put(sample(number))
    assert len(taken(inbox)) == inbox.backlog + 2
    assert not inbox.holds("bus-7")
