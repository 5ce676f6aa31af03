"""Signals read out of a frame's bits: any layout, beside bits counted one by one and cantools."""

import pytest
from cantools.database.can import Message as DbcMessage
from cantools.database.can.signal import Signal
from cantools.database.conversion import BaseConversion
from hypothesis import example, given, settings
from hypothesis import strategies as st

from wayline_can_ingest.bits import BitReader, are_plain
from wayline_can_ingest.j1939 import not_available

LONGEST_BYTES = 39
"""A J1939 message of several frames; CAN FD's 64 are no other matter."""


@st.composite
def signals(draw: st.DrawFn, name: str = "A") -> Signal:
    """Any integer signal within the longest message."""
    length = draw(st.integers(1, 64))
    first = draw(st.integers(0, 8 * LONGEST_BYTES - length))
    is_big = draw(st.booleans())
    scales = st.sampled_from((1.0, 0.01, -0.5, 1.0 / 256.0, 0.2777777777777778))
    return Signal(
        name,
        # first counts bits from the left of the frame where it is big endian, as on the wire
        start=first ^ 7 if is_big else first,
        length=length,
        byte_order="big_endian" if is_big else "little_endian",
        is_signed=draw(st.booleans()),
        conversion=BaseConversion.factory(
            scale=draw(scales), offset=draw(st.sampled_from((0.0, -125.0, 17.5)))
        ),
    )


frames = st.binary(min_size=0, max_size=LONGEST_BYTES + 2)


def raw_bit_by_bit(signal: Signal, data: bytes) -> int | None:
    """The raw value before its sign, bits collected as the DBC format draws them."""
    raw, at = 0, signal.start
    for position in range(signal.length):
        if at // 8 >= len(data):
            return None
        bit = data[at // 8] >> at % 8 & 1
        if signal.byte_order == "little_endian":
            raw |= bit << position
            at += 1
        else:
            raw = raw << 1 | bit
            # down in a byte, then to the top of the next one
            at = at + 15 if at % 8 == 0 else at - 1
    return raw


def value_bit_by_bit(signal: Signal, data: bytes) -> float | None:
    """The scaled value; None where the frame does not hold it."""
    raw = raw_bit_by_bit(signal, data)
    if raw is None:
        return None
    if signal.is_signed and raw >> (signal.length - 1):
        raw -= 1 << signal.length
    # an integer stays one: above 2 ** 53 a double would be another
    return raw * signal.conversion.scale + signal.conversion.offset


@settings(deadline=None)
@given(signals("A"), signals("B"), frames)
def test_any_layout_is_read_as_bit_by_bit(first: Signal, second: Signal, data: bytes) -> None:
    """Both byte orders, signs, every place, frames too short and too long, overlaps too."""
    wanted = {each.name: value_bit_by_bit(each, data) for each in (first, second)}
    held = {name: value for name, value in wanted.items() if value is not None}
    assert BitReader([first, second], j1939=False).read(data) == held


@settings(deadline=None)
@given(signals(), frames)
def test_any_layout_is_read_as_cantools_does(signal: Signal, data: bytes) -> None:
    """Whatever the frame's length, against the library that reads what is not plain."""
    message = DbcMessage(1, "M", LONGEST_BYTES, [signal])
    wanted = message.decode_simple(data, decode_choices=False, allow_truncated=True)
    assert BitReader([signal], j1939=False).read(data) == pytest.approx(wanted, rel=1e-9)


@settings(deadline=None)
@given(signals(), frames)
@example(Signal("A", 0, 8), b"\xfe")
@example(Signal("A", 0, 8), b"\xfd")
@example(Signal("A", 0, 2), b"\x02")
@example(Signal("A", 0, 54), b"\x01\x00\x00\x00\x00\x00\x20")
def test_what_is_not_available_is_none(signal: Signal, data: bytes) -> None:
    """A J1939 field in its ranges for "error" and "not available" has no value, any other has."""
    raw = raw_bit_by_bit(signal, data)
    read = BitReader([signal], j1939=True).read(data)
    if raw is None:
        assert read == {}
    elif not_available(raw, signal.length):
        assert read == {"A": None}
    else:
        assert read == {"A": value_bit_by_bit(signal, data)}


def test_floats_and_multiplexed_signals_are_left_to_cantools() -> None:
    """They are no integers of one place."""
    floating = BaseConversion.factory(is_float=True)
    assert not are_plain([Signal("A", 0, 32, conversion=floating)])
    assert not are_plain([Signal("A", 8, 8, multiplexer_ids=[1], multiplexer_signal="M")])
    assert are_plain([Signal("A", 0, 32)])
