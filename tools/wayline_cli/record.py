"""`wayline record`: the bus into an MCAP file."""

import threading
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import msgspec
import zenoh

from wayline.codec import decode
from wayline.ending import Ending, ending_on_signals
from wayline.errors import InputError
from wayline.inbox import Inbox, Sample
from wayline.keys import parse_key
from wayline.loop import Loop
from wayline.mcap_log import McapWriter
from wayline.service import Service
from wayline.settings import EVERY_VEHICLE, BusSettings, Settings
from wayline_cli.session import open_or_stop


class Recorded(NamedTuple):
    """What came of a recording."""

    counts: dict[str, int]
    """Messages written, by topic, in the order of the first of each."""
    dropped: int
    """Arrived while the queue was full."""
    missed: int
    """Lost on the way and not recovered."""
    refused: int
    """Samples that were no message of their topic."""


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
        with McapWriter(path) as writer, ending_on_signals() as ending:
            session = open_or_stop(settings, ending, say)
            if session is None:
                return Recorded({}, 0, 0, 0)
            with session:
                say(f"recording to {path}")
                return record_bus(session, writer, ending, seconds=seconds)
    except OSError as error:
        what = f"cannot be written ({error.strerror})"
        raise InputError(str(path), what, "make room on that disk") from None


def record_bus(
    session: zenoh.Session,
    writer: McapWriter,
    ending: Ending,
    *,
    seconds: float | None = None,
    inbox: Inbox | None = None,
) -> Recorded:
    """Write what arrives on a session; what has arrived when it ends is still written."""
    log = Log(writer)
    service = Service("record", take_sample=log.write, is_announced=False)
    loop = Loop(service, Settings(vehicles=(EVERY_VEHICLE,)), session, ending, inbox=inbox)
    timer = threading.Timer(seconds or 0.0, ending.request)
    if seconds is not None:
        timer.start()
    try:
        loop.run()
    finally:
        timer.cancel()
    return Recorded(dict(log.counts), loop.dropped, loop.lost, log.refused)


class Log:
    """Writes samples that are messages and counts what it did."""

    def __init__(self, writer: McapWriter) -> None:
        self._writer = writer
        self.counts: Counter[str] = Counter()
        self.refused = 0

    def write(self, sample: Sample) -> None:
        """Write one sample as it was on the bus."""
        key = parse_key(sample.key)
        t_ns = None if key is None else _t_ns(key.topic, sample.payload)
        if key is None or t_ns is None:
            self.refused += 1
            return
        self._writer.write_payload(sample.key, key.topic, sample.payload, t_ns, sample.received_ns)
        self.counts[key.topic] += 1


def _t_ns(topic: str, payload: bytes) -> int | None:
    """A message's instant; None for what is not a message of its topic."""
    try:
        return decode(topic, payload).t_ns
    except msgspec.DecodeError:
        return None
