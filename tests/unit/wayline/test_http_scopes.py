"""What each token may ask, and what is for everybody."""

import hashlib

import msgspec
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from wayline.http import JsonAnswer, create_service_app
from wayline.http_scopes import Keyring, Scope
from wayline.http_settings import HttpSettings, KeptToken, ScopeName

LOCAL = "http://localhost:8000"


def kept(token: str, scope: ScopeName) -> KeptToken:
    return KeptToken(sha256=hashlib.sha256(token.encode()).hexdigest(), scope=scope)


TOKENS = ("writer", kept("reader", "read"), kept("rider", "public"))


def make_client(settings: HttpSettings) -> TestClient:
    app = create_service_app(
        "test", settings, is_public=lambda path: path.startswith("/v1/arrivals")
    )
    _add(app)
    return TestClient(app, base_url=LOCAL)


def _add(app: FastAPI) -> None:
    @app.get("/v1/arrivals")
    def arrivals() -> JsonAnswer:
        return JsonAnswer({"seconds": 60})

    @app.get("/v1/track")
    def track() -> JsonAnswer:
        return JsonAnswer({"points": []})

    @app.post("/v1/runs")
    def change() -> JsonAnswer:
        return JsonAnswer({"changed": True})


def ask(client: TestClient, method: str, path: str, token: str | None) -> int:
    headers = {} if token is None else {"authorization": f"Bearer {token}"}
    return client.request(method, path, headers=headers).status_code


@pytest.mark.parametrize(
    ("token", "codes"),
    [
        (None, (401, 401, 401)),
        ("unknown", (401, 401, 401)),
        ("rider", (200, 403, 403)),
        ("reader", (200, 200, 403)),
        ("writer", (200, 200, 200)),
    ],
)
def test_a_token_opens_what_its_scope_says(token: str | None, codes: tuple[int, ...]) -> None:
    client = make_client(HttpSettings(tokens=TOKENS))
    asked = (("GET", "/v1/arrivals"), ("GET", "/v1/track"), ("POST", "/v1/runs"))
    assert tuple(ask(client, *what, token) for what in asked) == codes


def test_arrivals_are_for_everybody_where_the_configuration_says_so() -> None:
    client = make_client(HttpSettings(tokens=TOKENS, public=True))
    assert ask(client, "GET", "/v1/arrivals", None) == 200
    assert ask(client, "HEAD", "/v1/arrivals", None) == 200
    assert ask(client, "POST", "/v1/arrivals", None) == 401
    assert ask(client, "GET", "/v1/track", None) == 401


def test_a_refusal_says_which_scope_is_needed() -> None:
    client = make_client(HttpSettings(tokens=TOKENS))
    refused = client.get("/v1/track", headers={"authorization": "Bearer rider"})
    assert refused.headers["content-type"] == "application/problem+json"
    assert refused.json()["detail"] == "the token's scope is public; this needs read"
    assert 'error="insufficient_scope"' in refused.headers["www-authenticate"]


def test_a_token_that_is_there_twice_has_the_larger_scope() -> None:
    assert Keyring([kept("one", "public"), kept("one", "read")]).scope_of("one") is Scope.READ


def test_only_a_tokens_hash_stays_in_memory() -> None:
    assert "writer" not in repr(vars(Keyring(TOKENS)))


@pytest.mark.parametrize(
    "token",
    [{"sha256": "abc", "scope": "read"}, {"sha256": "0" * 64, "scope": "all"}, {"scope": "read"}],
)
def test_a_kept_token_has_a_hash_and_a_scope(token: dict[str, str]) -> None:
    with pytest.raises(msgspec.ValidationError, match="tokens"):
        msgspec.convert({"tokens": [token]}, HttpSettings)


def test_the_documentation_can_take_a_token() -> None:
    guarded = make_client(HttpSettings(tokens=TOKENS)).get("/openapi.json").json()
    assert guarded["components"]["securitySchemes"]["token"]["scheme"] == "bearer"
    assert "security" not in make_client(HttpSettings()).get("/openapi.json").json()


PAGE = "https://transit.example"


@pytest.mark.parametrize("tokens", [(), TOKENS])
def test_a_named_page_from_elsewhere_may_ask(tokens: tuple[str | KeptToken, ...]) -> None:
    client = make_client(HttpSettings(tokens=tokens, cors_origins=(PAGE,)))
    preflight = client.options(
        "/v1/track",
        headers={
            "origin": PAGE,
            "access-control-request-method": "GET",
            "access-control-request-headers": "authorization",
        },
    )
    assert preflight.status_code == 200
    assert preflight.headers["access-control-allow-origin"] == PAGE
    asked = {"origin": PAGE, "authorization": "Bearer reader"}
    answer = client.get("/v1/track", headers=asked)
    assert answer.status_code == 200
    assert answer.headers["access-control-allow-origin"] == PAGE


def test_another_page_may_not() -> None:
    foreign = {"origin": "https://evil.example", "authorization": "Bearer reader"}
    guarded = make_client(HttpSettings(tokens=TOKENS, cors_origins=(PAGE,)))
    assert "access-control-allow-origin" not in guarded.get("/v1/track", headers=foreign).headers
    local = make_client(HttpSettings(cors_origins=(PAGE,)))
    assert local.get("/v1/track", headers=foreign).status_code == 403


@pytest.mark.parametrize("origin", ["*", "transit.example", "https://transit.example/"])
def test_an_origin_is_a_scheme_and_a_host(origin: str) -> None:
    with pytest.raises(msgspec.ValidationError, match="cors_origins"):
        msgspec.convert({"cors_origins": [origin]}, HttpSettings)
