"""What eta has learned outlives it: killed, started anew, with its database away meanwhile."""

import contextlib
import json
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa
import zenoh

from postgres import Cluster
from street import LAT_DEG, LON_DEG, VEHICLE
from wayline.bus import Publishers, open_session
from wayline.codec import encode
from wayline.database_address import parsed_address
from wayline.geo import WGS84
from wayline.messages import Arrivals, Health, Pose
from wayline_cli.listener import Heard, Listener
from wayline_cli.local_system import LocalSystem

WAIT_S = 30.0
POLL_S = 0.05
SOON_S = 1.0
"""From the first report to the first arrivals ..."""
SLOWER = 3.0
"""... or so many times as long as when all is well."""
SIDE_M, PLANNED_MPS, SPEED_MPS = 500.0, 10.0, 15.0
STOPS_M = (100.0, 900.0, 1_600.0)
AT_ONCE_S = 20
LAP_S = round(4 * SIDE_M / SPEED_MPS)
SECOND_NS = 1_000_000_000


def place(total_m: float) -> tuple[float, float, float]:
    """Longitude, latitude and heading so far round the square."""
    side, within_m = divmod(total_m % (4 * SIDE_M), SIDE_M)
    lon_deg, lat_deg = LON_DEG, LAT_DEG
    for number in range(int(side)):
        lon_deg, lat_deg, _ = WGS84.fwd(lon_deg, lat_deg, 90.0 * number, SIDE_M)
    lon_deg, lat_deg, _ = WGS84.fwd(lon_deg, lat_deg, 90.0 * side, within_m)
    return float(lon_deg), float(lat_deg), 90.0 * side


def write_square(path: Path) -> Path:
    corners = [list(place(number * SIDE_M)[:2]) for number in range(4)]
    line = {"type": "LineString", "coordinates": [*corners, corners[0]]}
    of_line = {"route_id": "square", "name": "Square", "loop": True}
    features = [
        {
            "type": "Feature",
            "geometry": line,
            "properties": {**of_line, "speeds_mps": [PLANNED_MPS] * 4},
        }
    ]
    features += [
        {
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": list(place(stop_m)[:2])},
            "properties": {"stop_id": f"stop-{number}", "name": f"Stop {number}", "dwell_s": 0.0},
        }
        for number, stop_m in enumerate(STOPS_M, 1)
    ]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


class Shuttle:
    """Drives round the square, half as fast again as planned, as a recording that is played."""

    def __init__(self, session: zenoh.Session) -> None:
        self._publishers = Publishers(session)
        self._start_ns = time.time_ns() // SECOND_NS * SECOND_NS - 20 * LAP_S * SECOND_NS
        self._second = 0

    def drive(self, seconds: int) -> int:
        """Publish the poses of so many seconds at once; the first one's instant."""
        now_ns = time.time_ns()
        played = Health(
            t_ns=now_ns, service="fusion", version="0", started_ns=now_ns, recorded=True
        )
        self._publishers.put(VEHICLE, "health", "fusion", encode(played))
        first_ns = self._start_ns + (self._second + 1) * SECOND_NS
        for _ in range(seconds):
            self._second += 1
            self._publishers.put(VEHICLE, "pose", "fusion", encode(self._pose()))
        return first_ns

    def _pose(self) -> Pose:
        total_m = SPEED_MPS * self._second
        lon_deg, lat_deg, heading_deg = place(total_m)
        return Pose(
            t_ns=self._start_ns + self._second * SECOND_NS,
            mode="fused",
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            heading_deg=heading_deg,
            speed_mps=SPEED_MPS,
            distance_m=total_m,
            east_std_m=1.0,
            north_std_m=1.0,
        )

    def close(self) -> None:
        self._publishers.close()


class Bench:
    """A router, eta on a database, and a vehicle."""

    def __init__(self, folder: Path, url: str, stack: contextlib.ExitStack) -> None:
        self._url = url
        self._usual_s = 0.0
        """What arrivals took at the worst while all was well: on a busy machine longer."""
        route = str(write_square(folder / "square.geojson"))
        options = {"vehicle_id": VEHICLE, "routes": [route], "database_url": url}
        self.system = LocalSystem(folder, **options, database_retry_s=1.0)
        stack.callback(self.system.close)
        self.system.start_router()
        session = stack.enter_context(open_session(self.system.bus))
        self.listener = Listener(session, VEHICLE, ("arrivals", "health"))
        stack.callback(self.listener.close)
        self.shuttle = Shuttle(session)
        stack.callback(self.shuttle.close)

    def start(self) -> None:
        self.system.start("eta")
        self.listener.await_alive("eta", timeout_s=WAIT_S)

    def kill(self) -> None:
        self.system.kill("eta")
        self.listener.await_alive("eta", up=False, timeout_s=WAIT_S)

    def drive_laps(self, laps: int) -> None:
        """As fast as eta follows."""
        for _ in range(laps * LAP_S // AT_ONCE_S):
            sent_s = time.monotonic()
            self._await_arrivals(self.shuttle.drive(AT_ONCE_S))
            self._usual_s = max(self._usual_s, time.monotonic() - sent_s)

    def arrivals_soon(self) -> Arrivals:
        """What is told of the next second, soon after the pose that begins it."""
        sent_s = time.monotonic()
        told = self._await_arrivals(self.shuttle.drive(2))
        took_s = time.monotonic() - sent_s
        assert took_s < SOON_S or took_s < SLOWER * self._usual_s
        return told

    def await_learned(self) -> list[float]:
        """Seconds to each stop, in their order, once they rest on what was learned."""
        deadline_s = time.monotonic() + WAIT_S
        told = self._await_arrivals(self.shuttle.drive(2))
        while {stop.confidence for stop in told.stops} != {"learned"}:
            assert time.monotonic() < deadline_s, told
            threading.Event().wait(POLL_S)
            told = self._await_arrivals(self.shuttle.drive(2))
        by_stop = sorted((stop.stop_id, stop.arrival_ns - told.t_ns) for stop in told.stops)
        return [each_ns / SECOND_NS for _, each_ns in by_stop]

    def _await_arrivals(self, t_ns: int) -> Arrivals:
        heard = self.listener.await_message(
            "arrivals", lambda heard: heard.message.t_ns >= t_ns, timeout_s=WAIT_S
        )
        assert isinstance(heard.message, Arrivals)
        return heard.message

    def rows(self) -> list[tuple[object, ...]]:
        """What vehicles took, as the database has it."""
        engine = sa.create_engine(parsed_address(self._url))
        try:
            if not sa.inspect(engine).has_table("eta_taken"):
                return []
            with engine.connect() as connection:
                query = "SELECT * FROM eta_taken ORDER BY vehicle_id, t_ns"
                return [tuple(row) for row in connection.exec_driver_sql(query)]
        finally:
            engine.dispose()

    def await_rows(self, count: int) -> list[tuple[object, ...]]:
        deadline_s = time.monotonic() + WAIT_S
        while len(rows := self.rows()) < count:
            assert time.monotonic() < deadline_s, f"{len(rows)} rows, {count} expected"
            threading.Event().wait(POLL_S)
        return rows

    def await_database_away(self) -> None:
        def is_away(heard: Heard) -> bool:
            message = heard.message
            return isinstance(message, Health) and "database away" in (message.detail or "")

        self.listener.await_message("health", is_away, timeout_s=WAIT_S)


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Callable[[str], Bench]]:
    with contextlib.ExitStack() as stack:
        yield lambda url: Bench(tmp_path, url, stack)


def test_what_was_learned_outlives_a_kill(bench: Callable[[str], Bench], database_url: str) -> None:
    vehicle = bench(database_url)
    vehicle.start()
    vehicle.drive_laps(4)
    before_s = vehicle.await_learned()
    kept = vehicle.await_rows(3 * len(STOPS_M))
    vehicle.kill()
    assert set(kept) <= set(vehicle.rows())
    vehicle.start()
    first = vehicle.arrivals_soon()
    assert len(first.stops) == len(STOPS_M)
    after_s = vehicle.await_learned()
    lap_s = 4 * SIDE_M / SPEED_MPS
    later_s = [(before - after) % lap_s for before, after in zip(before_s, after_s, strict=True)]
    assert max(later_s) - min(later_s) < 3.0, "each is as much nearer: legs take what they took"


def test_what_was_learned_without_the_database_comes_into_it(
    bench: Callable[[str], Bench], postgres: Cluster
) -> None:
    """Which is away when eta starts, and stops again while it works."""
    url = postgres.new_url()
    postgres.stop()
    vehicle = bench(url)
    vehicle.start()
    vehicle.await_database_away()
    assert len(vehicle.arrivals_soon().stops) == len(STOPS_M)
    vehicle.drive_laps(2)
    assert len(vehicle.arrivals_soon().stops) == len(STOPS_M)
    postgres.start()
    kept = vehicle.await_rows(2 * len(STOPS_M) - 1)
    postgres.stop("immediate")
    vehicle.drive_laps(2)
    assert len(vehicle.arrivals_soon().stops) == len(STOPS_M)
    postgres.start()
    more = vehicle.await_rows(len(kept) + 2 * len(STOPS_M) - 1)
    assert set(kept) <= set(more)
    vehicle.kill()
    vehicle.start()
    assert vehicle.await_learned()
    assert set(more) <= set(vehicle.rows())
