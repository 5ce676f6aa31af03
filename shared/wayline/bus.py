"""The bus: a Zenoh session, publishers that late joiners can ask, subscribers that recover.

Callbacks only hand samples on; what they call must not block and must not call Zenoh.
"""

import json
from collections.abc import Callable, Iterable
from typing import NamedTuple

import zenoh
import zenoh.ext
from zenoh import CongestionControl

from wayline.codec import ENCODING
from wayline.errors import InputError
from wayline.keys import Key, message_key
from wayline.messages import MESSAGES, TOPICS, Message
from wayline.settings import BusSettings

HEARTBEAT_MIN_S = 1.0
HEARTBEAT_MESSAGES = 5.0
"""A heartbeat for every so many messages: the next message tells of a loss sooner than it does."""
SLOWEST_FAST_HZ = 5.0
"""Topics above this rate are streams; slower ones are states, whose newest value joiners get."""
CACHED_S = 3.0
"""Seconds of a stream that can be recovered after a loss."""


class Qos(NamedTuple):
    """How a topic travels."""

    cache_depth: int
    """Samples that its publisher keeps, for recovery and late joiners."""
    history_depth: int
    """Samples that a late joiner asks for; 0 for a stream of raw samples."""
    congestion_control: CongestionControl
    """A reader that does not keep up loses samples and recovers them; nothing waits for it."""
    heartbeat_s: float
    """How often its publisher says what its last sample was, so that the loss of it is noticed."""


def _qos(message: type[Message]) -> Qos:
    fast = message.rate_hz > SLOWEST_FAST_HZ and message is not TOPICS["pose"]
    cache_depth = max(10, round(message.rate_hz * CACHED_S))
    heartbeat_s = max(HEARTBEAT_MIN_S, HEARTBEAT_MESSAGES / message.rate_hz)
    return Qos(cache_depth, 0 if fast else 1, CongestionControl.DROP, heartbeat_s)


QOS: dict[str, Qos] = {message.topic: _qos(message) for message in MESSAGES}
"""The one table of cache depth, history, congestion control and heartbeat, by topic."""


def open_session(settings: BusSettings) -> zenoh.Session:
    """A client session. It waits for its router and comes back by itself when that restarts.

    A router that refuses the user is waited for too: Zenoh does not tell it from one that is not
    there. Raises InputError where an endpoint makes no sense.
    """
    try:
        return zenoh.open(client_config(settings))
    except zenoh.ZError as error:
        where = f"bus {', '.join(settings.connect)}"
        mend = "check bus.connect"
        raise InputError(where, f"cannot be opened ({error})", mend) from None


def client_config(settings: BusSettings) -> zenoh.Config:
    """Zenoh's configuration of a service: client mode, no multicast, timestamps."""
    config = zenoh.Config()
    entries: dict[str, object] = {
        "mode": "client",
        "connect/endpoints": list(settings.connect),
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "connect/retry": {"period_init_ms": 200, "period_max_ms": 1000},
        "scouting/multicast/enabled": False,
        "timestamping/enabled": True,
        # a full queue towards a slow router drops at once instead of making the vehicle wait
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 1000,
    }
    if settings.user is not None:
        entries["transport/auth/usrpwd/user"] = settings.user
        entries["transport/auth/usrpwd/password"] = settings.password or ""
    tls = {
        "root_ca_certificate": settings.tls_root_ca,
        "connect_certificate": settings.tls_cert,
        "connect_private_key": settings.tls_key,
    }
    entries |= {f"transport/link/tls/{key}": path for key, path in tls.items() if path}
    if settings.tls_cert is not None:
        # without it Zenoh keeps the certificate to itself, and a router that asks for it refuses
        entries["transport/link/tls/enable_mtls"] = True
    for key, value in entries.items():
        config.insert_json5(key, json.dumps(value))
    return config


class Publishers:
    """One publisher a key, declared when first used."""

    def __init__(self, session: zenoh.Session) -> None:
        self._session = session
        self._publishers: dict[str, dict[Key, zenoh.ext.AdvancedPublisher]] = {}
        """By vehicle."""

    def put(self, vehicle_id: str, topic: str, source: str, payload: bytes) -> None:
        """Publish a message's payload; never waits for a reader."""
        key = Key(vehicle_id, topic, source)
        publishers = self._publishers.setdefault(vehicle_id, {})
        publisher = publishers.get(key)
        if publisher is None:
            publisher = publishers[key] = self._declare(key)
        publisher.put(payload)

    def forget(self, vehicle_id: str) -> None:
        """Undeclare the publishers of a vehicle; its next message declares them anew."""
        for publisher in self._publishers.pop(vehicle_id, {}).values():
            publisher.undeclare()  # type: ignore[no-untyped-call]

    def close(self) -> None:
        """Undeclare every publisher."""
        for vehicle_id in list(self._publishers):
            self.forget(vehicle_id)

    def _declare(self, key: Key) -> zenoh.ext.AdvancedPublisher:
        qos = QOS[key.topic]
        return zenoh.ext.declare_advanced_publisher(
            self._session,
            message_key(*key),
            encoding=ENCODING,
            congestion_control=qos.congestion_control,
            cache=zenoh.ext.CacheConfig(qos.cache_depth),
            # a sporadic heartbeat would make the router wait for a slow reader
            sample_miss_detection=zenoh.ext.MissDetectionConfig(
                heartbeat=qos.heartbeat_s, sporadic_heartbeat=None
            ),
        )


PUBLISHERS_MAX = 20_000
"""Of one topic that a reader keeps count of."""
OnSample = Callable[[str, bytes], None]
"""Gets key and payload on Zenoh's thread; only enqueues."""
OnLoss = Callable[[int], None]
"""Gets the number of samples that are lost for good, on Zenoh's thread."""


class Gaps:
    """Counts what a publisher numbered and a reader never got.

    Zenoh hands samples over in the order of their numbers and a gap only when it has given up
    recovering it, so a gap is a loss. Of many publishers the one not heard for longest is
    forgotten.
    """

    def __init__(self) -> None:
        self._last: dict[str, int] = {}

    def before(self, publisher: str, number: int) -> int:
        """How many are missing between a publisher's sample and the one before."""
        last = self._last.pop(publisher, None)
        if last is None and len(self._last) >= PUBLISHERS_MAX:
            self._last.pop(next(iter(self._last)))
        self._last[publisher] = number
        return 0 if last is None else max(number - last - 1, 0)


class Subscription:
    """Subscribers to some topics of some vehicles."""

    def __init__(
        self,
        session: zenoh.Session,
        vehicle_ids: Iterable[str],
        topics: Iterable[str],
        on_sample: OnSample,
        on_loss: OnLoss = lambda _: None,
    ) -> None:
        names = tuple(topics)
        self._subscribers = [
            self._subscribe(session, vehicle_id, topic, on_sample, on_loss)
            for vehicle_id in vehicle_ids
            for topic in names
        ]

    def close(self) -> None:
        """Undeclare every subscriber."""
        for subscriber in self._subscribers:
            subscriber.undeclare()  # type: ignore[no-untyped-call]

    @staticmethod
    def _subscribe(
        session: zenoh.Session, vehicle_id: str, topic: str, on_sample: OnSample, on_loss: OnLoss
    ) -> zenoh.ext.AdvancedSubscriber[None]:
        gaps = Gaps()

        def hear(sample: zenoh.Sample) -> None:
            if (source := sample.source_info) is not None and (
                lost := gaps.before(str(source.source_id), source.source_sn)
            ):
                on_loss(lost)
            on_sample(str(sample.key_expr), sample.payload.to_bytes())

        depth = QOS[topic].history_depth
        history = zenoh.ext.HistoryConfig(max_samples=depth)
        return zenoh.ext.declare_advanced_subscriber(
            session,
            message_key(vehicle_id, topic, "*"),
            hear,
            history=history if depth else None,
            recovery=zenoh.ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
        )
