"""What every service's HTTP shares: health, metrics, documentation, errors, access (SPEC 5)."""

import hashlib
from collections.abc import Callable, Sequence
from typing import Any

import msgspec
from fastapi import FastAPI, Request, Response
from msgspec.structs import replace
from prometheus_client import CollectorRegistry
from prometheus_client.exposition import choose_encoder
from starlette.datastructures import MutableHeaders
from starlette.middleware.cors import CORSMiddleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Send
from starlette.types import Scope as HttpScope

from wayline import __version__
from wayline.digits import rounded
from wayline.http_docs import add_docs
from wayline.http_guard import LocalGuard, TokenGuard
from wayline.http_manners import BodyLimit, Freshness, HeadAsGet, TellingRoute
from wayline.http_problems import MEDIA_TYPE, Problem, answer_with_problems
from wayline.http_scopes import Keyring, Scope
from wayline.http_settings import HttpSettings, check_exposure
from wayline.messages import Health, Missing

PROBED = frozenset({"/livez", "/readyz", "/healthz"})
SCHEMA_REF = "#/components/schemas/{name}"
CONTENT_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data:",
        "font-src 'self'",
        "connect-src 'self'",
        "worker-src 'self'",
        "manifest-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
SAFE_HEADERS = {
    "content-security-policy": CONTENT_POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
}


class Healthz(msgspec.Struct, frozen=True, kw_only=True):
    """What /readyz and /healthz answer, with status 200 or, when not ok, 503."""

    ok: bool
    """The service is alive and lacks nothing that it works with."""
    service: str
    version: str
    alive: bool = True
    """The process turns; what /livez answers as its own `ok`."""
    detail: str | None = None
    """What is wrong, for people."""
    missing: tuple[Missing, ...] = ()
    health: Health | None = None
    """The service's last `health` message, where it has sent one."""


class JsonAnswer(Response):
    """Any msgspec Struct (or what msgspec encodes) as JSON, with the digits that mean something."""

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        """Encode the body."""
        return msgspec.json.encode(rounded(content))


class RoundedAnswer(JsonAnswer):
    """What was given the digits that mean something when it was made, for what is asked often."""

    def render(self, content: Any) -> bytes:
        """Encode the body."""
        return msgspec.json.encode(content)


class SlowAnswer(JsonAnswer):
    """What changes seldom: who has it already asks whether it is still so, by its ETag."""

    def __init__(self, content: Any, **options: Any) -> None:
        super().__init__(content, **options)
        self.headers["etag"] = f'W/"{hashlib.sha256(self.body).hexdigest()[:32]}"'
        self.headers["cache-control"] = "no-cache"


def answers(struct: type[msgspec.Struct], description: str = "") -> dict[int | str, dict[str, Any]]:
    """The `responses` of a path that answers with a Struct of `create_service_app(structs=...)`."""
    schema = {"$ref": SCHEMA_REF.format(name=struct.__name__)}
    content = {"application/json": {"schema": schema}}
    return {200: {"description": description or "Success", "content": content}}


def create_service_app(
    service: str,
    settings: HttpSettings,
    *,
    healthz: Callable[[], Healthz] | None = None,
    registry: CollectorRegistry | None = None,
    structs: Sequence[type[msgspec.Struct]] = (),
    is_open: Callable[[str], bool] = lambda _: False,
    is_public: Callable[[str], bool] = lambda _: False,
) -> FastAPI:
    """A service's app: probes, /metrics, /docs, problem details, access rules; add paths to it.

    Without `healthz` it says that it works. `registry` is what /metrics shows; `structs` are the
    answers' types for OpenAPI. With tokens, everything needs one but the probes, the documentation
    and what `is_open` says of a path; where `is_public` says so, the scope `public` is enough.
    Raises InputError for settings that would be too open.
    """
    check_exposure(settings)
    app = StructsApp(
        structs=(*structs, Healthz, Problem),
        guarded=bool(settings.tokens),
        title=f"Wayline {service}",
        version=__version__,
        docs_url=None,
        redoc_url=None,
        responses=PROBLEM_RESPONSES,
    )
    app.router.route_class = TellingRoute
    answer_with_problems(app)
    add_docs(app)
    _add_health(app, healthz or (lambda: Healthz(ok=True, service=service, version=__version__)))
    _add_metrics(app, registry or CollectorRegistry())
    _guard(app, settings, is_open, is_public)
    # the last one added meets a request first
    app.add_middleware(BodyLimit)
    app.add_middleware(Freshness)
    # a page's scripts shrink to a third, which a vehicle's mobile line feels
    app.add_middleware(GZipMiddleware, minimum_size=1024)
    app.add_middleware(HeadAsGet)
    if settings.cors_origins:
        _let_pages_ask(app, settings.cors_origins)
    app.add_middleware(SafeHeaders)
    return app


PROBLEM_RESPONSES: dict[int | str, dict[str, Any]] = {
    "4XX": {
        "description": "What is wrong with the request (RFC 9457)",
        "content": {MEDIA_TYPE: {"schema": {"$ref": SCHEMA_REF.format(name="Problem")}}},
    }
}


AWAY_RESPONSES: dict[int | str, dict[str, Any]] = {
    503: {**PROBLEM_RESPONSES["4XX"], "description": "What the answer rests on is away"}
}
"""The `responses` of a path that asks a database or another service."""


class StructsApp(FastAPI):
    """FastAPI whose OpenAPI document also holds the schemas of msgspec Structs."""

    def __init__(
        self, *, structs: Sequence[type[msgspec.Struct]], guarded: bool = False, **options: Any
    ) -> None:
        super().__init__(**options)
        self._guarded = guarded
        _, self._components = msgspec.json.schema_components(structs, ref_template=SCHEMA_REF)

    def openapi(self) -> dict[str, Any]:
        """The OpenAPI document."""
        document = super().openapi()
        components = document.setdefault("components", {})
        components.setdefault("schemas", {}).update(self._components)
        _describe_path_parameters(document)
        if self._guarded:
            components["securitySchemes"] = {"token": {"type": "http", "scheme": "bearer"}}
            # {}: some paths need none
            document["security"] = [{"token": []}, {}]
        return document


PATH_PARAMETERS = {
    "vehicle_id": ("The vehicle, as its key on the bus has it", "bus-1"),
    "route_id": ("The route, in its source's own text", "5A"),
    "stop_id": ("The stop, in its source's own text", "2373"),
    "trip_id": ("The timetable's trip, in its feed's own text", "868590120"),
    "road_id": ("The road, as /v1/roads lists it", "road-4564d0aa9a24"),
    "form": ("The kind of file", "gpx"),
    "what": ("What is asked of history", "trips"),
    "trip_key": ("The vehicle's trip, as its list of trips has it", "bus-1_20260505T061500Z"),
}
"""What paths are asked of, with an example."""


def _describe_path_parameters(document: dict[str, Any]) -> None:
    for operations in document.get("paths", {}).values():
        for operation in operations.values():
            for parameter in operation.get("parameters", ()):
                if parameter["in"] == "path" and parameter["name"] in PATH_PARAMETERS:
                    said, example = PATH_PARAMETERS[parameter["name"]]
                    parameter |= {"description": said, "example": example}


class SafeHeaders:
    """Adds the headers that keep a browser from running or sending anything foreign."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: HttpScope, receive: Receive, send: Send) -> None:
        """Pass everything on, with more headers on the way back."""

        async def send_safe(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(SAFE_HEADERS)
            await send(message)

        await self.app(scope, receive, send_safe if scope["type"] == "http" else send)


def _probed() -> dict[int | str, dict[str, Any]]:
    lacking = answers(Healthz, "What is missing, or does not work")[200]
    return {**answers(Healthz), 503: lacking}


def _add_health(app: FastAPI, healthz: Callable[[], Healthz]) -> None:
    @app.get("/livez", responses=_probed(), tags=["service"])
    def live() -> JsonAnswer:
        """Whether the process turns: 200, or 503 where it has to be started anew."""
        report = healthz()
        detail = None if report.alive else report.detail
        alive = replace(report, ok=report.alive, detail=detail, missing=(), health=None)
        return JsonAnswer(alive, 200 if alive.ok else 503)

    @app.get("/readyz", responses=_probed(), tags=["service"])
    def ready() -> JsonAnswer:
        """Whether the router and the inputs are there: 200, or 503 with what is missing."""
        report = replace(healthz(), health=None)
        return JsonAnswer(report, 200 if report.ok else 503)

    @app.get("/healthz", responses=_probed(), tags=["service"])
    def health() -> JsonAnswer:
        """What /readyz says, with the last `health` message."""
        report = healthz()
        return JsonAnswer(report, 200 if report.ok else 503)


def _add_metrics(app: FastAPI, registry: CollectorRegistry) -> None:
    @app.get("/metrics", tags=["service"], response_class=PlainTextResponse)
    def metrics(request: Request) -> Response:
        """Counters and gauges for Prometheus."""
        encode, content_type = choose_encoder(request.headers.get("accept", ""))
        return Response(encode(registry), headers={"content-type": content_type})


def _guard(
    app: FastAPI,
    settings: HttpSettings,
    is_open: Callable[[str], bool],
    is_public: Callable[[str], bool],
) -> None:
    if not settings.tokens:
        app.add_middleware(
            LocalGuard,
            behind_proxy=settings.behind_proxy,
            origins=frozenset(settings.cors_origins),
        )
        return
    of_public = None if settings.public else Scope.PUBLIC

    def needs(path: str) -> Scope | None:
        if _is_for_all(path) or is_open(path):
            return None
        return of_public if is_public(path) else Scope.READ

    app.add_middleware(TokenGuard, keyring=Keyring(settings.tokens), needs=needs)


def _is_for_all(path: str) -> bool:
    # orchestrators probe without tokens, and the documentation says nothing of the vehicles
    return path in {*PROBED, "/docs", "/openapi.json"} or path.startswith("/docs/")


def _let_pages_ask(app: FastAPI, origins: Sequence[str]) -> None:
    app.add_middleware(
        CORSMiddleware,
        allow_origins=list(origins),
        allow_methods=["GET", "HEAD"],
        allow_headers=["authorization", "if-none-match"],
        expose_headers=["etag"],
        max_age=3600,
    )
