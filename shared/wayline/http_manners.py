"""What HTTP's users take for granted: HEAD, caching, limits, and a word about what is misspelt."""

import http
from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import Request, Response
from fastapi.routing import APIRoute
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from wayline.http_problems import Problem, ProblemResponse, problem
from wayline.query_error import QueryError

BODY_MAX_BYTES = 65_536
"""No answer needs a body; what somebody sends all the same is read and thrown away."""
KEPT_ON_NOT_MODIFIED = {b"etag", b"cache-control", b"vary", b"date"}
"""Headers that an answer without its body still has (RFC 9110, 15.4.5)."""

Handler = Callable[[Request], Coroutine[Any, Any, Response]]


class TellingRoute(APIRoute):
    """A path that tells of query parameters that it does not have, rather than ignoring them."""

    def get_route_handler(self) -> Handler:
        """What answers a request."""
        handle = super().get_route_handler()
        described = (self.openapi_extra or {}).get("parameters", ())
        known = {parameter["name"] for parameter in described if parameter["in"] == "query"}
        known |= {parameter.alias for parameter in self.dependant.query_params}

        async def tell(request: Request) -> Response:
            if request.scope["query_string"]:
                _refuse_unknown(request, known)
            return await handle(request)

        return tell


def _refuse_unknown(request: Request, known: set[str]) -> None:
    for name in request.query_params:
        if name not in known:
            has = f"there are {', '.join(sorted(known))}" if known else "there are none"
            raise QueryError(422, f"is no parameter of this path; {has}", parameter=name)


class _Bodiless:
    """Sends an answer's beginning and then an empty body, whatever body comes."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self.has_ended = False

    async def __call__(self, message: Message) -> None:
        if message["type"] != "http.response.body":
            await self._send(message)
        elif not self.has_ended:
            self.has_ended = True
            await self._send({"type": "http.response.body", "body": b"", "more_body": False})


class HeadAsGet:
    """Answers HEAD as GET without the body, on every path."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a HEAD on as a GET."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self.app(scope, receive, send)
            return
        bodiless = _Bodiless(send)

        async def receive_end() -> Message:
            # an answer that streams for ever listens for it
            return {"type": "http.disconnect"} if bodiless.has_ended else await receive()

        await self.app({**scope, "method": "GET"}, receive_end, bodiless)


class Freshness:
    """Live answers are kept by nobody; one with an ETag is sent again only when it has changed."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on; on the way back set Cache-Control, or turn an answer into 304."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        known = Headers(scope=scope).get("if-none-match", "")
        passing: Send = send

        async def send_fresh(message: Message) -> None:
            nonlocal passing
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                etag = headers.get("etag")
                if etag is None:
                    headers.setdefault("cache-control", "no-store")
                elif message["status"] == http.HTTPStatus.OK and _is_among(etag, known):
                    message, passing = _not_modified(message), _Bodiless(send)
            await passing(message)

        await self.app(scope, receive, send_fresh)


def _is_among(etag: str, known: str) -> bool:
    tags = {tag.strip().removeprefix("W/") for tag in known.split(",")}
    return "*" in tags or etag.removeprefix("W/") in tags


def _not_modified(start: Message) -> Message:
    kept = [header for header in start["headers"] if header[0] in KEPT_ON_NOT_MODIFIED]
    return {**start, "status": http.HTTPStatus.NOT_MODIFIED, "headers": kept}


class BodyLimit:
    """Refuses a body that is larger than any that is needed, or whose end is told in two ways."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, or answer 400 or 413 and close the connection."""
        refused = _refused_body(scope) if scope["type"] == "http" else None
        if refused is None:
            await self.app(scope, receive, send)
        else:
            response = ProblemResponse(refused, {"connection": "close"})
            await response(scope, receive, send)


def _refused_body(scope: Scope) -> Problem | None:
    headers = Headers(scope=scope)
    length = headers.get("content-length")
    if length is None:
        return None
    if "transfer-encoding" in headers:
        # what one reader takes for this request's body another takes for the next request
        return problem(400, "has Content-Length and Transfer-Encoding", scope["path"])
    if int(length) > BODY_MAX_BYTES:
        return problem(413, f"the body may have {BODY_MAX_BYTES} bytes", scope["path"])
    return None
