"""The dashboard as its process runs it: from what is on the bus to what it answers over HTTP."""

import datetime as dt
import time
from argparse import Namespace
from collections.abc import Callable
from typing import Any

import pytest
from fastapi.testclient import TestClient

from loops import Run, Running
from wayline.http import Healthz
from wayline.messages import Health, Horizon, HorizonPoint, Pose
from wayline.service import no_core
from wayline.settings import Settings
from wayline.telemetry import Telemetry
from wayline_dashboard.__main__ import build

WAIT_S = 10.0
HOUR_S = 3600


class Dashboard:
    """The service at work, and its answers."""

    def __init__(self, run: Run, settings: Settings) -> None:
        service = build(settings, Namespace())
        assert service.make_app is not None
        healthy = Healthz(ok=True, service="dashboard", version="0")
        app = service.make_app(lambda: healthy, Telemetry("dashboard", 0))
        service.make_app = None
        self.http = TestClient(app, base_url="http://localhost")
        self.running: Running = run(service, settings)
        self.running.await_start()

    def await_view(self, matches: Callable[[Any], bool], **parameters: str) -> Any:
        deadline_s = time.monotonic() + WAIT_S
        while not matches(view := self.http.get("/v1/view", params=parameters).json()):
            assert time.monotonic() < deadline_s, view
            time.sleep(0.05)
        return view

    def await_pose(self) -> Any:
        return self.await_view(lambda view: any("pose" in each for each in view["vehicles"]))


def pose(age_s: float = 0.0) -> Pose:
    t_ns = time.time_ns() - round(age_s * 1e9)
    return Pose(t_ns=t_ns, mode="gps", lat_deg=39.9, lon_deg=-75.35)


def health(*, recorded: bool) -> Health:
    now_ns = time.time_ns()
    return Health(t_ns=now_ns, service="fusion", version="0", started_ns=now_ns, recorded=recorded)


def age_s(view: Any) -> float:
    (vehicle,) = view["vehicles"]
    now, heard = (dt.datetime.fromisoformat(at) for at in (view["now"], vehicle["heard"]))
    return (now - heard).total_seconds()


@pytest.fixture
def dashboard(run: Run) -> Dashboard:
    return Dashboard(run, Settings(vehicles=("*",), forget_vehicle_after_s=2.0))


def test_it_shows_and_has_no_core() -> None:
    service = build(Settings(vehicles=("*",)), Namespace())
    assert (service.make_node, service.core_reads) == (no_core, frozenset())
    assert Horizon in service.reads


def test_what_is_on_the_bus_is_in_the_view(dashboard: Dashboard) -> None:
    dashboard.running.put(pose(), source="fusion")
    point = HorizonPoint(distance_m=0.0, grade_pct=2.0)
    dashboard.running.put(Horizon(t_ns=time.time_ns(), points=(point,)), source="slope-map")
    dashboard.await_pose()
    view = dashboard.await_view(
        lambda view: any("horizon" in each for each in view.get("vehicles", ())), vehicle_id="bus-7"
    )
    (vehicle,) = view["vehicles"]
    assert vehicle["horizon"]["points"][0]["grade_pct"] == 2.0


@pytest.mark.parametrize(("recorded", "wanted_s"), [(False, HOUR_S), (True, 0.0)])
def test_an_hour_old_pose_is_an_hour_old_unless_it_is_recorded(
    dashboard: Dashboard, recorded: bool, wanted_s: float
) -> None:
    dashboard.running.put(health(recorded=recorded), source="fusion")
    dashboard.await_view(lambda view: len(view["vehicles"]) == 1)
    dashboard.running.put(pose(HOUR_S), source="fusion")
    assert age_s(dashboard.await_pose()) == pytest.approx(wanted_s, abs=2.0)


def test_a_vehicle_silent_for_long_is_gone_until_it_is_heard_again(dashboard: Dashboard) -> None:
    dashboard.running.put(pose(), source="fusion")
    dashboard.await_pose()
    dashboard.await_view(lambda view: view["vehicles"] == [])
    dashboard.running.put(pose(), source="fusion")
    dashboard.await_pose()
