"""`wayline play`: an MCAP file back onto the bus, under its recorded keys, as fast as it was."""

import contextlib
import math
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import NamedTuple

import zenoh

from wayline import __version__
from wayline.bus import QOS, Publishers
from wayline.codec import encode
from wayline.ending import Ending, ending_on_signals
from wayline.errors import InputError
from wayline.host_clock import told_ns
from wayline.keys import alive_key, parse_key
from wayline.mcap_log import is_finished, read_records
from wayline.messages import Health
from wayline.settings import BusSettings
from wayline_cli.session import open_or_stop

NAME = "play"
HEALTH_S = 1.0
ASK_S = 1.0
"""Time for a reader to ask for what it lost, and to get it."""

Announce = Callable[[str], AbstractContextManager[None]]
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

    Raises InputError for a speed that is not above 0, for a file that cannot be opened or holds
    nothing to play, before a router is looked for, and for a bus that cannot be opened.
    """
    if not (speed > 0.0 and math.isfinite(speed)):
        raise InputError("--speed", f"{speed} is no speed", "give a number above 0, e.g. 5")
    complete = is_finished(path)
    if next(read_records(path), None) is None:
        raise InputError(str(path), "holds no messages", "name another file of wayline record")
    with ending_on_signals() as ending:
        session = open_or_stop(settings, ending, say)
        if session is None:
            return Played(0, 0.0, complete)
        with session:
            say(f"playing {path}")
            publishers = Publishers(session)
            player = Player(publishers.put, lambda vehicle_id: announced(session, vehicle_id))
            count, seconds = play_records(read_records(path), player.put, ending, speed=speed)
            # readers that lost the last samples ask for them at the next heartbeats
            ending.wait(player.heartbeat_s + ASK_S)
            player.close()
            publishers.close()
            return Played(count, seconds, complete)


@contextlib.contextmanager
def announced(session: zenoh.Session, vehicle_id: str) -> Iterator[None]:
    """A vehicle's player is alive."""
    token = session.liveliness().declare_token(alive_key(vehicle_id, NAME))
    yield
    token.undeclare()  # type: ignore[no-untyped-call]


class Player:
    """Puts what was recorded, and says of each vehicle that it is a recording while it is played.

    So readers do not take its times for old. `announce` is entered once a vehicle.
    """

    def __init__(self, put: Put, announce: Announce = lambda _: contextlib.nullcontext()) -> None:
        self._put, self._announce = put, announce
        self._announced = contextlib.ExitStack()
        self._started_ns = told_ns()
        self._told_s: dict[str, float] = {}
        self.heartbeat_s = 0.0
        """The longest between heartbeats of what was put."""

    def put(self, vehicle_id: str, topic: str, source: str, payload: bytes) -> None:
        """Put a message of a vehicle."""
        if vehicle_id not in self._told_s:
            self._announced.enter_context(self._announce(vehicle_id))
        if time.monotonic() - self._told_s.get(vehicle_id, -math.inf) >= HEALTH_S:
            self._tell(vehicle_id, recorded=True)
        self._put(vehicle_id, topic, source, payload)
        self.heartbeat_s = max(self.heartbeat_s, QOS[topic].heartbeat_s)

    def close(self) -> None:
        """Say that nothing is played any more: what is still held of the vehicles is old."""
        for vehicle_id in self._told_s:
            self._tell(vehicle_id, recorded=False)
        self._announced.close()

    def _tell(self, vehicle_id: str, *, recorded: bool) -> None:
        self._told_s[vehicle_id] = time.monotonic()
        health = Health(
            t_ns=told_ns(),
            service=NAME,
            version=__version__,
            started_ns=self._started_ns,
            recorded=recorded,
        )
        self._put(vehicle_id, Health.topic, NAME, encode(health))


def play_records(
    records: Iterable[tuple[int, str, bytes]], put: Put, ending: Ending, *, speed: float
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
        if ending.wait(due_s - time.monotonic()):
            break
        parts = parse_key(key)
        if parts is not None:
            put(parts.vehicle_id, parts.topic, parts.source, payload)
            count, last_ns = count + 1, log_time_ns
    return count, max(last_ns - first_ns, 0) / 1e9
