"""Eta as its process runs it: from what is on the bus to what it answers over HTTP."""

import time
from argparse import Namespace
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
from fastapi.testclient import TestClient

from loops import Run, Running
from street import street_fix, write_route
from unit.eta.route_drives import SECOND_NS
from wayline.http import Healthz
from wayline.messages import Arrivals, Health, Pose
from wayline.settings import Settings
from wayline.telemetry import Telemetry
from wayline.tuning import Tuning
from wayline_eta.__main__ import build

WAIT_S = 10.0


class Eta:
    """The service of a configuration at work, and its answers."""

    def __init__(self, run: Run, folder: Path, tuning: Tuning) -> None:
        routes = (str(write_route(folder / "street.geojson")),)
        service = build(Settings(vehicles=("*",), routes=routes, tuning=tuning), Namespace())
        assert service.make_app is not None
        app = service.make_app(
            lambda: Healthz(ok=True, service="eta", version="0"), Telemetry("eta", 0)
        )
        service.make_app = None
        self._http = TestClient(app, base_url="http://localhost")
        self.running: Running = run(service, Settings(vehicles=("*",), tuning=tuning))
        self.running.await_start()

    def get(self, path: str) -> Any:
        return self._http.get(path).json()

    def await_answer(self, path: str, matches: Callable[[Any], bool]) -> Any:
        deadline_s = time.monotonic() + WAIT_S
        while not matches(answer := self.get(path)):
            assert time.monotonic() < deadline_s, answer
            time.sleep(0.05)
        return answer

    def drive(self, seconds: int, start_ns: int) -> None:
        """Poses of a vehicle on the street, a second apart, all at once."""
        for second in range(seconds):
            fix = street_fix(start_ns, second)
            pose = Pose(
                t_ns=fix.t_ns,
                mode="gps",
                lat_deg=fix.lat_deg,
                lon_deg=fix.lon_deg,
                heading_deg=0.0,
                speed_mps=10.0,
                distance_m=10.0 * second,
                east_std_m=1.0,
                north_std_m=1.0,
            )
            self.running.put(pose, source="fusion")


ARRIVALS = "/v1/vehicles/bus-7/arrivals"


def whole_second_ns() -> int:
    return time.time_ns() // SECOND_NS * SECOND_NS


def test_a_fix_stands_in_where_fusion_is_silent(run: Run, tmp_path: Path) -> None:
    eta = Eta(run, tmp_path, Tuning())
    eta.running.put(street_fix(whole_second_ns(), 0), source="gps-ingest")
    found = eta.await_answer("/v1/vehicles/bus-7", lambda answer: "position" in answer)
    assert found["position"]["source"] == "gps-ingest"


def test_of_two_vehicles_with_one_id_one_is_followed_and_health_counts_the_other(
    run: Run, tmp_path: Path
) -> None:
    """Reports in turns from the street and from eleven kilometres north of it."""
    eta = Eta(run, tmp_path, Tuning())
    now_ns = whole_second_ns()
    for second in range(-150, 1, 15):
        fix = msgspec.structs.replace(street_fix(now_ns - 150 * SECOND_NS, 150 + second), hdop=1.0)
        assert fix.lat_deg is not None
        elsewhere = msgspec.structs.replace(fix, lat_deg=fix.lat_deg + 0.1)
        eta.running.put(elsewhere if second % 30 else fix, source="gps-ingest")
    health = eta.running.await_health(lambda health: health.bad_input > 0)
    assert health.bad_input == 5
    found = eta.await_answer("/v1/vehicles/bus-7", lambda answer: "progress" in answer)
    assert found["on_route"]


@pytest.mark.parametrize("step_s", [3600.0, -3600.0])
def test_a_step_of_the_hosts_clock_changes_no_answer(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step_s: float
) -> None:
    eta = Eta(run, tmp_path, Tuning())
    eta.drive(5, whole_second_ns() - 4 * SECOND_NS)
    eta.await_answer(ARRIVALS, lambda answer: len(answer.get("arrivals", ())) == 3)
    true_ns = time.time_ns
    monkeypatch.setattr(time, "time_ns", lambda: true_ns() + round(step_s * 1e9))
    before_s = eta.get("/v1/vehicles/bus-7")["age_s"]
    time.sleep(0.3)
    assert 0.25 < eta.get("/v1/vehicles/bus-7")["age_s"] - before_s < 2.0
    # that it is no recording is known to whoever asks
    health = Health(t_ns=true_ns(), service="gps-ingest", version="0", started_ns=true_ns())
    eta.running.put(health, source="gps-ingest")
    for second in range(6, 10):
        eta.drive(second, true_ns() // SECOND_NS * SECOND_NS - second * SECOND_NS)
        time.sleep(0.5)
    found = eta.get(ARRIVALS)["arrivals"]
    assert [(at["stale"], at["age_s"] < 15.0) for at in found] == [(False, True)] * 3


def test_silence_makes_arrivals_stale_and_then_ends_them_as_configured(
    run: Run, tmp_path: Path
) -> None:
    tuning = Tuning(eta_stale_after_s=2.0, eta_forget_after_s=4.0)
    eta = Eta(run, tmp_path, tuning)
    eta.drive(5, whole_second_ns() - 4 * SECOND_NS)
    eta.await_answer(ARRIVALS, lambda answer: len(answer.get("arrivals", ())) == 3)
    eta.await_answer(ARRIVALS, lambda answer: all(at["stale"] for at in answer["arrivals"]))
    assert len(eta.get(ARRIVALS)["arrivals"]) == 3
    eta.await_answer(ARRIVALS, lambda answer: answer["arrivals"] == [])
    told = [heard.message for heard in eta.running.listener.heard("arrivals")]
    ended = [at for at in told if isinstance(at, Arrivals) and at.stale]
    assert [len(at.stops) for at in ended[-2:]] == [3, 0]
