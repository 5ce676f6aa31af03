"""Who may ask: bearer tokens, and without them only this machine's own pages.

ASGI middleware, so that WebSockets are guarded by the same lines as plain requests.
"""

import base64
import hmac
from collections.abc import Callable, Sequence
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from wayline.http_problems import ProblemResponse, problem
from wayline.http_settings import is_loopback

TOKEN_PROTOCOL = "wayline.bearer."  # noqa: S105 - a prefix, not a token
"""A browser cannot set headers on a WebSocket, so it offers its token as a subprotocol:
this prefix and the token in base64url without padding."""


def offered_token(headers: Headers) -> str | None:
    """The token of a request: its Authorization header, or a WebSocket's subprotocol."""
    scheme, _, token = headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer" and token:
        return token.strip()
    for protocol in headers.get("sec-websocket-protocol", "").split(","):
        name = protocol.strip()
        if name.startswith(TOKEN_PROTOCOL):
            return _decoded(name.removeprefix(TOKEN_PROTOCOL))
    return None


def _decoded(text: str) -> str | None:
    try:
        padded = text + "=" * (-len(text) % 4)
        return base64.b64decode(padded, altchars=b"-_", validate=True).decode()
    except ValueError:
        return None


def is_known(token: str, tokens: Sequence[str]) -> bool:
    """Whether a token is one of ours, in a time that does not tell how nearly."""
    matches = [hmac.compare_digest(token.encode(), known.encode()) for known in tokens]
    return any(matches)


class TokenGuard:
    """Asks for a bearer token everywhere but on open paths."""

    def __init__(
        self, app: ASGIApp, *, tokens: Sequence[str], is_open: Callable[[str], bool]
    ) -> None:
        self.app, self.tokens, self.is_open = app, tokens, is_open

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what may pass, answer 401 to the rest."""
        if scope["type"] == "lifespan" or self._may(scope):
            await self.app(scope, receive, send)
            return
        refusal = problem(401, "send Authorization: Bearer <token>", scope["path"])
        response = ProblemResponse(refusal, {"www-authenticate": 'Bearer realm="wayline"'})
        await response(scope, receive, send)

    def _may(self, scope: Scope) -> bool:
        if scope["type"] == "http" and self.is_open(scope["path"]):
            return True
        token = offered_token(Headers(scope=scope))
        return token is not None and is_known(token, self.tokens)


class LocalGuard:
    """Without tokens: keeps web pages from elsewhere away from a service on loopback.

    A browser on this machine would carry a foreign page's requests here (DNS rebinding,
    cross-site WebSockets); their Host or Origin gives them away.
    """

    def __init__(self, app: ASGIApp, *, behind_proxy: bool) -> None:
        self.app, self.behind_proxy = app, behind_proxy

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what may pass, answer 403 to the rest."""
        if scope["type"] == "lifespan" or self._may(Headers(scope=scope)):
            await self.app(scope, receive, send)
            return
        detail = "asked under a foreign name or by a foreign page; set tokens to serve others"
        await ProblemResponse(problem(403, detail, scope["path"]))(scope, receive, send)

    def _may(self, headers: Headers) -> bool:
        host = headers.get("host", "")
        if self.behind_proxy:
            host = headers.get("x-forwarded-host", host)
        elif not is_loopback(_name_of(f"//{host}")):
            return False
        origin = headers.get("origin")
        return origin is None or urlsplit(origin).netloc == host


def _name_of(url: str) -> str:
    try:
        return urlsplit(url).hostname or ""
    except ValueError:
        return ""
