"""Eta's HTTP: routes, vehicles and their arrivals (SPEC section 5)."""

from collections.abc import Callable, Iterable, Sequence
from urllib.parse import quote

from fastapi import FastAPI, Request
from prometheus_client import CollectorRegistry

from wayline.geojson import FeatureCollection
from wayline.http import Healthz, JsonAnswer, SlowAnswer, answers, create_service_app
from wayline.http_settings import HttpSettings
from wayline.parameters import describe_parameters, read_parameters
from wayline.query_error import QueryError
from wayline.route import Route
from wayline.route_file import route_features
from wayline.timetable.model import Timetable
from wayline.timetable.runs import Runs
from wayline_eta.answers import ArrivalList, VehicleAnswer, VehicleList
from wayline_eta.board import (
    ArrivalsParameters,
    EtaBoard,
    StopArrivalsParameters,
    answer_arrivals,
)
from wayline_eta.stop_directory import StopDirectory, StopList, StopsParameters
from wayline_eta.timetable_answers import (
    RouteSummaries,
    RouteSummary,
    TimetableAnswers,
    TripAnswer,
)

GEO_JSON = "application/geo+json"
PUBLIC = ("/v1/routes", "/v1/trips/", "/v1/stops", "/gtfs-rt/")
"""Beginnings of the paths that riders need."""


def create_eta_app(
    board: EtaBoard,
    routes: Iterable[Route],
    settings: HttpSettings,
    *,
    timetables: Iterable[Timetable] = (),
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
        ),
        is_public=is_public,
    )
    known_routes = tuple(routes)
    feeds = tuple(timetables)
    # lines of its own: the cores make theirs in another thread
    _add_routes(app, known_routes, TimetableAnswers(Runs(feeds)))
    _add_vehicles(app, board)
    _add_stops(app, board, StopDirectory(known_routes, feeds))
    return app


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


def _add_vehicles(app: FastAPI, board: EtaBoard) -> None:
    # coroutines: an answer takes less time than its way to another thread and back

    @app.get("/v1/vehicles", responses=answers(VehicleList), tags=["vehicles"])
    async def vehicles() -> JsonAnswer:
        """Every vehicle that was heard."""
        return JsonAnswer(board.vehicles())

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
    async def vehicle_arrivals(vehicle_id: str, request: Request) -> JsonAnswer:
        """A vehicle's next arrival at every stop, soonest first."""
        return JsonAnswer(answer_arrivals(board, vehicle_id, request.query_params))


def _add_stops(app: FastAPI, board: EtaBoard, stops: StopDirectory) -> None:
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
    async def stop_arrivals(stop_id: str, request: Request) -> JsonAnswer:
        """Every vehicle's next arrival at a stop, soonest first."""
        if stop_id not in stops:
            raise QueryError(404, f"no route has a stop {stop_id}; /v1/stops lists them")
        asked = read_parameters(request.query_params, StopArrivalsParameters)
        return JsonAnswer(board.stop_arrivals(stop_id, asked))
