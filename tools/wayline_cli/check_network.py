"""The doctor's checks of ports and of the router."""

import http.client
import json
from collections.abc import Callable, Iterable

import msgspec
import zenoh

from wayline.bus import client_config
from wayline.http import Healthz
from wayline.http_settings import is_loopback
from wayline.settings import BusSettings, Settings
from wayline_cli.check import Check, fine, note, wrong
from wayline_cli.demo_files import LOOPBACK, is_free
from wayline_cli.demo_ready import answer

ROUTER_TIMEOUT_S = 3.0

PortState = Callable[[str, int], str | None]
"""Who holds a host's port: None for nobody, a service's name, or "" for somebody unknown."""
OpenSession = Callable[[BusSettings], str | None]
"""Why no session opens, None where one does."""


def check_http_ports(settings: Settings, services: Iterable[str], held: PortState) -> list[Check]:
    """Whether each service's port is free or its own."""
    checks = []
    for service in services:
        http_settings = settings.http_of(service)
        port = http_settings.port or 0
        holder = held(http_settings.host, port)
        has_tls = http_settings.tls_cert is not None
        checks.append(_check_port(f"port {port} of {service}", service, holder, has_tls=has_tls))
    return checks


def _check_port(subject: str, service: str, holder: str | None, *, has_tls: bool) -> Check:
    if holder is None:
        return fine(subject, "free")
    if holder == service:
        return fine(subject, f"wayline {service} answers there")
    mend = "stop what listens there or set another port in [ports]"
    if holder:
        return wrong(subject, f"taken by wayline {holder}", mend)
    if has_tls:
        return note(subject, "taken; with TLS the doctor cannot ask by whom", mend)
    return wrong(subject, "taken by another program", mend)


def port_holder(host: str, port: int) -> str | None:
    """Who listens there: nobody (None), a Wayline service by its name, or somebody ("")."""
    if port == 0 or is_free(port, host):
        return None
    # a service that serves every address is asked on this machine's own
    is_here = is_loopback(host) or host in {"0.0.0.0", "::", ""}  # noqa: S104 - compared only
    found = answer(port, "/livez") if is_here or host == LOOPBACK else None
    if found is None or found[0] not in {http.client.OK, http.client.SERVICE_UNAVAILABLE}:
        return ""
    try:
        return msgspec.json.decode(found[1], type=Healthz).service
    except msgspec.DecodeError:
        return ""


def check_router(bus: BusSettings, *, own_router: bool, open_session: OpenSession) -> Check:
    """Whether the bus can be joined."""
    subject, problem = f"router {', '.join(bus.connect)}", open_session(bus)
    if problem is None:
        return fine(subject, "lets a service join")
    finding = f"cannot be joined ({problem})"
    if own_router:
        return note(
            subject, finding, "wayline up starts it where router = true, wayline demo always"
        )
    return wrong(subject, finding, "start it, or correct bus.connect, bus.user and the password")


def try_session(bus: BusSettings) -> str | None:
    """Join the bus as a service would, but give up soon."""
    config = client_config(bus)
    config.insert_json5("connect/timeout_ms", json.dumps(round(ROUTER_TIMEOUT_S * 1000)))
    config.insert_json5("connect/exit_on_failure", "true")
    try:
        with zenoh.open(config):
            return None
    except zenoh.ZError as error:
        # zenoh adds its own sources' places, which say nothing to a reader
        return " ".join(str(error).split(" at /")[0].split())
