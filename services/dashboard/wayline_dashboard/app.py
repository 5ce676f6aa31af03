"""The dashboard's HTTP: the page, the view it shows, the routes under it."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated
from urllib.parse import quote

import msgspec
from fastapi import FastAPI, Request, WebSocket
from msgspec import Meta
from prometheus_client import CollectorRegistry, Counter, Gauge
from prometheus_client.core import CounterMetricFamily, Metric
from prometheus_client.registry import Collector
from starlette.exceptions import HTTPException

from wayline.drive import VehicleId
from wayline.geojson import FeatureCollection
from wayline.http import Healthz, JsonAnswer, SlowAnswer, answers, create_service_app
from wayline.http_settings import HttpSettings
from wayline.parameters import describe_parameters, read_parameters
from wayline.route import Route
from wayline.route_file import route_features
from wayline.services import SERVICES
from wayline_dashboard.live_view import LiveView
from wayline_dashboard.page import STATIC, add_page, is_page
from wayline_dashboard.past import add_past
from wayline_dashboard.stream import stream
from wayline_dashboard.view import FleetView

HISTORY_URL = f"http://127.0.0.1:{SERVICES['history'].port}"
"""On the same machine."""


class RouteLink(msgspec.Struct, frozen=True):
    """A route and where its GeoJSON is."""

    route_id: str
    name: str
    href: str


class RouteList(msgspec.Struct, frozen=True):
    """Every route that the map can show."""

    routes: tuple[RouteLink, ...]


class ViewParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a question for the view may say."""

    vehicle_id: (
        Annotated[VehicleId, Meta(description="The vehicle whose horizon and trail to add")]
        | msgspec.UnsetType
    ) = msgspec.UNSET


def create_dashboard(
    live: LiveView,
    settings: HttpSettings,
    *,
    routes: Iterable[Route] = (),
    healthz: Callable[[], Healthz] | None = None,
    registry: CollectorRegistry | None = None,
    static: Path = STATIC,
    history_url: str = HISTORY_URL,
) -> FastAPI:
    """The app that shows what is put into `live`, and what history at an address tells of before.

    Raises InputError for settings that would be too open.
    """
    registry = registry or CollectorRegistry()
    app = create_service_app(
        "dashboard",
        settings,
        healthz=healthz,
        registry=registry,
        structs=(FleetView, RouteList, FeatureCollection),
        is_open=is_page,
        is_public=lambda path: path == "/v1/routes" or path.startswith("/v1/routes/"),
    )
    _add_view(app, live, registry)
    _add_routes(app, {route.route_id: route for route in routes})
    add_past(app, history_url)
    add_page(app, static)
    return app


def _add_view(app: FastAPI, live: LiveView, registry: CollectorRegistry) -> None:
    pages = Gauge("wayline_dashboard_pages", "Pages connected now", registry=registry)
    refused = Counter("wayline_dashboard_refused", "Pages not understood", registry=registry)
    registry.register(InputCount(live))

    @app.get(
        "/v1/view",
        responses=answers(FleetView),
        openapi_extra=describe_parameters(ViewParameters),
        tags=["view"],
    )
    def view(request: Request) -> JsonAnswer:
        """What is known of every vehicle and service now; horizon and trail of one vehicle."""
        asked = read_parameters(request.query_params, ViewParameters)
        selected = None if asked.vehicle_id is msgspec.UNSET else asked.vehicle_id
        return JsonAnswer(live.snapshot(selected))

    @app.websocket("/v1/live")
    async def live_view(websocket: WebSocket) -> None:
        with pages.track_inprogress():
            if await stream(websocket, live) is not None:
                refused.inc()


def _add_routes(app: FastAPI, routes: dict[str, Route]) -> None:
    links = RouteList(
        tuple(
            RouteLink(route.route_id, route.name, f"/v1/routes/{quote(route.route_id, safe='')}")
            for route in routes.values()
        )
    )

    @app.get("/v1/routes", responses=answers(RouteList), tags=["routes"])
    def route_list() -> JsonAnswer:
        """The routes that the map can show."""
        return SlowAnswer(links)

    @app.get("/v1/routes/{route_id:path}", responses=answers(FeatureCollection), tags=["routes"])
    def route(route_id: str) -> JsonAnswer:
        """A route's line and stops as GeoJSON."""
        if route_id not in routes:
            raise HTTPException(404, f"no route {route_id}; /v1/routes lists them")
        collection = FeatureCollection(route_features(routes[route_id]))
        return SlowAnswer(collection, media_type="application/geo+json")


class InputCount(Collector):
    """What the view has taken in, counted by the view itself."""

    def __init__(self, live: LiveView) -> None:
        self._live = live

    def collect(self) -> Iterable[Metric]:
        """The counter's value now."""
        text = "Messages and service events taken from the bus"
        yield CounterMetricFamily("wayline_dashboard_inputs", text, value=self._live.inputs)
