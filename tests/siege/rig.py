"""The services that keep something, as real processes, around a vehicle that drives in circles."""

import contextlib
import itertools
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import sqlalchemy as sa

from siege.circling import VEHICLE, Circling
from wayline.bus import open_session
from wayline.database_address import parsed_address
from wayline.messages import Health
from wayline_cli.listener import Listener
from wayline_cli.local_system import LocalSystem

STORES = ("fusion", "slope-map")
START_S = 40.0
BACK_S = 10.0
"""After the end of a fault's cause all is well again within this time."""
POSES_HZ, GAP_MAX_S = 10.0, 0.3
RUN_M = 160.0
POLL_S = 0.05


class Rig:
    """A router, fusion and slope-map on one database, and what they say of a vehicle."""

    def __init__(self, folder: Path, database_url: str, *, speed: float = 1.0) -> None:
        self.url, self._speed = database_url, speed
        self.system = LocalSystem(
            folder,
            vehicle_id=VEHICLE,
            database_url=database_url,
            database_retry_s=2.0,
            database_refresh_s=2.0,
        )
        with self.system.config.open("a") as config:
            config.write(f"[tuning]\nmap_run_max_m = {RUN_M}\n")
        self._stack = contextlib.ExitStack()
        self.listener: Listener

    def __enter__(self) -> "Rig":
        """Start everything; returns when poses come."""
        with contextlib.ExitStack() as stack:
            stack.callback(self.system.close)
            self.system.start_router()
            for service in STORES:
                self.system.start(service)
            session = stack.enter_context(open_session(self.system.bus))
            self.listener = Listener(session, VEHICLE, ("pose", "health"))
            stack.callback(self.listener.close)
            self.listener.await_alive(*STORES, timeout_s=START_S)
            self._vehicle = stack.enter_context(Circling(session, self._speed))
            self.listener.await_message("pose", timeout_s=START_S)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def await_detail(self, service: str, matches: Callable[[str], bool]) -> float:
        """Wait until a service's health says of its database what fits; seconds that took."""
        begun_s = time.monotonic()

        def fits(health: object) -> bool:
            return isinstance(health, Health) and matches(health.detail or "")

        self.listener.await_message(
            "health",
            lambda h: h.source == service and h.received_s > begun_s and fits(h.message),
            timeout_s=START_S,
        )
        return time.monotonic() - begun_s

    def await_well(self) -> float:
        """Wait until every store says that all is well; seconds that took. Fails if too long."""
        begun_s = time.monotonic()
        for service in STORES:
            self.await_detail(service, lambda detail: "database" not in detail)
        took_s = time.monotonic() - begun_s
        assert took_s < BACK_S, f"well again only after {took_s:.1f} s"
        return took_s

    def poses_go_on(self) -> contextlib.AbstractContextManager[None]:
        """While the block runs, poses come ten times a second without a gap."""
        return poses_go_on(self.listener, self._vehicle)

    def runs(self) -> list[tuple[int, int]]:
        """Start and end of every run in the ledger, in order of time."""
        query = "SELECT start_ns, end_ns FROM slope_ledger ORDER BY start_ns"
        with self._connection() as connection:
            return [(row[0], row[1]) for row in connection.exec_driver_sql(query)]

    def saved_ns(self) -> int:
        """The instant of what fusion kept last, 0 where there is nothing."""
        with self._connection() as connection:
            return connection.exec_driver_sql("SELECT max(t_ns) FROM fusion_vehicle").scalar() or 0

    def integrity(self) -> str:
        """What SQLite says of its file."""
        with self._connection() as connection:
            return str(connection.exec_driver_sql("PRAGMA integrity_check").scalar())

    def await_runs(self, count: int) -> None:
        """Wait until so many runs are kept."""
        deadline_s, pause = time.monotonic() + 2 * START_S, threading.Event()
        while len(self.runs()) < count:
            assert time.monotonic() < deadline_s, f"{len(self.runs())} runs, {count} expected"
            pause.wait(POLL_S)

    @contextlib.contextmanager
    def _connection(self) -> Iterator[sa.Connection]:
        engine = sa.create_engine(parsed_address(self.url))
        try:
            with engine.connect() as connection:
                yield connection
        finally:
            engine.dispose()


@contextlib.contextmanager
def poses_go_on(listener: Listener, vehicle: Circling) -> Iterator[None]:
    """While the block runs, a vehicle's poses come ten times a second without a gap."""
    begun_s, vehicle.late_s = time.monotonic(), 0.0
    yield
    ended_s = time.monotonic()
    times_s = [h.received_s for h in listener.heard("pose")]
    times_s = [begun_s, *(t for t in times_s if begun_s < t < ended_s), ended_s]
    gaps_s = [after - before for before, after in itertools.pairwise(times_s)]
    rate_hz = (len(times_s) - 2) / (ended_s - begun_s)
    late = f"the vehicle at most {vehicle.late_s:.3f} s late"
    print(f"poses: {rate_hz:.2f} Hz, longest gap {max(gaps_s):.3f} s, {late}")
    assert max(gaps_s) < GAP_MAX_S + vehicle.late_s
    assert abs(rate_hz - POSES_HZ) < max(0.1, 2.0 / (ended_s - begun_s))


def holes_s(runs: list[tuple[int, int]]) -> list[float]:
    """Times between runs in which nothing was kept of the road."""
    return [(after[0] - before[1]) * 1e-9 for before, after in itertools.pairwise(runs)]
