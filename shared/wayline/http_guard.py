"""Who may ask: bearer tokens, and without them only this machine's own pages.

ASGI middleware, so that WebSockets are guarded by the same lines as plain requests.
"""

import base64
from collections.abc import Callable, Container
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Send
from starlette.types import Scope as HttpScope

from wayline.http_problems import ProblemResponse, problem
from wayline.http_scopes import Keyring, Scope
from wayline.http_settings import is_loopback

TOKEN_PROTOCOL = "wayline.bearer."  # noqa: S105 - a prefix, not a token
"""A browser cannot set headers on a WebSocket, so it offers its token as a subprotocol:
this prefix and the token in base64url without padding."""

SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
"""They change nothing (RFC 9110)."""


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


class TokenGuard:
    """Asks for a bearer token with the scope that a path needs; `needs` says None of open ones."""

    def __init__(
        self, app: ASGIApp, *, keyring: Keyring, needs: Callable[[str], Scope | None]
    ) -> None:
        self.app, self.keyring, self.needs = app, keyring, needs

    async def __call__(self, scope: HttpScope, receive: Receive, send: Send) -> None:
        """Pass on what may pass, answer 401 or 403 to the rest."""
        refusal = None if scope["type"] == "lifespan" else self._refusal(scope)
        if refusal is None:
            await self.app(scope, receive, send)
        else:
            await refusal(scope, receive, send)

    def _refusal(self, scope: HttpScope) -> ProblemResponse | None:
        needed = self._needed(scope)
        if needed is None:
            return None
        token = offered_token(Headers(scope=scope))
        granted = None if token is None else self.keyring.scope_of(token)
        if granted is None:
            asked = problem(401, "send Authorization: Bearer <token>", scope["path"])
            return ProblemResponse(asked, {"www-authenticate": 'Bearer realm="wayline"'})
        if granted >= needed:
            return None
        lacking = needed.name.lower()
        detail = f"the token's scope is {granted.name.lower()}; this needs {lacking}"
        challenge = f'Bearer realm="wayline", error="insufficient_scope", scope="{lacking}"'
        return ProblemResponse(problem(403, detail, scope["path"]), {"www-authenticate": challenge})

    def _needed(self, scope: HttpScope) -> Scope | None:
        if scope["type"] == "http" and scope["method"] not in SAFE_METHODS:
            return Scope.WRITE
        needed = self.needs(scope["path"])
        # a socket of an open path would be one that nobody has thought of
        return Scope.READ if needed is None and scope["type"] == "websocket" else needed


class LocalGuard:
    """Without tokens: keeps web pages from elsewhere away from a service on loopback.

    A browser on this machine would carry a foreign page's requests here (DNS rebinding,
    cross-site WebSockets); their Host or Origin gives them away.
    """

    def __init__(self, app: ASGIApp, *, behind_proxy: bool, origins: Container[str] = ()) -> None:
        self.app, self.behind_proxy, self.origins = app, behind_proxy, origins

    async def __call__(self, scope: HttpScope, receive: Receive, send: Send) -> None:
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
        if origin is None or origin in self.origins:
            return True
        return urlsplit(origin).netloc == host


def _name_of(url: str) -> str:
    try:
        return urlsplit(url).hostname or ""
    except ValueError:
        return ""
