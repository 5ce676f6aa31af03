"""J1939's long messages as a bystander hears them: whole, interleaved, late, lost, endless."""

import random

import pytest

from builders import at, frame
from wayline.inputs import Frame
from wayline_can_ingest.transport import MOST_SESSIONS, Reassembler

EC1 = 65251
LONG = bytes(range(39))


def cm(seconds: float, kind: int, size: int, pgn: int, *, source: int = 0, to: int = 0xFF) -> Frame:
    """A connection management frame that announces a message."""
    count = min(-(-size // 7), 255)
    data = bytes([kind, *size.to_bytes(2, "little"), count, 0xFF, *pgn.to_bytes(3, "little")])
    return frame(seconds, 0x1CEC0000 | to << 8 | source, data.hex())


def answer(seconds: float, kind: int, source: int, to: int) -> Frame:
    """A connection management frame of the receiving side."""
    data = bytes([kind, 3, 1, 0xFF, 0xFF, *EC1.to_bytes(3, "little")])
    return frame(seconds, 0x1CEC0000 | to << 8 | source, data.hex())


def packets(seconds: float, data: bytes, source: int = 0, to: int = 0xFF) -> list[Frame]:
    """The data transfer frames of a message, 50 ms apart."""
    parts = [data[begin : begin + 7].ljust(7, b"\xff") for begin in range(0, len(data), 7)]
    identifier = 0x1CEB0000 | to << 8 | source
    return [
        frame(seconds + 0.05 * number, identifier, (bytes([number]) + part).hex())
        for number, part in enumerate(parts, start=1)
    ]


def heard(reassembler: Reassembler, frames: list[Frame]) -> list[Frame]:
    return [whole for each in frames if (whole := reassembler.take(each)) is not None]


def test_a_broadcast_becomes_one_long_frame_at_its_last_packet() -> None:
    """What BAM announces comes out whole, with the sender's address and the group's number."""
    reassembler = Reassembler([EC1])
    frames = [cm(0, 32, 39, EC1), *packets(0, LONG)]
    assert heard(reassembler, frames) == [Frame(at(0.3), "can0", 0x18FEE300, True, LONG)]
    assert reassembler.broken == 0


def test_a_message_between_two_units_is_overheard() -> None:
    """RTS, CTS and packets from one unit to another make a message; the end is no fault."""
    reassembler = Reassembler([EC1])
    frames = [
        cm(0, 16, 39, EC1, source=0, to=3),
        answer(1.0, 17, source=3, to=0),
        *packets(1.5, LONG, source=0, to=3),
        answer(1.9, 19, source=3, to=0),
    ]
    (whole,) = heard(reassembler, frames)
    assert whole.data == LONG
    assert reassembler.broken == 0


def test_packets_sent_again_out_of_order_are_put_in_order() -> None:
    """A receiver may ask for a packet again: numbers count, not the order of arrival."""
    reassembler = Reassembler([EC1])
    first, second, *rest = packets(0, LONG, to=3)
    frames = [cm(0, 16, 39, EC1, to=3), second, *rest, second, first]
    retimed = [Frame(at(0), *_but_time(each)) for each in frames]
    assert [whole.data for whole in heard(reassembler, retimed)] == [LONG]


def _but_time(each: Frame) -> tuple[str, int, bool, bytes]:
    return each.channel, each.arbitration_id, each.extended, each.data


def test_messages_of_several_units_interleave() -> None:
    """Sessions are told apart by source, destination and channel."""
    reassembler = Reassembler([EC1])
    other = LONG[::-1]
    mixed = [cm(0, 32, 39, EC1, source=1), cm(0, 32, 39, EC1, source=2)]
    for pair in zip(packets(0, LONG, source=1), packets(0, other, source=2), strict=True):
        mixed.extend(pair)
    assert [whole.data for whole in heard(reassembler, mixed)] == [LONG, other]


@pytest.mark.parametrize(
    ("frames", "why"),
    [
        ([cm(0, 32, 39, EC1), *packets(0, LONG)[:3], *packets(2.0, LONG)[3:]], "a pause"),
        ([cm(0, 32, 39, EC1), *packets(0, LONG)[:3], cm(1, 32, 39, EC1)], "begun again"),
        ([cm(0, 16, 39, EC1, to=3), answer(0.1, 255, source=3, to=0)], "aborted"),
        ([cm(0, 16, 39, EC1, to=3), answer(0.1, 19, source=3, to=0)], "ended, not heard whole"),
        ([cm(5, 32, 39, EC1), *packets(0, LONG)], "the clock stepped back"),
    ],
)
def test_what_breaks_off_is_counted_and_gives_nothing(frames: list[Frame], why: str) -> None:
    """Lost packets, pauses and aborts leave no message, and one more in `broken`."""
    reassembler = Reassembler([EC1])
    assert heard(reassembler, frames) == [], why
    assert reassembler.broken == 1


@pytest.mark.parametrize(
    "announced",
    [cm(0, 32, 8, EC1), cm(0, 32, 1786, EC1), cm(0, 32, 39, 0xFEEC), cm(0, 32, 39, EC1, to=3)],
)
def test_what_is_not_wanted_or_impossible_is_passed_over(announced: Frame) -> None:
    """Too short, too long, another group, a broadcast to one unit: packets then mean nothing."""
    reassembler = Reassembler([EC1])
    assert heard(reassembler, [announced, *packets(0, LONG)]) == []
    assert reassembler.broken == 0


def test_memory_is_bounded_however_many_begin() -> None:
    """Of messages that begin and never end the oldest give way, counted."""
    reassembler = Reassembler([EC1])
    count = 5 * MOST_SESSIONS
    for number in range(count):
        reassembler.take(cm(0, 16, 1785, EC1, source=number % 256, to=number // 256))
    assert reassembler.broken == count - MOST_SESSIONS


def test_rubbish_never_raises() -> None:
    """Any bytes of any length on the two groups are passed over or counted."""
    reassembler, choose = Reassembler([EC1, 0xFEEC]), random.Random(1)
    for number in range(20_000):
        kind = choose.choice((0x1CEC, 0x1CEB))
        identifier = kind << 16 | choose.randrange(0x10000)
        data = choose.randbytes(choose.randrange(12))
        if choose.random() < 0.5 and kind == 0x1CEC:
            data = bytes([32, 39, 0, 6, 255, *EC1.to_bytes(3, "little")])
            identifier = 0x1CECFF00 | choose.randrange(4)
        reassembler.take(Frame(number * 1_000_000, "can0", identifier, True, data))
