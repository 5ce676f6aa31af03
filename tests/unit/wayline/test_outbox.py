"""What goes out together, and what does not wait."""

import time

from wayline.outbox import LONGEST_S, TOGETHER, Outbox


def test_messages_wait_for_more_and_go_in_order() -> None:
    sent: list[bytes] = []
    outbox = Outbox(lambda *message: sent.append(message[3]))
    payloads = [bytes([number]) for number in range(TOGETHER)]
    for payload in payloads[:-1]:
        outbox.add("bus-7", "pose", "fusion", payload)
    assert sent == []
    outbox.add("bus-7", "pose", "fusion", payloads[-1])
    assert sent == payloads
    outbox.send()
    assert sent == payloads


def test_what_has_waited_long_enough_is_due() -> None:
    outbox = Outbox(lambda *_: None)
    due = [outbox.is_due]
    outbox.add("bus-7", "pose", "fusion", b"")
    time.sleep(LONGEST_S)
    due.append(outbox.is_due)
    outbox.send()
    due.append(outbox.is_due)
    assert due == [False, True, False]
