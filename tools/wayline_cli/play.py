"""`wayline play`: an MCAP file back onto the bus, under its recorded keys, as fast as it was."""

import math
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

from wayline.bus import RECOVERY_PERIOD, Publishers
from wayline.errors import InputError
from wayline.keys import parse_key
from wayline.mcap_log import is_finished, read_records
from wayline.settings import BusSettings
from wayline.stop import Stop, stop_on_signals
from wayline_cli.session import open_or_stop

Put = Callable[[str, str, str, bytes], None]
"""Takes vehicle id, topic, source and payload, as `Publishers.put` does."""


class Played(NamedTuple):
    """What came of playing."""

    messages: int
    seconds: float
    """Of the recording, first to last message played."""
    complete: bool
    """False where the recording itself ends abruptly, its writer having been killed."""


def play(
    path: Path,
    settings: BusSettings,
    *,
    speed: float = 1.0,
    say: Callable[[str], None] = lambda _: None,
) -> Played:
    """Play a recording until its end, SIGTERM or Ctrl-C.

    Raises InputError for a speed that is not above 0, and for a file or a bus that cannot be
    opened.
    """
    if not (speed > 0.0 and math.isfinite(speed)):
        raise InputError("--speed", f"{speed} is no speed", "give a number above 0, e.g. 5")
    complete = is_finished(path)
    with stop_on_signals() as stop:
        session = open_or_stop(settings, stop, say)
        if session is None:
            return Played(0, 0.0, complete)
        with session:
            say(f"playing {path}")
            publishers = Publishers(session)
            count, seconds = play_records(read_records(path), publishers.put, stop, speed=speed)
            # readers that lost the last samples ask for them at the next heartbeats
            stop.wait(2.0 * RECOVERY_PERIOD.total_seconds())
            publishers.close()
            return Played(count, seconds, complete)


def play_records(
    records: Iterable[tuple[int, str, bytes]], put: Put, stop: Stop, *, speed: float
) -> tuple[int, float]:
    """Put records (log_time_ns, key, payload) when they are due; number and seconds of them.

    A recorder's clock that stepped back makes the next record due at once.
    """
    started_s = time.monotonic()
    first_ns = last_ns = count = 0
    for log_time_ns, key, payload in records:
        if count == 0:
            first_ns = log_time_ns
        due_s = started_s + (log_time_ns - first_ns) / 1e9 / speed
        if stop.wait(due_s - time.monotonic()):
            break
        parts = parse_key(key)
        if parts is not None:
            put(parts.vehicle_id, parts.topic, parts.source, payload)
            count, last_ns = count + 1, log_time_ns
    return count, max(last_ns - first_ns, 0) / 1e9
