"""Hears a bus as any other program would, and waits for what should come."""

import threading
import time
from collections.abc import Callable, Iterable
from typing import NamedTuple

import msgspec
import zenoh

from wayline.bus import Subscription
from wayline.codec import decode
from wayline.keys import alive_key, parse_key
from wayline.messages import Message


class Heard(NamedTuple):
    """A message as it was heard."""

    source: str
    message: Message
    received_s: float
    """Monotonic clock."""


class Listener:
    """Keeps every message of some topics, and which services are alive."""

    def __init__(self, session: zenoh.Session, vehicle_id: str, topics: Iterable[str]) -> None:
        self._changed = threading.Condition()
        self._heard: dict[str, list[Heard]] = {topic: [] for topic in topics}
        self._alive: dict[str, bool] = {}
        self.lost = 0
        """Samples that the bus could not recover."""
        self.bad = 0
        self._subscription = Subscription(
            session, [vehicle_id], self._heard, self._on_sample, self._on_miss
        )
        self._liveliness = session.liveliness().declare_subscriber(
            alive_key("*", "*"), self._on_alive, history=True
        )

    def close(self) -> None:
        """Hear no more."""
        self._liveliness.undeclare()  # type: ignore[no-untyped-call]
        self._subscription.close()

    def heard(self, topic: str) -> list[Heard]:
        """Everything of a topic so far, in order of arrival."""
        with self._changed:
            return list(self._heard[topic])

    def is_alive(self, service: str) -> bool:
        """Whether a service's liveliness token is there now."""
        with self._changed:
            return self._alive.get(service, False)

    def await_message(
        self,
        topic: str,
        matches: Callable[[Heard], bool] = lambda _: True,
        *,
        timeout_s: float,
    ) -> Heard:
        """The first message of a topic, heard already or not yet, that matches.

        Raises TimeoutError.
        """
        messages, looked = self._heard[topic], 0
        deadline_s = time.monotonic() + timeout_s
        with self._changed:
            while True:
                for heard in messages[looked:]:
                    if matches(heard):
                        return heard
                looked = len(messages)
                if not self._changed.wait(deadline_s - time.monotonic()):
                    raise TimeoutError(f"no {topic} that matches among {looked}")

    def await_alive(self, *services: str, up: bool = True, timeout_s: float) -> None:
        """Wait until services' liveliness tokens have come, or gone. Raises TimeoutError."""
        with self._changed:
            if not self._changed.wait_for(
                lambda: all(self._alive.get(service, False) is up for service in services),
                timeout_s,
            ):
                raise TimeoutError(f"{services} not {'up' if up else 'down'}: {self._alive}")

    def _on_sample(self, key: str, payload: bytes) -> None:
        received_s, parsed = time.monotonic(), parse_key(key)
        with self._changed:
            if parsed is None:
                self.bad += 1
                return
            try:
                message = decode(parsed.topic, payload)
            except msgspec.DecodeError:
                self.bad += 1
                return
            self._heard[parsed.topic].append(Heard(parsed.source, message, received_s))
            self._changed.notify_all()

    def _on_miss(self, count: int) -> None:
        self.lost += count

    def _on_alive(self, sample: zenoh.Sample) -> None:
        with self._changed:
            up = sample.kind == zenoh.SampleKind.PUT
            self._alive[str(sample.key_expr).rpartition("/")[2]] = up
            self._changed.notify_all()
