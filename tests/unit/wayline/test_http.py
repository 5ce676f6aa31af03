import base64

import msgspec
import pytest
from fastapi import FastAPI, WebSocket
from fastapi.testclient import TestClient
from prometheus_client import CollectorRegistry, Counter
from starlette.testclient import WebSocketDenialResponse

from wayline import __version__
from wayline.errors import InputError
from wayline.http import Healthz, JsonAnswer, answers, create_service_app
from wayline.http_guard import TOKEN_PROTOCOL
from wayline.http_scopes import Keyring, Scope
from wayline.http_settings import HttpSettings, check_exposure

TOKEN = "correct-horse-battery"
LOCAL = "http://localhost:8000"


class Answer(msgspec.Struct):
    road_id: str


def make_app(settings: HttpSettings | None = None, ok: bool = True) -> FastAPI:
    registry = CollectorRegistry()
    Counter("wayline_tries", "Tries", registry=registry).inc(3)
    app = create_service_app(
        "test",
        settings or HttpSettings(),
        healthz=lambda: Healthz(ok=ok, service="test", version="1.2.3", detail="no disk"),
        registry=registry,
        structs=(Answer,),
        is_open=lambda path: path == "/page",
    )

    @app.get("/v1/roads/{number}", responses=answers(Answer))
    def road(number: int) -> JsonAnswer:
        if number < 0:
            raise ZeroDivisionError("a secret of the inside")
        return JsonAnswer(Answer(str(number)))

    @app.get("/page")
    def page() -> str:
        return "page"

    @app.websocket("/v1/live")
    async def live(websocket: WebSocket) -> None:
        await websocket.accept()
        await websocket.send_text("hello")

    return app


def make_client(settings: HttpSettings | None = None, ok: bool = True) -> TestClient:
    return TestClient(make_app(settings, ok), base_url=LOCAL, raise_server_exceptions=False)


def test_a_struct_is_answered_as_json() -> None:
    answer = make_client().get("/v1/roads/7")
    assert (answer.status_code, answer.json()) == (200, {"road_id": "7"})


def test_healthz_says_503_and_why_when_the_service_does_not_work() -> None:
    assert make_client().get("/healthz").status_code == 200
    answer = make_client(ok=False).get("/healthz")
    assert (answer.status_code, answer.json()["detail"]) == (503, "no disk")


def probed(report: Healthz) -> dict[str, int]:
    app = create_service_app("test", HttpSettings(), healthz=lambda: report)
    client = TestClient(app, base_url=LOCAL)
    return {path: client.get(path).status_code for path in ("/livez", "/readyz", "/healthz")}


def test_what_lacks_its_input_is_alive_and_what_does_not_turn_is_not() -> None:
    well = Healthz(ok=True, service="test", version="0")
    assert probed(well) == {"/livez": 200, "/readyz": 200, "/healthz": 200}
    lacking = msgspec.structs.replace(well, ok=False, detail="router: the bus is gone")
    assert probed(lacking) == {"/livez": 200, "/readyz": 503, "/healthz": 503}
    stuck = msgspec.structs.replace(lacking, alive=False)
    assert probed(stuck) == {"/livez": 503, "/readyz": 503, "/healthz": 503}


def test_metrics_are_what_prometheus_reads() -> None:
    answer = make_client().get("/metrics")
    assert "wayline_tries_total 3.0" in answer.text
    assert answer.headers["content-type"].startswith("text/plain")


def test_an_unknown_path_is_a_problem() -> None:
    answer = make_client().get("/v1/nowhere")
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json() == {
        "type": "about:blank",
        "title": "Not Found",
        "status": 404,
        "instance": "/v1/nowhere",
    }


def test_a_wrong_parameter_is_named() -> None:
    answer = make_client().get("/v1/roads/seven")
    assert (answer.status_code, answer.json()["status"]) == (422, 422)
    assert answer.json()["invalid"][0]["name"] == "number"


def test_a_bug_tells_nothing_of_the_inside() -> None:
    answer = make_client().get("/v1/roads/-1")
    assert answer.status_code == 500
    assert answer.headers["content-type"] == "application/problem+json"
    assert "secret" not in answer.text


def test_a_wrong_method_is_a_problem_that_names_the_right_one() -> None:
    answer = make_client().post("/v1/roads/7")
    assert (answer.status_code, answer.headers["allow"]) == (405, "GET")
    assert answer.json()["title"] == "Method Not Allowed"


def test_the_documentation_needs_no_other_host() -> None:
    client = make_client()
    page = client.get("/docs").text
    assert "//" not in page.replace("<!doctype html>", "")
    for name in ("swagger-ui-bundle.js", "swagger-ui.css"):
        assert f"/docs/assets/{name}" in page
        assert len(client.get(f"/docs/assets/{name}").content) > 100_000
    assert "/openapi.json" in client.get("/docs/start.js").text


def test_openapi_knows_the_structs() -> None:
    document = make_client().get("/openapi.json").json()
    answer = document["paths"]["/v1/roads/{number}"]["get"]["responses"]
    reference = answer["200"]["content"]["application/json"]["schema"]["$ref"]
    assert reference == "#/components/schemas/Answer"
    assert document["components"]["schemas"]["Answer"]["properties"]["road_id"] == {
        "type": "string"
    }
    assert "application/problem+json" in answer["4XX"]["content"]


def test_every_answer_forbids_foreign_content() -> None:
    headers = make_client().get("/v1/nowhere").headers
    assert "default-src 'none'" in headers["content-security-policy"]
    assert "unsafe" not in headers["content-security-policy"]
    assert headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "192.168.1.7:8000"])
def test_without_tokens_a_foreign_host_name_is_refused(host: str) -> None:
    assert make_client().get("/v1/roads/7", headers={"host": host}).status_code == 403


@pytest.mark.parametrize("host", ["127.0.0.1:8000", "[::1]:8000", "localhost"])
def test_without_tokens_this_machine_may_ask(host: str) -> None:
    assert make_client().get("/v1/roads/7", headers={"host": host}).status_code == 200


def test_without_tokens_a_foreign_page_gets_no_websocket() -> None:
    foreign = {"origin": "http://evil.example", "host": "localhost:8000"}
    client = make_client()
    with (
        pytest.raises(WebSocketDenialResponse) as refused,
        client.websocket_connect("/v1/live", headers=foreign),
    ):
        pass
    assert refused.value.status_code == 403
    own = {"origin": LOCAL, "host": "localhost:8000"}
    with client.websocket_connect("/v1/live", headers=own) as websocket:
        assert websocket.receive_text() == "hello"


def test_behind_a_proxy_a_page_is_known_by_the_name_that_the_proxy_was_asked_for() -> None:
    client = make_client(HttpSettings(behind_proxy=True))
    headers = {"host": "127.0.0.1:8000", "x-forwarded-host": "fleet.example"}
    own = headers | {"origin": "https://fleet.example"}
    assert client.get("/v1/roads/7", headers=own).status_code == 200
    foreign = headers | {"origin": "https://evil.example"}
    assert client.get("/v1/roads/7", headers=foreign).status_code == 403


GUARDED = HttpSettings(tokens=(TOKEN, "another-one"))


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"authorization": "Bearer wrong"},
        {"authorization": f"Basic {TOKEN}"},
        {"authorization": "Bearer "},
        {"authorization": f"Bearer {TOKEN}x"},
    ],
)
def test_with_tokens_a_request_without_one_is_refused(headers: dict[str, str]) -> None:
    answer = make_client(GUARDED).get("/v1/roads/7", headers=headers)
    assert answer.status_code == 401
    assert answer.headers["www-authenticate"].startswith("Bearer")
    assert answer.headers["content-type"] == "application/problem+json"
    assert "content-security-policy" in answer.headers


@pytest.mark.parametrize("token", GUARDED.tokens)
def test_each_token_opens(token: str) -> None:
    answer = make_client(GUARDED).get("/v1/roads/7", headers={"authorization": f"bearer {token}"})
    assert answer.status_code == 200


def test_health_and_documentation_and_the_page_are_open_but_metrics_are_not() -> None:
    client = make_client(GUARDED)
    codes = {
        path: client.get(path).status_code
        for path in (
            "/livez",
            "/readyz",
            "/healthz",
            "/docs",
            "/docs/start.js",
            "/openapi.json",
            "/page",
            "/metrics",
        )
    }
    assert codes.pop("/metrics") == 401
    assert set(codes.values()) == {200}


def test_a_browser_offers_its_token_as_a_subprotocol() -> None:
    offered = TOKEN_PROTOCOL + base64.urlsafe_b64encode(TOKEN.encode()).decode().rstrip("=")
    client = make_client(GUARDED)
    with client.websocket_connect("/v1/live", subprotocols=["wayline.v1", offered]) as websocket:
        assert websocket.receive_text() == "hello"


@pytest.mark.parametrize(
    "offered", ["wayline.v1", f"{TOKEN_PROTOCOL}d3Jvbmc", f"{TOKEN_PROTOCOL}%"]
)
def test_a_websocket_without_a_known_token_is_refused(offered: str) -> None:
    client = make_client(GUARDED)
    with (
        pytest.raises(WebSocketDenialResponse) as refused,
        client.websocket_connect("/v1/live", subprotocols=[offered]),
    ):
        pass
    assert refused.value.status_code == 401


def test_a_token_outside_ascii_is_simply_unknown() -> None:
    assert Keyring([TOKEN]).scope_of("schlüssel") is None
    assert Keyring(["first", TOKEN]).scope_of(TOKEN) is Scope.WRITE


@pytest.mark.parametrize(
    ("settings", "what"),
    [
        (HttpSettings(host="0.0.0.0"), "without tokens"),
        (HttpSettings(host="::"), "without tokens"),
        (HttpSettings(host="vehicle.example", behind_proxy=True), "without tokens"),
        (HttpSettings(host="0.0.0.0", tokens=(TOKEN,)), "in the clear"),
        (HttpSettings(tls_cert="server.pem"), "tls_key is missing"),
    ],
)
def test_what_would_be_too_open_is_refused_with_the_mend(settings: HttpSettings, what: str) -> None:
    with pytest.raises(InputError, match=what) as refused:
        make_app(settings)
    assert refused.value.mend


@pytest.mark.parametrize(
    "settings",
    [
        HttpSettings(),
        HttpSettings(host="localhost"),
        HttpSettings(host="127.0.1.1"),
        HttpSettings(host="::1"),
        HttpSettings(host="0.0.0.0", tokens=(TOKEN,), behind_proxy=True),
        HttpSettings(host="0.0.0.0", tokens=(TOKEN,), tls_cert="a.pem", tls_key="b.pem"),
    ],
)
def test_what_is_safe_is_accepted(settings: HttpSettings) -> None:
    check_exposure(settings)


@pytest.mark.parametrize("token", ["", "two words", "schlüssel"])
def test_a_token_that_no_header_can_carry_is_refused(token: str) -> None:
    with pytest.raises(msgspec.ValidationError, match="tokens"):
        msgspec.convert({"tokens": [token]}, HttpSettings)


def test_a_service_without_a_loop_says_its_name_and_that_it_works() -> None:
    client = TestClient(create_service_app("slope-map", HttpSettings()), base_url=LOCAL)
    answer = client.get("/healthz")
    found = {key: answer.json()[key] for key in ("ok", "service", "version")}
    assert (answer.status_code, found) == (
        200, {"ok": True, "service": "slope-map", "version": __version__},
    )  # fmt: skip
    information = client.get("/openapi.json").json()["info"]
    assert information == {"title": "Wayline slope-map", "version": __version__}
