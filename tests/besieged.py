"""A system of real processes under attack, with an honest vehicle that all must go on for."""

import contextlib
import json
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from street import VEHICLE, place, write_route
from wayline.bus import Publishers, open_session
from wayline.codec import encode
from wayline.messages import Health, Message, Pose
from wayline_cli.listener import Listener
from wayline_cli.local_system import LocalSystem

WAIT_S = 30.0
POLL_S = 0.05
HEARD = ("pose", "progress", "arrivals", "horizon", "health")
SPEED_MPS = 10.0


class Besieged:
    """Services of a fleet, alive, and sessions beside them; all end with the block."""

    def __init__(self, folder: Path, services: Sequence[str], **options: object) -> None:
        known: dict[str, object] = {
            "routes": [str(write_route(folder / "street.geojson"))],
            "database_url": f"sqlite:///{folder / 'wayline.db'}",
            **options,
        }
        if "vehicle_id" not in known:
            known.setdefault("vehicles", ["*"])
        self.system = LocalSystem(folder, **known)
        self.services = services

    def __enter__(self) -> "Besieged":
        with contextlib.ExitStack() as stack:
            stack.enter_context(self.system)
            self.system.start_router()
            for service in self.services:
                self.system.start(service)
            session = stack.enter_context(open_session(self.system.bus))
            self._publishers = Publishers(session)
            stack.callback(self._publishers.close)
            self.listener = Listener(session, VEHICLE, HEARD)
            stack.callback(self.listener.close)
            self.fleet = Listener(session, "_fleet", ("health",))
            stack.callback(self.fleet.close)
            self.listener.await_alive(*self.services, timeout_s=WAIT_S)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def restart(self, service: str) -> None:
        """Kill a service and start it anew; returns when it is alive."""
        self.system.kill(service)
        self.listener.await_alive(service, up=False, timeout_s=WAIT_S)
        self.system.start(service)
        self.listener.await_alive(service, timeout_s=WAIT_S)

    def put(self, message: Message, vehicle_id: str = VEHICLE, source: str = "fusion") -> None:
        """Publish a message of any vehicle."""
        self.put_payload(encode(message), message.topic, vehicle_id, source)

    def put_payload(
        self, payload: bytes, topic: str, vehicle_id: str = VEHICLE, source: str = "fusion"
    ) -> None:
        """Publish any payload under a vehicle's key."""
        self._publishers.put(vehicle_id, topic, source, payload)

    def get(self, service: str, path: str) -> Any:
        """A service's answer with status 200."""
        status, body = self.asked(service, path)
        assert status == 200, f"{service}{path}: {status} {body}"
        return body

    def asked(self, service: str, path: str) -> tuple[int, Any]:
        """Status and body of a service's answer."""
        try:
            with urllib.request.urlopen(f"{self.system.url(service)}{path}", timeout=10) as answer:
                return answer.status, json.loads(answer.read())
        except urllib.error.HTTPError as error:
            with error:
                return error.code, json.loads(error.read())

    def health(self, service: str) -> Health:
        """A service's last word on itself."""
        heards = [*self.fleet.heard("health"), *self.listener.heard("health")]
        said = [
            heard.message
            for heard in sorted(heards, key=lambda heard: heard.received_s)
            if isinstance(heard.message, Health) and heard.message.service == service
        ]
        return said[-1]

    def await_later(self, topic: str, t_ns: int) -> None:
        """Wait for a message about the honest vehicle's state later than an instant."""
        self.listener.await_message(
            topic, lambda heard: heard.message.t_ns > t_ns, timeout_s=WAIT_S
        )

    def assert_stands(self) -> None:
        """No service has ended since the start."""
        for service in self.services:
            alive = self.system.is_running(service)
            assert alive, f"{service} ended: {self.system.said(service)[-2000:]}"


def street_pose(t_ns: int, distance_m: float) -> Pose:
    """A good pose so far along the street, which begins again at its end."""
    lat_deg, lon_deg = place(distance_m % 2_900.0)
    return Pose(
        t_ns=t_ns,
        mode="gps",
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        heading_deg=0.0,
        speed_mps=SPEED_MPS,
        distance_m=max(distance_m, 0.0),
        east_std_m=2.0,
        north_std_m=2.0,
    )


class Bus:
    """The honest vehicle: drives up its street, a pose ten times a second of the host's clock."""

    def __init__(self, besieged: Besieged) -> None:
        self._besieged = besieged
        self._start_s = time.time()
        self._stop = threading.Event()
        self.sent: list[tuple[int, float]] = []
        """Instants of poses and when they were sent, by the monotonic clock."""
        self._thread = threading.Thread(target=self._run, name="bus")

    def __enter__(self) -> "Bus":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    def await_known(self) -> None:
        """Wait until everything that follows from a pose sent from now on was heard."""
        since_ns = time.time_ns()
        for topic in ("progress", "arrivals", "horizon"):
            self._besieged.await_later(topic, since_ns)

    def pose(self, t_ns: int) -> Pose:
        """Where it is at an instant."""
        return street_pose(t_ns, SPEED_MPS * (t_ns * 1e-9 - self._start_s))

    def _run(self) -> None:
        tenth_s = round(time.time() * 10) + 1
        while not self._stop.wait(max(tenth_s / 10 - time.time(), 0.0)):
            pose = self.pose(tenth_s * 100_000_000)
            self.sent.append((pose.t_ns, time.monotonic()))
            self._besieged.put(pose)
            tenth_s += 1


def await_true(condition: Callable[[], bool], what: str, timeout_s: float = WAIT_S) -> float:
    """Seconds until a condition holds; fails where it does not."""
    start_s = time.monotonic()
    while not condition():
        assert time.monotonic() - start_s < timeout_s, f"not within {timeout_s:g} s: {what}"
        time.sleep(POLL_S)
    return time.monotonic() - start_s
