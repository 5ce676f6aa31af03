"""Pure: where a service's HTTP listens, who may ask, and when that would be too open."""

import ipaddress
from typing import Annotated

from msgspec import Meta

from wayline.errors import InputError
from wayline.strict import Strict

MAKE_TOKEN = "python3 -c 'import secrets; print(secrets.token_urlsafe(32))'"  # noqa: S105

Token = Annotated[str, Meta(pattern=r"^[!-~]+$")]
"""Visible ASCII without spaces, as a header can carry it."""


class HttpSettings(Strict, frozen=True, kw_only=True):
    """`[http]`"""

    host: str = "127.0.0.1"
    """Address to listen on; anything but loopback needs tokens, and TLS or a proxy."""
    port: Annotated[int, Meta(ge=0, le=65535)] | None = None
    """Default: the service's own. 0 takes any free one."""
    tokens: tuple[Token, ...] = ()
    """Whoever sends one as `Authorization: Bearer` may ask; none: everybody on this machine."""
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
