"""Pure: where a service's HTTP listens, who may ask, and when that would be too open."""

import ipaddress
from typing import Annotated, Literal

from msgspec import Meta

from wayline.errors import InputError
from wayline.strict import Strict

MAKE_TOKEN = "python3 -c 'import secrets; print(secrets.token_urlsafe(32))'"  # noqa: S105

Token = Annotated[str, Meta(pattern=r"^[!-~]+$")]
"""Visible ASCII without spaces, as a header can carry it."""


Sha256 = Annotated[str, Meta(pattern=r"^[0-9a-f]{64}$")]
Origin = Annotated[str, Meta(pattern=r"^https?://[^/\s*]+$")]
"""What a browser sends as a page's origin: scheme, host and port, without a path."""
ScopeName = Literal["public", "read", "write"]


class KeptToken(Strict, frozen=True, kw_only=True):
    """A token of which only the hash is kept, so that who reads the file cannot ask."""

    sha256: Sha256
    """`printf %s TOKEN | sha256sum`"""
    scope: ScopeName
    """`public`: arrivals, routes, stops, GTFS-Realtime; `read`: all answers; `write`: all."""


class HttpSettings(Strict, frozen=True, kw_only=True):
    """`[http]`"""

    host: str = "127.0.0.1"
    """Address to listen on; anything but loopback needs tokens, and TLS or a proxy."""
    port: Annotated[int, Meta(ge=0, le=65535)] | None = None
    """Default: the service's own. 0 takes any free one."""
    tokens: tuple[Token | KeptToken, ...] = ()
    """Whoever sends one as `Authorization: Bearer` may ask; none: everybody on this machine.

    A plain one has the scope `write`.
    """
    public: bool = False
    """Arrivals, routes, stops and GTFS-Realtime are for everybody, without a token."""
    cors_origins: tuple[Origin, ...] = ()
    """Web pages from elsewhere that may ask, e.g. "https://transit.example"."""
    tls_cert: str | None = None
    """File with the certificate chain, PEM."""
    tls_key: str | None = None
    """File with its private key, PEM."""
    behind_proxy: bool = False
    """A reverse proxy does TLS: serve plain HTTP and believe its X-Forwarded headers."""


def is_loopback(host: str) -> bool:
    """Whether a host name or address is this machine only."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def check_exposure(settings: HttpSettings) -> None:
    """Raise InputError where strangers could listen in or ask."""
    where = f"http host {settings.host}"
    if (settings.tls_cert is None) != (settings.tls_key is None):
        missing = "tls_key" if settings.tls_key is None else "tls_cert"
        raise InputError(where, f"{missing} is missing", "set tls_cert and tls_key, or neither")
    if is_loopback(settings.host):
        return
    if not settings.tokens:
        raise InputError(
            where,
            "would serve other machines without tokens",
            f"set http.tokens or WAYLINE_HTTP_TOKEN to one made by {MAKE_TOKEN},"
            " or host to 127.0.0.1",
        )
    if settings.tls_cert is None and not settings.behind_proxy:
        raise InputError(
            where,
            "would send tokens to other machines in the clear",
            "set http.tls_cert and http.tls_key, or http.behind_proxy = true",
        )
