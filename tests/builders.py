"""Small makers of messages and inputs, so that a test names only what it is about."""

from collections.abc import Iterable, Sequence
from typing import Any

import msgspec
import pytest

from wayline.core import Core
from wayline.inputs import Frame
from wayline.messages import GpsFix, Gyro, Message, Odometer
from wayline.node import Node
from wayline.pipeline import Pipeline

START_NS = 1_700_000_000_000_000_000


def about(value: float, tolerance: float | None = None) -> Any:
    """A number in a message that is compared approximately."""
    return pytest.approx(value, abs=tolerance)


def at(seconds: float) -> int:
    """Measurement time, seconds after the tests' epoch."""
    return START_NS + round(seconds * 1e9)


def fix(seconds: float, lat_deg: float, lon_deg: float, **fields: Any) -> GpsFix:
    """A valid 3-D fix."""
    known: dict[str, Any] = {"valid": True, "mode": 3, "fix": "gps", **fields}
    return GpsFix(t_ns=at(seconds), lat_deg=lat_deg, lon_deg=lon_deg, **known)


def gyro(seconds: float, yaw_rate_degps: float) -> Gyro:
    """One gyro sample."""
    return Gyro(t_ns=at(seconds), yaw_rate_degps=yaw_rate_degps)


def odometer(seconds: float, speed_mps: float, *, reverse: bool | None = None) -> Odometer:
    """One wheel speed."""
    return Odometer(t_ns=at(seconds), speed_mps=speed_mps, reverse=reverse)


def frame(seconds: float, arbitration_id: int, data: str, channel: str = "can0") -> Frame:
    """A CAN frame with its bytes as hexadecimal text."""
    return Frame(at(seconds), channel, arbitration_id, arbitration_id > 0x7FF, bytes.fromhex(data))


def run_core(
    core: Core,
    messages: Iterable[Message],
    *,
    source: str = "test",
) -> list[Message]:
    """What a core publishes when messages reach it over the bus, flush included."""
    published: list[Message] = []
    node = Node("core", core)
    given: Sequence[Message] = list(messages)
    pipeline = Pipeline([node], lambda message, _: published.append(message))
    for message in given:
        pipeline.feed(message, source)
    pipeline.finish()
    inputs = {id(message) for message in given}
    return [message for message in published if id(message) not in inputs]


def only(messages: Iterable[msgspec.Struct], kind: type[Any]) -> list[Any]:
    """The messages of one kind."""
    return [message for message in messages if isinstance(message, kind)]
