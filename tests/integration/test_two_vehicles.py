"""Two vehicles in one slope-map process: what the one has learned the other knows at once."""

import contextlib
import json
import threading
import time
import urllib.request
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

import msgspec
import pytest
import zenoh

from unit.slope_map.hilly_road import SECOND_NS, drive
from wayline.bus import Publishers, open_session
from wayline.codec import encode
from wayline.messages import Health, Horizon, Message, Pose
from wayline_cli.listener import Listener
from wayline_cli.local_system import LocalSystem

WAIT_S, POLL_S = 40.0, 0.05
LENGTH_M, SPEED_MPS = 1_500.0, 20.0
POSE_NS = SECOND_NS // 2
AT_ONCE_NS = SECOND_NS
"""A burst of horizons would be dropped on the bus, as of a reader that is slow."""
VEHICLES = ("truck-1", "truck-2")
ENDS_M = 60.0
"""Of the road's last bins less is known, and beyond it nothing."""


class Bench:
    """A router and slope-map for two trucks, which are played as recordings."""

    def __init__(self, session: zenoh.Session, system: LocalSystem) -> None:
        self.system = system
        self.listener = Listener(session, "*", ("horizon", "health"))
        self.listener.await_alive("slope-map", timeout_s=WAIT_S)
        self._publishers = Publishers(session)
        self._now_ns = time.time_ns() // SECOND_NS * SECOND_NS
        self._ended = threading.Event()
        self._telling = threading.Thread(target=self._tell_of_recordings)
        self._telling.start()

    def _tell_of_recordings(self) -> None:
        while not self._ended.wait(POLL_S):
            t_ns = time.time_ns()
            played = Health(
                t_ns=t_ns, service="fusion", version="0", started_ns=t_ns, recorded=True
            )
            for vehicle_id in VEHICLES:
                self._put(vehicle_id, played)

    def drive(self, vehicle_id: str, hours_ago: int, seed: int) -> list[Horizon]:
        """A drive over the road, as fast as slope-map follows, and fusion's restart at its end."""
        start_ns = self._now_ns - hours_ago * 3_600 * SECOND_NS
        messages = drive(seed=seed, length_m=LENGTH_M, speed_mps=SPEED_MPS, start_ns=start_ns)
        told = [each for each in messages if isinstance(each, Message) and is_heard(each)]
        self._begin(vehicle_id, next(each for each in told if isinstance(each, Pose)))
        for _, together in groupby(told, key=lambda each: each.t_ns // AT_ONCE_NS):
            last_ns = 0
            for message in together:
                self._put(vehicle_id, message)
                last_ns = max(last_ns, message.t_ns // SECOND_NS * SECOND_NS)
            self._await_horizon(last_ns)
        last = next(each for each in reversed(told) if isinstance(each, Pose))
        anew = msgspec.structs.replace(last, t_ns=last.t_ns + SECOND_NS // 10, distance_m=0.0)
        self._put(vehicle_id, anew)
        return [each for each in self._horizons() if start_ns <= each.t_ns <= last.t_ns]

    def _begin(self, vehicle_id: str, first: Pose) -> None:
        """Stand at the start for a second: what comes with a first pose may overtake it."""
        stands = msgspec.structs.replace(first, t_ns=first.t_ns - SECOND_NS)
        self._put(vehicle_id, stands)
        self._await_horizon(stands.t_ns)

    def _await_horizon(self, t_ns: int) -> None:
        """Of a second or a later one: where the machine stalls a second goes by without a pose."""
        self.listener.await_message("horizon", lambda h: h.message.t_ns >= t_ns, timeout_s=WAIT_S)

    def _horizons(self) -> list[Horizon]:
        told = [each.message for each in self.listener.heard("horizon")]
        return [each for each in told if isinstance(each, Horizon)]

    def _put(self, vehicle_id: str, message: Message) -> None:
        self._publishers.put(vehicle_id, message.topic, "fusion", encode(message))

    def asked(self, path: str) -> Any:
        with urllib.request.urlopen(self.system.url("slope-map") + path, timeout=WAIT_S) as answer:
            return json.load(answer)

    def await_runs(self, count: int) -> str:
        """Wait until so many runs are known of the one road; its id."""
        deadline_s, pause = time.monotonic() + WAIT_S, threading.Event()
        while True:
            ways = [way for road in self.asked("/v1/roads")["roads"] for way in road["directions"]]
            if [way["runs"] for way in ways] == [count]:
                return str(self.asked("/v1/roads")["roads"][0]["road_id"])
            assert time.monotonic() < deadline_s, self.system.said("slope-map")
            pause.wait(POLL_S)

    def close(self) -> None:
        self._ended.set()
        self._telling.join()
        self._publishers.close()
        self.listener.close()


def is_heard(message: Message) -> bool:
    """Two poses a second are enough."""
    return not isinstance(message, Pose) or message.t_ns % POSE_NS == 0


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    url = f"sqlite:///{tmp_path}/slope.db"
    with (
        LocalSystem(tmp_path, vehicles=VEHICLES, database_url=url) as system,
        contextlib.ExitStack() as stack,
    ):
        system.start_router()
        system.start("slope-map")
        trucks = Bench(stack.enter_context(open_session(system.bus)), system)
        stack.callback(trucks.close)
        yield trucks


def test_what_one_vehicle_has_learned_is_in_every_horizon_of_the_other(bench: Bench) -> None:
    """Also of one that was heard before: the second has learned the road by itself already."""
    bench.drive("truck-2", 4, seed=9)
    road_id = bench.await_runs(1)
    bench.drive("truck-1", 3, seed=1)
    assert bench.await_runs(2) == road_id
    horizons = bench.drive("truck-2", 2, seed=2)
    assert len(horizons) > 0.9 * LENGTH_M / SPEED_MPS
    assert {each.road_id for each in horizons} == {road_id}
    ahead = [each for each in horizons if (each.position_m or 0.0) < LENGTH_M - ENDS_M]
    assert len(ahead) > 65
    assert {each.points[0].runs for each in ahead} == {2}
    bench.await_runs(3)
    by_vehicle = {each: bench.asked(f"/v1/vehicles/{each}/runs")["runs"] for each in VEHICLES}
    assert {each: len(runs) for each, runs in by_vehicle.items()} == {"truck-1": 1, "truck-2": 2}
