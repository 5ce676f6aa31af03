"""The past for the page: passes on what history answers, since a page may ask its own host only."""

import logging
from collections.abc import Iterator
from typing import Annotated, Literal

import httpx2
import msgspec
from fastapi import FastAPI, Request
from msgspec import Meta
from starlette.responses import StreamingResponse

from wayline.http import AWAY_RESPONSES
from wayline.keys import is_vehicle_id
from wayline.parameters import describe_parameters
from wayline.query_error import QueryError

TIMEOUT_S = 10.0
PASSED_ON = ("content-type", "content-disposition")
What = Literal["track", "track.gpx", "track.csv", "track.geojson", "trips", "events"]
Text = Annotated[str, Meta(max_length=64)]

# a line of its own for every request would hide all others
logging.getLogger("httpx2").setLevel(logging.WARNING)


class PastParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What history's paths take; history says what is wrong with it."""

    from_: Annotated[Text, Meta(description="First instant, RFC 3339")] | msgspec.UnsetType = (
        msgspec.field(default=msgspec.UNSET, name="from")
    )
    to: Annotated[Text, Meta(description="Before this instant, RFC 3339")] | msgspec.UnsetType = (
        msgspec.UNSET
    )
    kind: Annotated[Text, Meta(description="raw, fused or on_route")] | msgspec.UnsetType = (
        msgspec.UNSET
    )
    step_s: Annotated[Text, Meta(description="One point in so long")] | msgspec.UnsetType = (
        msgspec.UNSET
    )
    limit: Annotated[Text, Meta(description="So many at most")] | msgspec.UnsetType = msgspec.UNSET


def add_past(app: FastAPI, history_url: str) -> None:
    """Serve history's tracks, trips and events of a vehicle, with the token of whoever asks."""
    # what the environment says of proxies is for other machines
    client = httpx2.Client(base_url=history_url, timeout=TIMEOUT_S, trust_env=False)

    @app.get(
        "/v1/vehicles/{vehicle_id}/{what}",
        response_class=StreamingResponse,
        responses=AWAY_RESPONSES,
        openapi_extra=describe_parameters(PastParameters),
        tags=["history"],
    )
    def past(vehicle_id: str, what: What, request: Request) -> StreamingResponse:
        """Where a vehicle was, its trips and what happened to it, as history tells."""
        if not is_vehicle_id(vehicle_id):
            raise QueryError(404, f"{vehicle_id!r} is no vehicle's id")
        asked = client.build_request(
            "GET",
            httpx2.URL(path=f"/v1/vehicles/{vehicle_id}/{what}", query=request.url.query.encode()),
            headers=_token(request),
        )
        try:
            answer = client.send(asked, stream=True)
        except httpx2.HTTPError as error:
            detail = f"history at {history_url} does not answer ({type(error).__name__})"
            raise QueryError(503, detail) from None
        headers = {name: answer.headers[name] for name in PASSED_ON if name in answer.headers}
        return StreamingResponse(_parts(answer), answer.status_code, headers)


def _token(request: Request) -> dict[str, str]:
    token = request.headers.get("authorization")
    return {} if token is None else {"authorization": token}


def _parts(answer: httpx2.Response) -> Iterator[bytes]:
    try:
        yield from answer.iter_bytes()
    finally:
        answer.close()
