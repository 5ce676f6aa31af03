"""The slope map's HTTP: roads, their profiles, and the road ahead (SPEC section 5)."""

from collections.abc import Callable
from typing import Any

from fastapi import FastAPI, Request, Response
from prometheus_client import CollectorRegistry

from wayline.geojson import FeatureCollection
from wayline.http import (
    AWAY_RESPONSES,
    Healthz,
    JsonAnswer,
    RoundedAnswer,
    SlowAnswer,
    answers,
    create_service_app,
)
from wayline.http_settings import HttpSettings
from wayline.parameters import describe_parameters, read_parameters
from wayline_slope_map.answers import (
    LookaheadAnswer,
    ProfileAnswer,
    RoadList,
    VehicleLookahead,
    road_list,
)
from wayline_slope_map.book import SlopeBook
from wayline_slope_map.documents import profile_csv, profile_geojson
from wayline_slope_map.drives import Asked, DrivesParameters, VehicleRuns, vehicle_runs
from wayline_slope_map.queries import answer_lookahead, answer_profile, answer_vehicle_lookahead
from wayline_slope_map.questions import (
    AheadParameters,
    LookaheadParameters,
    ProfileParameters,
    StretchParameters,
)

GEO_JSON = "application/geo+json"
CSV = "text/csv"
STRUCTS = (
    RoadList,
    ProfileAnswer,
    LookaheadAnswer,
    VehicleLookahead,
    FeatureCollection,
    VehicleRuns,
)


def create_slope_app(
    book: SlopeBook,
    settings: HttpSettings,
    *,
    drives: Asked,
    healthz: Callable[[], Healthz] | None = None,
    registry: CollectorRegistry | None = None,
) -> FastAPI:
    """The app that answers from the book, and of drives by asking for them.

    Raises InputError for settings that would be too open.
    """
    app = create_service_app(
        "slope-map",
        settings,
        healthz=healthz,
        registry=registry,
        structs=STRUCTS,
    )
    _add_roads(app, book)
    _add_documents(app, book)
    _add_lookahead(app, book)
    _add_drives(app, book, drives)
    return app


def _add_roads(app: FastAPI, book: SlopeBook) -> None:
    # plain functions run in other threads: a long road in small steps takes a while

    @app.get("/v1/roads", responses=answers(RoadList), tags=["roads"])
    def roads() -> JsonAnswer:
        """Every road that was driven, and what is known of it."""
        return SlowAnswer(road_list(book.profiles()))

    @app.get(
        "/v1/roads/{road_id:path}/profile",
        responses=answers(ProfileAnswer),
        openapi_extra=describe_parameters(ProfileParameters),
        tags=["roads"],
    )
    def profile(road_id: str, request: Request) -> JsonAnswer:
        """A road's grade and altitude along its line; by default one point a bin."""
        return SlowAnswer(answer_profile(book, road_id, request.query_params))


def _add_documents(app: FastAPI, book: SlopeBook) -> None:
    parameters = describe_parameters(StretchParameters)

    @app.get(
        "/v1/roads/{road_id:path}/profile.csv",
        responses=_as(CSV, {"type": "string"}),
        openapi_extra=parameters,
        tags=["roads"],
    )
    def csv(road_id: str, request: Request) -> Response:
        """The known bins of a road as a table, like `wayline slope export`."""
        return Response(profile_csv(book, road_id, request.query_params), media_type=CSV)

    @app.get(
        "/v1/roads/{road_id:path}/profile.geojson",
        responses=_as(GEO_JSON, {"$ref": "#/components/schemas/FeatureCollection"}),
        openapi_extra=parameters,
        tags=["roads"],
    )
    def geojson(road_id: str, request: Request) -> JsonAnswer:
        """The known bins of a road as lines to draw."""
        collection = profile_geojson(book, road_id, request.query_params)
        return SlowAnswer(collection, media_type=GEO_JSON)


def _as(media_type: str, schema: dict[str, str]) -> dict[int | str, dict[str, Any]]:
    return {200: {"description": "Success", "content": {media_type: {"schema": schema}}}}


def _add_lookahead(app: FastAPI, book: SlopeBook) -> None:
    # coroutines: an answer takes less time than its way to another thread and back

    @app.get(
        "/v1/lookahead",
        responses=answers(LookaheadAnswer),
        openapi_extra=describe_parameters(LookaheadParameters),
        tags=["lookahead"],
    )
    async def ahead(request: Request) -> JsonAnswer:
        """The road ahead of a place; all null where no known road runs that way."""
        return RoundedAnswer(answer_lookahead(book, request.query_params))

    @app.get(
        "/v1/vehicles/{vehicle_id}/lookahead",
        responses=answers(VehicleLookahead),
        openapi_extra=describe_parameters(AheadParameters),
        tags=["lookahead"],
    )
    async def vehicle_ahead(vehicle_id: str, request: Request) -> JsonAnswer:
        """The road ahead of a vehicle, from where its last `horizon` has it."""
        return RoundedAnswer(answer_vehicle_lookahead(book, vehicle_id, request.query_params))


def _add_drives(app: FastAPI, book: SlopeBook, drives: Asked) -> None:
    @app.get(
        "/v1/vehicles/{vehicle_id}/runs",
        responses=answers(VehicleRuns) | AWAY_RESPONSES,
        openapi_extra=describe_parameters(DrivesParameters),
        tags=["runs"],
    )
    def runs(vehicle_id: str, request: Request) -> JsonAnswer:
        """What a vehicle's drives have taught, and what of them was left out of the map and why."""
        asked = read_parameters(request.query_params, DrivesParameters)
        is_heard = vehicle_id in book.vehicle_ids()
        return JsonAnswer(vehicle_runs(drives, vehicle_id, asked.limit, is_heard=is_heard))
