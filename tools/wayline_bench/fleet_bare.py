"""The fleet's yardstick: plain Zenoh publishers, and processes that hear, count and say as much.

`python -m wayline_bench.fleet_bare ENDPOINT PART`, the part as JSON.
"""

import contextlib
import queue
import sys
from collections import Counter
from collections.abc import Callable

import msgspec
import zenoh

from wayline.bus import open_session
from wayline.ending import ending_on_signals
from wayline.keys import Key, message_key
from wayline.messages import Pose
from wayline.settings import BusSettings

READY = "listening"
SOURCE = "bare"
POLL_S = 0.05
"""As patient as the loop of a service."""


class BarePublishers:
    """One plain publisher a key, declared when first used; called as `wayline.bus.Publishers`."""

    def __init__(self, session: zenoh.Session) -> None:
        self._session = session
        self._publishers: dict[Key, zenoh.Publisher] = {}

    def put(self, vehicle_id: str, topic: str, source: str, payload: bytes) -> None:
        """Publish a payload; never waits for a reader."""
        key = Key(vehicle_id, topic, source)
        publisher = self._publishers.get(key)
        if publisher is None:
            publisher = self._session.declare_publisher(message_key(*key))
            self._publishers[key] = publisher
        publisher.put(payload)

    def close(self) -> None:
        """Undeclare every publisher."""
        while self._publishers:
            _, publisher = self._publishers.popitem()
            publisher.undeclare()  # type: ignore[no-untyped-call]


class Part(msgspec.Struct, frozen=True):
    """What one bare listener does."""

    topics: tuple[str, ...]
    """What it hears."""
    answers: dict[str, int]
    """Bytes of what it says of a vehicle, by topic."""
    answers_every: int
    """It answers every so many poses of a vehicle."""


class BareListener:
    """Counts, and says as much as a service would."""

    def __init__(self, part: Part, put: Callable[[str, str, str, bytes], None]) -> None:
        self._put, self._every = put, part.answers_every
        self._answers = {topic: bytes(size) for topic, size in part.answers.items()}
        self._poses: Counter[str] = Counter()
        self.counts: Counter[str] = Counter()
        """By topic."""

    def take(self, key: str) -> None:
        """A message was heard under a key."""
        _, _, vehicle_id, topic, _ = key.split("/")
        self.counts[topic] += 1
        if topic != Pose.topic:
            return
        self._poses[vehicle_id] += 1
        if self._poses[vehicle_id] % self._every == 0:
            for answer, payload in self._answers.items():
                self._put(vehicle_id, answer, SOURCE, payload)


def main() -> None:
    """Listen and answer until SIGTERM, then say what was heard by topic as JSON."""
    part = msgspec.json.decode(sys.argv[2], type=Part)
    heard: queue.SimpleQueue[str] = queue.SimpleQueue()
    with (
        ending_on_signals() as ending,
        open_session(BusSettings(connect=(sys.argv[1],))) as session,
        contextlib.closing(BarePublishers(session)) as publishers,
        contextlib.ExitStack() as stack,
    ):
        for topic in part.topics:
            subscriber = session.declare_subscriber(
                message_key("*", topic, "*"), lambda sample: heard.put(str(sample.key_expr))
            )
            stack.callback(subscriber.undeclare)
        print(READY, flush=True)
        listener = BareListener(part, publishers.put)
        while not ending.requested:
            with contextlib.suppress(queue.Empty):
                listener.take(heard.get(timeout=POLL_S))
    print(msgspec.json.encode(listener.counts).decode(), flush=True)


if __name__ == "__main__":
    main()
