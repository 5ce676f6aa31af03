"""The history's HTTP: tracks, trips and events of a vehicle (SPEC section 5)."""

import time
from collections.abc import Callable, Iterator
from typing import Any

from fastapi import FastAPI, Request
from prometheus_client import CollectorRegistry
from starlette.responses import StreamingResponse

from wayline.http import AWAY_RESPONSES, Healthz, JsonAnswer, answers, create_service_app
from wayline.http_settings import HttpSettings
from wayline.keys import is_vehicle_id
from wayline.parameters import describe_parameters, read_parameters
from wayline.query_error import QueryError
from wayline_history.answers import EventList, TripAnswer, TripList, event_list, trip_answer
from wayline_history.archive import Archive
from wayline_history.chunk import Chunk
from wayline_history.documents import begun, document_of, json_track, stepped
from wayline_history.instants import Stretch
from wayline_history.questions import (
    EventsParameters,
    Format,
    PagedTrackParameters,
    StretchParameters,
    TrackParameters,
)
from wayline_history.reading import HistoryReader

MEDIA: dict[Format, str] = {
    "json": "application/json",
    "gpx": "application/gpx+xml",
    "csv": "text/csv; charset=utf-8",
    "geojson": "application/geo+json",
}


def create_history_app(
    archive: Archive,
    settings: HttpSettings,
    *,
    healthz: Callable[[], Healthz] | None = None,
    registry: CollectorRegistry | None = None,
    now_ns: Callable[[], int] = time.time_ns,
) -> FastAPI:
    """The app that answers from the archive.

    Raises InputError for settings that would be too open.
    """
    app = create_service_app(
        "history",
        settings,
        healthz=healthz,
        registry=registry,
        structs=(TripList, TripAnswer, EventList),
    )
    _add_track(app, archive, now_ns)
    _add_trips(app, archive, now_ns)
    return app


def _add_track(app: FastAPI, archive: Archive, now_ns: Callable[[], int]) -> None:
    # plain functions run in other threads, where a database may take its time

    @app.get(
        "/v1/vehicles/{vehicle_id}/track",
        responses=_as("json") | AWAY_RESPONSES,
        openapi_extra=describe_parameters(PagedTrackParameters),
        tags=["history"],
    )
    def track(vehicle_id: str, request: Request) -> StreamingResponse:
        """Where a vehicle was: fixes, poses or places along the route, in pages by time."""
        asked = read_parameters(request.query_params, PagedTrackParameters)
        stretch = asked.stretch(now_ns())
        chunks = begun(_opened(archive, vehicle_id, asked, stretch))
        parts = json_track(vehicle_id, asked.kind, stretch, chunks, asked.limit)
        return StreamingResponse(parts, media_type=MEDIA["json"])

    parameters = describe_parameters(TrackParameters)

    @app.get(
        "/v1/vehicles/{vehicle_id}/track.{form}",
        responses=_as("gpx") | AWAY_RESPONSES,
        openapi_extra=parameters,
        tags=["history"],
    )
    def document(vehicle_id: str, form: Format, request: Request) -> StreamingResponse:
        """The whole track as a file: `gpx`, `csv` or `geojson`."""
        asked = read_parameters(request.query_params, TrackParameters)
        stretch = asked.stretch(now_ns())

        def reread() -> Iterator[Chunk]:
            return _opened(archive, vehicle_id, asked, stretch)

        parts = document_of(form, vehicle_id, asked.kind, stretch, reread)
        name = f"{vehicle_id}-{asked.kind}.{form}"
        headers = {"content-disposition": f'attachment; filename="{name}"'}
        return StreamingResponse(parts, media_type=MEDIA[form], headers=headers)


def _opened(
    archive: Archive, vehicle_id: str, asked: TrackParameters, stretch: Stretch
) -> Iterator[Chunk]:
    _check_known(archive, vehicle_id)
    chunks = archive.stream(
        lambda reader: reader.rows(vehicle_id, asked.kind, stretch.from_ns, stretch.to_ns)
    )
    return stepped(chunks, asked.step_s)


def _check_known(archive: Archive, vehicle_id: str) -> None:
    # a name that can be none is not asked for: databases have their own ideas of texts
    is_known = is_vehicle_id(vehicle_id) and archive.read(lambda each: each.is_known(vehicle_id))
    if not is_known:
        raise QueryError(404, f"nothing is kept of a vehicle {vehicle_id}")


def _add_trips(app: FastAPI, archive: Archive, now_ns: Callable[[], int]) -> None:
    @app.get(
        "/v1/vehicles/{vehicle_id}/trips",
        responses=answers(TripList) | AWAY_RESPONSES,
        openapi_extra=describe_parameters(StretchParameters),
        tags=["history"],
    )
    def trips(vehicle_id: str, request: Request) -> JsonAnswer:
        """The trips of a vehicle that have a part in a stretch of time, first one first."""
        stretch = read_parameters(request.query_params, StretchParameters).stretch(now_ns())
        _check_known(archive, vehicle_id)
        found = archive.read(lambda reader: reader.trips(vehicle_id, *stretch))
        return JsonAnswer(TripList(tuple(trip_answer(*each) for each in found)))

    @app.get(
        "/v1/vehicle-trips/{trip_key}",
        responses=answers(TripAnswer) | AWAY_RESPONSES,
        tags=["history"],
    )
    def trip(trip_key: str) -> JsonAnswer:
        """One trip."""
        found = archive.read(lambda each: each.trip(trip_key)) if trip_key.isprintable() else None
        if found is None:
            raise QueryError(404, f"no trip {trip_key} is kept")
        return JsonAnswer(trip_answer(*found))

    @app.get(
        "/v1/vehicles/{vehicle_id}/events",
        responses=answers(EventList) | AWAY_RESPONSES,
        openapi_extra=describe_parameters(EventsParameters),
        tags=["history"],
    )
    def events(vehicle_id: str, request: Request) -> JsonAnswer:
        """What happened to a vehicle, and to services of the fleet, in order of time."""
        asked = read_parameters(request.query_params, EventsParameters)
        stretch = asked.stretch(now_ns())
        _check_known(archive, vehicle_id)

        def read(reader: HistoryReader) -> EventList:
            found = reader.events(vehicle_id, *stretch, asked.limit + 1)
            return event_list(vehicle_id, found, asked.limit)

        return JsonAnswer(archive.read(read))


def _as(form: Format) -> dict[int | str, dict[str, Any]]:
    content = {MEDIA[form].partition(";")[0]: {"schema": {"type": "string"}}}
    return {200: {"description": "Success", "content": content}}
