"""`wayline record`: the bus into an MCAP file."""

import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import msgspec
import zenoh

from wayline.bus import Subscription
from wayline.codec import decode
from wayline.errors import InputError
from wayline.inbox import Inbox, Item, Sample
from wayline.keys import parse_key
from wayline.mcap_log import McapWriter
from wayline.messages import TOPICS
from wayline.settings import EVERY_VEHICLE, BusSettings
from wayline.stop import Stop, stop_on_signals
from wayline_cli.session import open_or_stop

POLL_S = 0.1


class Recorded(NamedTuple):
    """What came of a recording."""

    counts: dict[str, int]
    """Messages written, by topic, in the order of the first of each."""
    dropped: int
    """Arrived while the queue was full."""
    missed: int
    """Lost on the way and not recovered."""
    refused: int
    """Not a message of their topic."""


def record(
    path: Path,
    settings: BusSettings,
    *,
    seconds: float | None = None,
    say: Callable[[str], None] = lambda _: None,
) -> Recorded:
    """Record every message of every vehicle until SIGTERM or Ctrl-C, or for so many seconds.

    Raises InputError where the file or the bus cannot be opened or the disk is full.
    """
    try:
        with McapWriter(path) as writer, stop_on_signals() as stop:
            session = open_or_stop(settings, stop, say)
            if session is None:
                return Recorded({}, 0, 0, 0)
            with session:
                say(f"recording to {path}")
                return record_bus(session, writer, stop, seconds=seconds)
    except OSError as error:
        what = f"cannot be written ({error.strerror})"
        raise InputError(str(path), what, "make room on that disk") from None


def record_bus(
    session: zenoh.Session,
    writer: McapWriter,
    stop: Stop,
    *,
    seconds: float | None = None,
    inbox: Inbox | None = None,
) -> Recorded:
    """Write what arrives on a session; what has arrived when it ends is still written."""
    inbox = inbox or Inbox()
    log = Log(writer)
    subscription = Subscription(
        session,
        [EVERY_VEHICLE],
        TOPICS,
        lambda key, payload: inbox.put(Sample(key, payload, time.time_ns())),
        log.miss,
    )
    ends_s = time.monotonic() + (float("inf") if seconds is None else seconds)
    try:
        while not stop.requested and time.monotonic() < ends_s:
            log.write(inbox.get(POLL_S))
    finally:
        subscription.close()
    while inbox.backlog:
        log.write(inbox.get(0.0))
    return Recorded(dict(log.counts), inbox.dropped, log.missed, log.refused)


class Log:
    """Writes samples that are messages and counts what it did."""

    def __init__(self, writer: McapWriter) -> None:
        self._writer = writer
        self.counts: Counter[str] = Counter()
        self.missed = 0
        self.refused = 0

    def miss(self, count: int) -> None:
        """Count samples that were lost for good."""
        self.missed += count

    def write(self, item: Item | None) -> None:
        """Write one sample as it was on the bus."""
        if not isinstance(item, Sample):
            return
        key = parse_key(item.key)
        t_ns = None if key is None else _t_ns(key.topic, item.payload)
        if key is None or t_ns is None:
            self.refused += 1
            return
        self._writer.write_payload(item.key, key.topic, item.payload, t_ns, item.received_ns)
        self.counts[key.topic] += 1


def _t_ns(topic: str, payload: bytes) -> int | None:
    """A message's instant; None for what is not a message of its topic."""
    try:
        return decode(topic, payload).t_ns
    except msgspec.DecodeError:
        return None
