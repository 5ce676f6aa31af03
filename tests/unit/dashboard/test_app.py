from pathlib import Path

import pytest
from fastapi import WebSocketDisconnect
from fastapi.testclient import TestClient

from browser.shuttle import SECOND_NS, Shuttle
from wayline.errors import InputError
from wayline.http_settings import HttpSettings
from wayline.messages import Pose
from wayline.view import Receipt
from wayline_dashboard.app import create_dashboard
from wayline_dashboard.live_view import LiveView

NOW_NS = 1_700_000_000_000_000_000
LOCAL = "http://localhost"
LIVE = "ws://localhost/v1/live"
TOKEN = "correct-horse-battery"


@pytest.fixture
def page(tmp_path: Path) -> Path:
    (tmp_path / "index.html").write_text("<!doctype html><title>Wayline</title>")
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "index-abc.js").write_text("console.log(1)")
    return tmp_path


@pytest.fixture
def live() -> LiveView:
    shuttle = Shuttle(NOW_NS)
    view = LiveView(monotonic_ns=lambda: 0, wall_ns=lambda: NOW_NS + 5 * SECOND_NS)
    for vehicle_id in ("shuttle-1", "shuttle-2"):
        for message, source in shuttle.messages(0):
            view.put(vehicle_id, message, source, Receipt(0))
    view.put_service("shuttle-1", "fusion", up=True)
    return view


def client(live: LiveView, static: Path, settings: HttpSettings | None = None) -> TestClient:
    app = create_dashboard(
        live, settings or HttpSettings(), routes=[Shuttle(NOW_NS).route], static=static
    )
    return TestClient(app, base_url=LOCAL)


def test_the_view_holds_what_the_page_shows(live: LiveView, page: Path) -> None:
    view = client(live, page).get("/v1/view").json()
    assert (view["kind"], view["now"]) == ("snapshot", "2023-11-14T22:13:25.000Z")
    vehicle, _ = view["vehicles"]
    assert (vehicle["vehicle_id"], vehicle["pose"]["mode"]) == ("shuttle-1", "fused")
    assert vehicle["arrivals"]["stops"][0]["name"] == "College Avenue"
    assert vehicle["services"][0]["up"] is True


def test_the_view_holds_the_horizon_and_the_trail_of_the_vehicle_asked_for(
    live: LiveView, page: Path
) -> None:
    http = client(live, page)
    asked = http.get("/v1/view", params={"vehicle_id": "shuttle-2"}).json()
    other, selected = asked["vehicles"]
    assert (asked["selected"], other["vehicle_id"]) == ("shuttle-2", "shuttle-1")
    assert "horizon" not in other
    assert "trail" not in other
    assert len(selected["horizon"]["points"]) == 76
    assert len(selected["trail"]) == 1
    assert "horizon" not in str(http.get("/v1/view").json())


@pytest.mark.parametrize(("vehicle_id", "status"), [("shuttle-3", 404), ("Shuttle 1", 422)])
def test_the_view_says_what_is_wrong_with_the_vehicle_asked_for(
    live: LiveView, page: Path, vehicle_id: str, status: int
) -> None:
    answer = client(live, page).get("/v1/view", params={"vehicle_id": vehicle_id})
    assert (answer.status_code, answer.json()["status"]) == (status, status)


def test_a_page_gets_a_snapshot_then_changes(live: LiveView, page: Path) -> None:
    with client(live, page).websocket_connect(LIVE) as websocket:
        assert websocket.receive_json()["kind"] == "snapshot"
        pose = Pose(t_ns=NOW_NS + SECOND_NS, mode="lost", lat_deg=39.9, lon_deg=-75.35)
        live.put("shuttle-1", pose, "fusion", Receipt(0))
        changes = websocket.receive_json()
    [vehicle] = changes["vehicles"]
    assert (changes["kind"], vehicle["pose"]["mode"]) == ("changes", "lost")
    assert "arrivals" not in vehicle


def test_the_server_answers_with_the_protocol_and_never_the_token(
    live: LiveView, page: Path
) -> None:
    with client(live, page).websocket_connect(
        LIVE, subprotocols=["wayline.bearer.eA", "wayline.v1"]
    ) as websocket:
        assert websocket.accepted_subprotocol == "wayline.v1"


def test_a_route_is_listed_and_answered_as_geojson(live: LiveView, page: Path) -> None:
    http = client(live, page)
    [link] = http.get("/v1/routes").json()["routes"]
    assert (link["name"], link["href"]) == ("Campus loop", "/v1/routes/avl")
    route = http.get(link["href"])
    assert route.headers["content-type"] == "application/geo+json"
    kinds = [feature["geometry"]["type"] for feature in route.json()["features"]]
    assert kinds == ["LineString"] + 5 * ["Point"]


def test_an_unknown_route_says_where_to_look(live: LiveView, page: Path) -> None:
    answer = client(live, page).get("/v1/routes/none")
    assert (answer.status_code, answer.json()["detail"]) == (
        404,
        "no route none; /v1/routes lists them",
    )


def test_the_page_is_asked_for_again_but_its_hashed_files_are_not(
    live: LiveView, page: Path
) -> None:
    http = client(live, page)
    assert http.get("/").headers["cache-control"] == "no-cache"
    script = http.get("/assets/index-abc.js")
    assert "immutable" in script.headers["cache-control"]
    assert "javascript" in script.headers["content-type"]
    assert "default-src 'none'" in http.get("/").headers["content-security-policy"]


def test_a_path_that_is_no_file_is_a_problem(live: LiveView, page: Path) -> None:
    answer = client(live, page).get("/assets/none.js")
    assert answer.headers["content-type"] == "application/problem+json"


def test_a_page_that_was_never_built_says_how_to(live: LiveView, tmp_path: Path) -> None:
    answer = client(live, tmp_path).get("/")
    assert answer.status_code == 503
    assert "npm run build" in answer.json()["detail"]


def test_with_tokens_the_page_opens_but_tells_nothing(live: LiveView, page: Path) -> None:
    http = client(live, page, HttpSettings(tokens=(TOKEN,)))
    open_paths = ("/", "/assets/index-abc.js", "/livez", "/readyz", "/healthz")
    assert {http.get(path).status_code for path in open_paths} == {200}
    closed = ("/v1/view", "/v1/routes", "/v1/routes/avl", "/metrics")
    assert {http.get(path).status_code for path in closed} == {401}


def test_a_dashboard_for_everybody_does_not_start_without_tokens(
    live: LiveView, page: Path
) -> None:
    with pytest.raises(InputError, match="without tokens"):
        client(live, page, HttpSettings(host="0.0.0.0"))


def test_metrics_count_pages_that_were_not_understood(live: LiveView, page: Path) -> None:
    http = client(live, page)
    with http.websocket_connect(LIVE) as websocket:
        websocket.receive_json()
        websocket.send_text("shuttle-1")
        with pytest.raises(WebSocketDisconnect):
            websocket.receive_json()
    with http.websocket_connect(LIVE) as websocket:
        websocket.receive_json()
    assert "wayline_dashboard_refused_total 1.0" in http.get("/metrics").text


def test_metrics_count_what_came_in_and_who_looks(live: LiveView, page: Path) -> None:
    http = client(live, page)
    with http.websocket_connect(LIVE) as websocket:
        websocket.receive_json()
        text = http.get("/metrics").text
    assert f"wayline_dashboard_inputs_total {float(live.inputs)}" in text
    assert "wayline_dashboard_pages 1.0" in text
