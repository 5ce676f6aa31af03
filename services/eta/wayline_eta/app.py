"""Eta's HTTP: routes, vehicles and their arrivals (SPEC section 5)."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any
from urllib.parse import quote

from fastapi import FastAPI, Request, Response
from fastapi.routing import APIRoute
from fastapi.sse import EventSourceResponse
from prometheus_client import CollectorRegistry
from starlette.routing import BaseRoute

from wayline.geojson import FeatureCollection
from wayline.http import Healthz, JsonAnswer, SlowAnswer, answers, create_service_app
from wayline.http_settings import HttpSettings
from wayline.parameters import describe_parameters, read_parameters
from wayline.query_error import QueryError
from wayline.route import Route
from wayline.route_file import route_features
from wayline.timetable.model import Timetable
from wayline.timetable.runs import Runs
from wayline_eta.accuracy import Accuracy, AccuracyAnswer, AccuracyParameters
from wayline_eta.answers import ArrivalList, VehicleAnswer, VehicleList
from wayline_eta.board import (
    ArrivalsParameters,
    EtaBoard,
    StopArrivalsParameters,
    answer_arrivals,
)
from wayline_eta.realtime_feeds import (
    MEDIA_TYPES,
    FeedParameters,
    RealtimeFeed,
    positions_feed,
    updates_feed,
)
from wayline_eta.rendered import Rendered
from wayline_eta.stop_directory import StopDirectory, StopList, StopsParameters
from wayline_eta.stream import Reader, StreamParameters, VehicleArrivals, VehicleProgress, stream
from wayline_eta.timetable_answers import (
    RouteSummaries,
    RouteSummary,
    TimetableAnswers,
    TripAnswer,
)

GEO_JSON = "application/geo+json"
NOT_KEPT = {"cache-control": "no-store", "x-accel-buffering": "no"}
"""Neither by browsers nor, until it is full, by a proxy."""
PUBLIC = ("/v1/routes", "/v1/trips/", "/v1/stops", "/gtfs-rt/")
"""Beginnings of the paths that riders need."""


def create_eta_app(
    board: EtaBoard,
    routes: Iterable[Route],
    settings: HttpSettings,
    *,
    timetables: Iterable[Timetable] = (),
    accuracy: Accuracy | None = None,
    healthz: Callable[[], Healthz] | None = None,
    registry: CollectorRegistry | None = None,
) -> FastAPI:
    """The app that answers from what is put on the board.

    Raises InputError for settings that would be too open.
    """
    app = create_service_app(
        "eta",
        settings,
        healthz=healthz,
        registry=registry,
        structs=(
            RouteSummaries,
            FeatureCollection,
            TripAnswer,
            VehicleList,
            ArrivalList,
            StopList,
            AccuracyAnswer,
            VehicleArrivals,
            VehicleProgress,
        ),
        is_public=is_public,
    )
    known_routes = tuple(routes)
    feeds = tuple(timetables)
    # lines of its own: the cores make theirs in another thread
    _add_routes(app, known_routes, TimetableAnswers(Runs(feeds)))
    rendered = Rendered(board.clock_ns)
    _add_vehicles(app, board, rendered)
    _add_stops(app, board, StopDirectory(known_routes, feeds), rendered)
    _add_stream(app, board, rendered)
    _add_accuracy(app, accuracy or Accuracy())
    _add_feed(app, "vehicle-positions", positions_feed(board))
    _add_feed(app, "trip-updates", updates_feed(board))
    # paths are tried in their order, and these are asked for far more often than all others
    app.router.routes.sort(key=_is_asked_seldom)
    return app


def _is_asked_seldom(route: BaseRoute) -> bool:
    return not (isinstance(route, APIRoute) and route.path.endswith("/arrivals"))


def is_public(path: str) -> bool:
    """Whether the scope `public` is enough for a path: arrivals, routes, stops, GTFS-Realtime."""
    return path.startswith(PUBLIC) or (
        path.startswith("/v1/vehicles/") and path.endswith("/arrivals")
    )


def _add_routes(app: FastAPI, routes: Sequence[Route], timetables: TimetableAnswers) -> None:
    own = tuple(map(_summary, routes))
    collections = {route.route_id: FeatureCollection(route_features(route)) for route in routes}

    # no coroutines: a timetable's lines are made when they are first asked for

    @app.get("/v1/routes", responses=answers(RouteSummaries), tags=["routes"])
    def route_list() -> JsonAnswer:
        """The routes that vehicles may follow, of files and of timetables."""
        return SlowAnswer(RouteSummaries((*own, *timetables.summaries())))

    @app.get("/v1/routes/{route_id:path}", responses=_geo_json(), tags=["routes"])
    def route(route_id: str) -> JsonAnswer:
        """A route's lines and stops as GeoJSON; of a timetable's those of its patterns."""
        found = collections.get(route_id) or timetables.route(route_id)
        return SlowAnswer(found, media_type=GEO_JSON)

    @app.get("/v1/trips/{trip_id:path}", responses=answers(TripAnswer), tags=["routes"])
    def trip(trip_id: str) -> JsonAnswer:
        """A trip of the timetables with its stops and times."""
        return SlowAnswer(timetables.trip(trip_id))


def _summary(route: Route) -> RouteSummary:
    return RouteSummary(
        route_id=route.route_id,
        name=route.name,
        loop=route.loop,
        length_m=route.length_m,
        stops=len(route.stops),
        href=f"/v1/routes/{quote(route.route_id, safe='')}",
    )


def _geo_json() -> dict[int | str, dict[str, object]]:
    described = answers(FeatureCollection)
    [schema] = described[200].pop("content").values()
    return {200: {**described[200], "content": {GEO_JSON: schema}}}


def _add_vehicles(app: FastAPI, board: EtaBoard, rendered: Rendered) -> None:
    # coroutines: an answer takes less time than its way to another thread and back

    @app.get("/v1/vehicles", responses=answers(VehicleList), tags=["vehicles"])
    async def vehicles() -> Response:
        """Every vehicle that was heard."""
        return _json(rendered.of_many("vehicles", board.vehicles))

    @app.get("/v1/vehicles/{vehicle_id}", responses=answers(VehicleAnswer), tags=["vehicles"])
    async def vehicle(vehicle_id: str) -> JsonAnswer:
        """Where a vehicle is, and where along its route."""
        return JsonAnswer(board.vehicle(vehicle_id))

    @app.get(
        "/v1/vehicles/{vehicle_id}/arrivals",
        responses=answers(ArrivalList),
        openapi_extra=describe_parameters(ArrivalsParameters),
        tags=["arrivals"],
    )
    async def vehicle_arrivals(vehicle_id: str, request: Request) -> Response:
        """A vehicle's next arrival at every stop, soonest first."""

        def make() -> ArrivalList:
            return answer_arrivals(board, vehicle_id, request.query_params)

        question = vehicle_id, request.url.query
        return _json(rendered.of_one(question, board.told_of(vehicle_id), make))


def _add_stops(app: FastAPI, board: EtaBoard, stops: StopDirectory, rendered: Rendered) -> None:
    @app.get(
        "/v1/stops",
        responses=answers(StopList),
        openapi_extra=describe_parameters(StopsParameters),
        tags=["stops"],
    )
    async def stop_list(request: Request) -> JsonAnswer:
        """The stops, or those near a place, nearest first."""
        return SlowAnswer(stops.answer(read_parameters(request.query_params, StopsParameters)))

    @app.get(
        "/v1/stops/{stop_id:path}/arrivals",
        responses=answers(ArrivalList),
        openapi_extra=describe_parameters(StopArrivalsParameters),
        tags=["arrivals"],
    )
    async def stop_arrivals(stop_id: str, request: Request) -> Response:
        """Every vehicle's next arrival at a stop, soonest first."""

        def make() -> ArrivalList:
            if stop_id not in stops:
                raise QueryError(404, f"no route has a stop {stop_id}; /v1/stops lists them")
            asked = read_parameters(request.query_params, StopArrivalsParameters)
            return board.stop_arrivals(stop_id, asked)

        question = "stop", stop_id, request.url.query
        return _json(rendered.of_many(question, make))


def _add_stream(app: FastAPI, board: EtaBoard, rendered: Rendered) -> None:
    @app.get(
        "/v1/stream",
        responses=_as(EventSourceResponse.media_type),
        openapi_extra=describe_parameters(StreamParameters),
        tags=["arrivals"],
    )
    async def live(request: Request) -> EventSourceResponse:
        """Server-sent events `arrivals` and `progress`: all that is known, then what is new."""
        asked = read_parameters(request.query_params, StreamParameters)
        is_ending = getattr(app.state, "is_ending", lambda: False)
        events = stream(Reader(board, rendered, asked), is_ending)
        return EventSourceResponse(events, headers=NOT_KEPT)


def _as(*media_types: str) -> dict[int | str, dict[str, Any]]:
    """The `responses` of a path whose answers are no JSON of ours."""
    return {200: {"description": "Success", "content": {each: {} for each in media_types}}}


def _json(body: bytes) -> Response:
    return Response(body, media_type=JsonAnswer.media_type)


def _add_accuracy(app: FastAPI, accuracy: Accuracy) -> None:
    # no coroutine: many routes and days take a while to add up

    @app.get(
        "/v1/accuracy",
        responses=answers(AccuracyAnswer),
        openapi_extra=describe_parameters(AccuracyParameters),
        tags=["accuracy"],
    )
    def accuracy_answer(request: Request) -> JsonAnswer:
        """How good predictions were, by minutes ahead: once a minute, against what came."""
        asked = read_parameters(request.query_params, AccuracyParameters)
        return JsonAnswer(accuracy.answer(asked))


def _add_feed(app: FastAPI, name: str, feed: RealtimeFeed) -> None:
    @app.get(
        f"/gtfs-rt/{name}",
        responses=_as(*MEDIA_TYPES.values()),
        openapi_extra=describe_parameters(FeedParameters),
        tags=["gtfs-realtime"],
        name=name,
    )
    def realtime_feed(request: Request) -> Response:
        """GTFS-Realtime 2.0, as protobuf or as JSON; made anew once a second."""
        asked = read_parameters(request.query_params, FeedParameters)
        return Response(feed.bytes_of(asked.format), media_type=MEDIA_TYPES[asked.format])
