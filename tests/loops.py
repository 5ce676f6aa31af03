"""The one loop running a service in a thread, on a session that reaches nobody but itself."""

import json
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor

import pytest
import zenoh

from wayline.bus import Publishers
from wayline.codec import encode
from wayline.ending import Ending
from wayline.keys import FLEET
from wayline.loop import Loop
from wayline.messages import Health, Message, Odometer
from wayline.service import Service
from wayline.settings import Settings
from wayline_cli.listener import Listener

WAIT_S = 10.0
TOPICS = ("odometer", "gyro", "health", "progress", "arrivals", "horizon")


@pytest.fixture
def session() -> Iterator[zenoh.Session]:
    config = zenoh.Config()
    config.insert_json5("listen/endpoints", json.dumps([]))
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")
    with zenoh.open(config) as opened:
        yield opened


class Running:
    """A loop in a thread, the bus around it."""

    def __init__(self, session: zenoh.Session, service: Service, settings: Settings) -> None:
        self._threads = ThreadPoolExecutor(1)
        self._ending = Ending()
        self._publishers = Publishers(session)
        home = settings.vehicle_id or FLEET
        self.listener = Listener(session, "*", TOPICS)
        self._ended: Future[None] = self._threads.submit(
            Loop(service, settings, session, self._ending).run
        )
        self.home = home

    def await_start(self) -> None:
        self.listener.await_message("health", timeout_s=WAIT_S)

    def put(self, message: Message, vehicle_id: str = "bus-7", source: str = "test") -> None:
        self.put_payload(encode(message), message.topic, vehicle_id, source)

    def put_payload(
        self, payload: bytes, topic: str, vehicle_id: str = "bus-7", source: str = "test"
    ) -> None:
        self._publishers.put(vehicle_id, topic, source, payload)

    def await_odometer(self, t_ns: int, speed_mps: float) -> None:
        wanted = Odometer(t_ns=t_ns, speed_mps=speed_mps)
        self.listener.await_message("odometer", lambda h: h.message == wanted, timeout_s=WAIT_S)

    def await_health(self, matches: Callable[[Health], bool]) -> Health:
        heard = self.listener.await_message(
            "health",
            lambda h: isinstance(h.message, Health) and matches(h.message),
            timeout_s=WAIT_S,
        )
        assert isinstance(heard.message, Health)
        return heard.message

    def request_end(self) -> None:
        """Ask the loop to stop, and do not wait for it."""
        self._ending.request()

    def end(self) -> None:
        """Stop the loop; raises what it raised."""
        self._ending.request()
        self._ended.result(WAIT_S)

    def result(self) -> None:
        """Wait for a loop that ends by itself; raises what it raised."""
        self._ended.result(WAIT_S)

    def close(self) -> None:
        self._ending.request()
        self._threads.shutdown()
        self._publishers.close()
        self.listener.close()


Run = Callable[..., Running]


@pytest.fixture
def run(session: zenoh.Session) -> Iterator[Run]:
    started: list[Running] = []

    def start(service: Service, settings: Settings) -> Running:
        started.append(Running(session, service, settings))
        return started[-1]

    yield start
    for running in started:
        running.close()
