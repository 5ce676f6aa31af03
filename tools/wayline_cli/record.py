"""`wayline record`: the bus into an MCAP file."""

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
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
    force: bool = False,
    say: Callable[[str], None] = lambda _: None,
) -> Recorded:
    """Record every message of every vehicle until SIGTERM or Ctrl-C, or for so many seconds.

    The wait for a router counts among the seconds; the file is made when there is one, over an
    earlier one only with `force`. Raises InputError where the file or the bus cannot be opened, no
    router came in time or the disk is full.
    """
    _check(path, seconds, force=force)
    ends_s = time.monotonic() + (threading.TIMEOUT_MAX if seconds is None else seconds)
    try:
        with ending_on_signals() as ending, ended_at(ends_s, ending):
            session = open_or_stop(settings, ending, say)
            if session is None:
                _check_waited(settings, ends_s)
                return Recorded({}, 0, 0, 0)
            with session, McapWriter(path) as writer:
                say(f"recording to {path}")
                return record_bus(session, writer, ending)
    except OSError as error:
        what = f"cannot be written ({error.strerror})"
        raise InputError(str(path), what, "make room on that disk") from None


def _check(path: Path, seconds: float | None, *, force: bool) -> None:
    if seconds is not None and not 0.0 < seconds < threading.TIMEOUT_MAX:
        raise InputError("--seconds", f"{seconds} is no time", "give a number above 0, e.g. 60")
    check_file(path, force=force)


def check_file(path: Path, *, force: bool) -> None:
    """Raise InputError for a file that is there, without `force`, or that cannot be made."""
    if path.is_file() and not force:
        raise InputError(str(path), "is there already", "name another file, or give --force")
    if not path.parent.is_dir():
        mend = "name a file in a folder that you may write to"
        raise InputError(str(path), "cannot be made (its folder is missing)", mend)


def _check_waited(settings: BusSettings, ends_s: float) -> None:
    """Where nobody stopped it, the time was over before a router came."""
    if time.monotonic() >= ends_s:
        what = "no router came within --seconds, nothing was recorded"
        mend = "start one (wayline demo, wayline up) or correct its address in [bus]"
        raise InputError(", ".join(settings.connect), what, mend)


@contextmanager
def ended_at(ends_s: float, ending: Ending) -> Iterator[None]:
    """Requests the ending at a time of the monotonic clock, if the block runs so long."""
    timer = threading.Timer(ends_s - time.monotonic(), ending.request)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def record_bus(
    session: zenoh.Session, writer: McapWriter, ending: Ending, *, inbox: Inbox | None = None
) -> Recorded:
    """Write what arrives on a session; what has arrived when it ends is still written."""
    log = Log(writer)
    service = Service("record", take_sample=log.write, is_announced=False)
    loop = Loop(service, Settings(vehicles=(EVERY_VEHICLE,)), session, ending, inbox=inbox)
    loop.run()
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
