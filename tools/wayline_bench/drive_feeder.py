"""The process that plays a vehicle's sensors on the bus, and bare messages beside them."""

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

from wayline.bus import Publishers, open_session
from wayline.codec import encode
from wayline.messages import GpsFix, Gyro, Message
from wayline.settings import BusSettings
from wayline_bench.echo import ASK, numbered
from wayline_bench.made_up_drive import GYRO_NS, STEP_NS, drive

VEHICLE = "bench"
PHASE_NS = 40_000_000
"""Of the odometer behind the grid of poses."""
ECHO_AFTER_S = 0.005
"""Halfway between two gyro samples, where fusion is idle."""
SAMPLES_A_STEP = STEP_NS // GYRO_NS


@dataclass(frozen=True)
class DriveFeed:
    """What to send, and for how long."""

    bus: BusSettings
    length_s: float
    warm_up_s: float
    gyro_bytes: int
    pose_bytes: int


@dataclass(frozen=True)
class Fed:
    """What was sent when (monotonic clock), the warm-up left out."""

    pose_due_s: dict[int, float] = field(default_factory=dict)
    """By the instant that it describes: when the message was sent that makes the pose due."""
    echo_sent_s: dict[int, float] = field(default_factory=dict)
    """By number, those of a pose's size."""


def feed(plan: DriveFeed) -> Fed:
    """Play the drive as fast as it is driven, with as many bare messages beside it."""
    fed = Fed()
    start_ns = -(-time.time_ns() // 1_000_000_000) * 1_000_000_000
    with contextlib.ExitStack() as stack:
        session = stack.enter_context(open_session(plan.bus))
        publishers = stack.enter_context(contextlib.closing(Publishers(session)))
        echo = session.declare_publisher(ASK)
        began_s = time.monotonic()
        bursts = _bursts(drive(start_ns, PHASE_NS))
        for number in range(round((plan.warm_up_s + plan.length_s) * 1e9) // GYRO_NS):
            due_s = began_s + number * GYRO_NS * 1e-9
            is_step = number % SAMPLES_A_STEP == 0
            is_kept = is_step and due_s - began_s >= plan.warm_up_s
            _wait_until(due_s)
            if is_kept:
                fed.pose_due_s[start_ns + number * GYRO_NS] = time.monotonic()
            for message in next(bursts):
                source = "gps-ingest" if isinstance(message, GpsFix) else "can-ingest"
                publishers.put(VEHICLE, message.topic, source, encode(message))
            payload = numbered(number, plan.pose_bytes if is_step else plan.gyro_bytes)
            _wait_until(due_s + ECHO_AFTER_S)
            if is_kept:
                fed.echo_sent_s[number] = time.monotonic()
            echo.put(payload)
    return fed


def _bursts(messages: Iterator[Message]) -> Iterator[list[Message]]:
    """What comes with each gyro sample."""
    burst = [next(messages)]
    for message in messages:
        if isinstance(message, Gyro):
            yield burst
            burst = []
        burst.append(message)


def _wait_until(at_s: float) -> None:
    time.sleep(max(at_s - time.monotonic(), 0.0))
