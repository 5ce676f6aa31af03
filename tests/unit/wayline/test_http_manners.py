"""HEAD, caching, compression, limits, misspelt parameters, digits."""

import msgspec
import pytest
from fastapi import Request
from fastapi.testclient import TestClient

from wayline.digits import rounded
from wayline.http import JsonAnswer, SlowAnswer, create_service_app
from wayline.http_manners import BODY_MAX_BYTES
from wayline.http_settings import HttpSettings
from wayline.parameters import describe_parameters, read_parameters


class Parameters(msgspec.Struct, frozen=True, kw_only=True):
    limit: int = 10


@pytest.fixture
def client() -> TestClient:
    app = create_service_app("test", HttpSettings())
    asked = describe_parameters(Parameters)

    @app.get("/v1/live", openapi_extra=asked)
    def live(request: Request) -> JsonAnswer:
        limit = read_parameters(request.query_params, Parameters).limit
        return JsonAnswer({"limit": limit, "lat_deg": 47.12345678912345})

    @app.get("/v1/slow")
    def slow() -> JsonAnswer:
        return SlowAnswer({"stops": ["a" * 2000]})

    return TestClient(app, base_url="http://localhost:8000", raise_server_exceptions=False)


@pytest.mark.parametrize("path", ["/v1/live", "/v1/slow", "/healthz", "/openapi.json", "/docs"])
def test_head_is_get_without_the_body(client: TestClient, path: str) -> None:
    got, headed = client.get(path), client.head(path)
    assert (headed.status_code, headed.content) == (200, b"")
    assert headed.headers["content-length"] == got.headers["content-length"]


def test_head_of_nothing_is_404(client: TestClient) -> None:
    assert client.head("/v1/nowhere").status_code == 404


def test_live_answers_are_kept_by_nobody(client: TestClient) -> None:
    assert client.get("/v1/live").headers["cache-control"] == "no-store"


def test_what_changes_slowly_is_sent_once(client: TestClient) -> None:
    first = client.get("/v1/slow")
    assert first.headers["cache-control"] == "no-cache"
    for known in (first.headers["etag"], f'"other", {first.headers["etag"]}', "*"):
        again = client.get("/v1/slow", headers={"if-none-match": known})
        assert (again.status_code, again.content) == (304, b"")
        assert again.headers["etag"] == first.headers["etag"]
    assert client.get("/v1/slow", headers={"if-none-match": '"other"'}).status_code == 200


def test_large_answers_are_compressed_for_who_can_read_them(client: TestClient) -> None:
    assert client.get("/v1/slow").headers["content-encoding"] == "gzip"
    plain = client.get("/v1/slow", headers={"accept-encoding": "identity"})
    assert "content-encoding" not in plain.headers


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("/v1/live?limt=1", "limt: is no parameter of this path; there are limit"),
        ("/v1/slow?limit=1", "limit: is no parameter of this path; there are none"),
    ],
)
def test_a_misspelt_parameter_is_told(client: TestClient, path: str, said: str) -> None:
    answer = client.get(path)
    assert (answer.status_code, answer.json()["detail"]) == (422, said)
    assert client.get("/v1/live?limit=1").json()["limit"] == 1


def test_a_large_body_is_refused_before_it_is_read(client: TestClient) -> None:
    sent = client.request("GET", "/v1/live", content=b" " * (BODY_MAX_BYTES + 1))
    assert sent.status_code == 413
    assert client.request("GET", "/v1/live", content=b" " * BODY_MAX_BYTES).status_code == 200


def test_numbers_have_the_digits_that_mean_something(client: TestClient) -> None:
    assert client.get("/v1/live").json()["lat_deg"] == 47.1234568
    given = {
        "distance_m": 1234.56789,
        "grade_pct": 3.456789,
        "coordinates": [[8.123456789, 47.0]],
        "share": 0.123456,
        "speed_mps": None,
        "runs": 12345678901,
    }
    assert rounded(given) == {
        "distance_m": 1234.57,
        "grade_pct": 3.457,
        "coordinates": [[8.1234568, 47.0]],
        "share": 0.1235,
        "speed_mps": None,
        "runs": 12345678901,
    }
