"""What must never end a service: payloads and messages that nobody honest would send."""

import json
from collections.abc import Callable
from typing import Any

import msgspec
from hypothesis import strategies as st

from wayline.messages import EARLIEST_NS, LATEST_NS, TOPICS, Message, field_types

NOW_NS = 1_700_000_000_000_000_000
DEEP = 100_000

PAYLOADS: dict[str, bytes] = {
    "deep, in a field nobody knows": b'{"t_ns":1,"x":' + b"[" * DEEP,
    "deep objects": b'{"t_ns":1,"x":' + b'{"x":' * DEEP,
    "a time of 10^400": b'{"t_ns":1' + b"0" * 400 + b"}",
    "a time of 10^5000": b'{"t_ns":1' + b"0" * 5_000 + b"}",
    "year 10000": b'{"t_ns":253402300800000000000}',
    "before satellites": b'{"t_ns":0}',
    "not UTF-8": b"\xff\xfe",
    "a key that is not UTF-8": b'{"\xff":1}',
    "half a surrogate": b'{"t_ns":1700000000000000000,"service":"\\ud800"}',
    "nothing": b"",
    "half a message": b'{"t_ns":17000000000000000',
    "more than a payload may hold": b'{"t_ns":1700000000000000000}' + b" " * 600_000,
}
"""By what is wrong with them, whatever the topic."""
NOT_UTF8 = {
    "health": b'{"t_ns":1700000000000000000,"service":"\xff"}',
    "progress": b'{"t_ns":1700000000000000000,"route_id":"\xff"}',
    "pose": b'{"t_ns":1700000000000000000,"mode":"\xff"}',
}
"""Texts of topics that have some."""


def damaged(topic: str) -> st.SearchStrategy[bytes]:
    """Payloads of a topic: bytes, any JSON, and good messages cut, torn and changed."""
    good = messages(topic).map(msgspec.json.encode)
    return st.one_of(
        st.binary(max_size=200),
        _any_json().map(lambda value: json.dumps(value).encode()),
        _changed_fields(topic),
        st.builds(lambda whole, at: whole[: at % (len(whole) + 1)], good, st.integers(0, 4_000)),
        st.builds(_with_byte, good, st.integers(0, 4_000), st.integers(0, 255)),
    )


def messages(topic: str) -> st.SearchStrategy[Message]:
    """Messages of a topic that its bounds let through, up to the last digit of them."""
    kind = TOPICS[topic]
    hints = field_types(kind)
    return st.builds(
        kind, **{name: _values(msgspec.inspect.type_info(hint)) for name, hint in hints.items()}
    )


def _changed_fields(topic: str) -> st.SearchStrategy[bytes]:
    names = list(field_types(TOPICS[topic]))
    wrong = st.dictionaries(st.sampled_from(names), _any_json(), max_size=3)
    return st.builds(
        lambda message, fields: json.dumps({**msgspec.to_builtins(message), **fields}).encode(),
        messages(topic),
        wrong,
    )


def _any_json() -> st.SearchStrategy[Any]:
    scalars = st.one_of(
        st.none(),
        st.booleans(),
        st.integers(),
        st.sampled_from([10**400, -(10**400), 2**63, 2**64, 1e300, -1e300, 1e-320, 0]),
        st.floats(),
        st.text(max_size=20),
        st.just("x" * 300),
    )
    return st.recursive(
        scalars,
        lambda inner: (
            st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=4)
        ),
        max_leaves=8,
    )


def _with_byte(whole: bytes, at: int, byte: int) -> bytes:
    at %= len(whole)
    return whole[:at] + bytes([byte]) + whole[at + 1 :]


def _values(info: Any) -> st.SearchStrategy[Any]:
    """Values of a field's type that lie within its bounds, the bounds among them."""
    return VALUES[type(info)](info)


def _structs(info: msgspec.inspect.StructType) -> st.SearchStrategy[Any]:
    return st.builds(info.cls, **{field.name: _values(field.type) for field in info.fields})


def _integers(info: msgspec.inspect.IntType) -> st.SearchStrategy[int]:
    least, most = info.ge, info.le
    if (least, most) == (EARLIEST_NS, LATEST_NS):
        near = st.integers(NOW_NS - 10**10, NOW_NS + 10**10)
        return st.one_of(near, st.sampled_from([EARLIEST_NS, NOW_NS, LATEST_NS]))
    return st.integers(least, most) | st.integers(max(least or 0, -100), 100)


def _floats(info: msgspec.inspect.FloatType) -> st.SearchStrategy[float]:
    least, most = info.ge, info.le
    return st.floats(
        info.gt if least is None else least,
        info.lt if most is None else most,
        exclude_min=least is None and info.gt is not None,
        exclude_max=most is None and info.lt is not None,
        allow_nan=False,
        allow_infinity=False,
    )


VALUES: dict[type[msgspec.inspect.Type], Callable[[Any], st.SearchStrategy[Any]]] = {
    msgspec.inspect.UnionType: lambda info: st.one_of(*map(_values, info.types)),
    msgspec.inspect.NoneType: lambda _: st.none(),
    msgspec.inspect.BoolType: lambda _: st.booleans(),
    msgspec.inspect.LiteralType: lambda info: st.sampled_from(info.values),
    msgspec.inspect.StrType: lambda info: st.text(max_size=min(info.max_length or 20, 20)),
    msgspec.inspect.IntType: _integers,
    msgspec.inspect.FloatType: _floats,
    msgspec.inspect.VarTupleType: lambda info: st.lists(_values(info.item_type), max_size=4).map(
        tuple
    ),
    msgspec.inspect.StructType: _structs,
}
