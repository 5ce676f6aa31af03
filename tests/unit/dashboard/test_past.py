"""The page asks its own host for the past, which is passed on as history tells it."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from builders import at
from unit.history.driven import VEHICLE, legs
from unit.history.keeping import History
from wayline.http_server import HttpServer
from wayline.http_settings import HttpSettings
from wayline.rfc3339 import rfc3339
from wayline_dashboard.app import create_dashboard
from wayline_dashboard.live_view import LiveView
from wayline_history.app import create_history_app
from wayline_history.archive import Archive

TOKEN = "one-long-token-of-the-fleet"
SPAN = {"from": rfc3339(at(0)), "to": rfc3339(at(3600))}
AUTHORIZED = {"authorization": f"Bearer {TOKEN}"}


@pytest.fixture
def history_url(tmp_path: Path) -> Iterator[str]:
    url = f"sqlite:///{tmp_path}/history.db"
    history = History(url)
    history.keep(legs((60, 0.0), (100, 10.0), (40, 0.0)))
    settings = HttpSettings(port=0, tokens=(TOKEN,))
    app = create_history_app(Archive(url), settings, now_ns=lambda: at(3600))
    with HttpServer(app, settings, 0) as server:
        yield server.url
    history.engine.dispose()


def page(history_url: str) -> TestClient:
    settings = HttpSettings(tokens=(TOKEN,))
    app = create_dashboard(LiveView(), settings, history_url=history_url)
    return TestClient(app, base_url="http://localhost", headers=AUTHORIZED)


def test_what_history_tells_is_passed_on(history_url: str) -> None:
    track = page(history_url).get(f"/v1/vehicles/{VEHICLE}/track", params=SPAN | {"step_s": 10})
    assert len(track.json()["points"]) == 20
    file = page(history_url).get(f"/v1/vehicles/{VEHICLE}/track.gpx", params=SPAN)
    assert file.headers["content-disposition"] == f'attachment; filename="{VEHICLE}-fused.gpx"'
    assert file.headers["content-type"] == "application/gpx+xml"


def test_so_is_what_history_refuses(history_url: str) -> None:
    http = page(history_url)
    assert http.get("/v1/vehicles/bus-9/trips", params=SPAN).status_code == 404
    unfit = http.get(f"/v1/vehicles/{VEHICLE}/events", params={"from": "soon"})
    assert unfit.status_code == 422
    assert "soon" in unfit.json()["detail"]
    assert http.get(f"/v1/vehicles/{VEHICLE}/secrets").status_code == 422


@pytest.mark.parametrize("name", ["..%2F..%2Fmetrics%3F", "..", "%1f", "Bus 7", "%F3%A8"])
def test_a_name_that_is_none_leads_nowhere(history_url: str, name: str) -> None:
    assert page(history_url).get(f"/v1/vehicles/{name}/trips").status_code == 404


def test_a_page_without_the_token_learns_nothing(history_url: str) -> None:
    http = page(history_url)
    http.headers.pop("authorization")
    assert http.get(f"/v1/vehicles/{VEHICLE}/track", params=SPAN).status_code == 401


def test_a_history_that_is_not_there_is_a_problem() -> None:
    answer = page("http://127.0.0.1:9").get(f"/v1/vehicles/{VEHICLE}/trips")
    assert answer.status_code == 503
    assert "does not answer" in answer.json()["detail"]
