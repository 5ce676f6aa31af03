"""`wayline doctor`: looks at what Wayline needs on this machine and says what to mend."""

import datetime as dt
import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from wayline.errors import InputError
from wayline.http_settings import check_exposure
from wayline.route_file import load_route
from wayline.services import SERVICES, ServiceRow, Tables
from wayline.settings import Settings, load_settings, overridden
from wayline_cli.check import Check, attempted, fine, note, wrong
from wayline_cli.check_doors import check_doors
from wayline_cli.check_machine import (
    check_clock,
    check_disk,
    check_packages,
    check_page,
    is_installed,
    node_version,
)
from wayline_cli.check_network import check_http_ports, check_router, port_holder, try_session
from wayline_cli.check_secrets import check_secrets
from wayline_dashboard.page import STATIC

SQLITE = "sqlite:///"


def doctor(
    config: Path | None = None, environment: Mapping[str, str] = os.environ
) -> Sequence[Check]:
    """Every check, the configuration's first; without a file, of a machine on its defaults.

    Nothing is written or started. `wayline_cli.check.is_well` judges all of them.
    """
    try:
        settings = load_settings(config) if config else overridden(Settings(), environment)
    except InputError as error:
        return [wrong("configuration", f"{error.where}: {error.what}", error.mend), *machine()]
    services = settings.services or tuple(SERVICES)
    loaded = fine("configuration", str(config)) if config else note(*NO_FILE)
    return [
        loaded,
        *(check_secrets(config, load_settings(config, {})) if config else []),
        *configured(settings, services, is_default=config is None),
        *network(settings, services, is_default=config is None),
        *devices(settings),
        *machine(settings, services),
    ]


NO_FILE = ("configuration", "none given, the defaults are checked", "give --config FILE")


def configured(settings: Settings, services: Sequence[str], *, is_default: bool) -> list[Check]:
    """What the configuration says: vehicles, exposure, routes, databases."""
    checks = [] if is_default else [check_vehicle(settings, services)]
    checks.append(attempted("HTTP", lambda: exposure_finding(settings)))
    checks += check_doors(settings, dt.datetime.now(dt.UTC))
    for path in settings.routes:
        checks.append(attempted("route", lambda path=path: route_finding(path)))  # type: ignore[misc]
    for row in (SERVICES[service] for service in services):
        if row.tables is not None:
            url = settings.database_url
            checks.append(check_database(url, row, row.tables, is_default=is_default))
    return checks


def check_vehicle(settings: Settings, services: Sequence[str]) -> Check:
    """Whether a vehicle is named, and one alone where this machine reads its sensors."""
    reads_sensors = any(SERVICES[service].reads_sensors for service in services)
    if reads_sensors and (settings.nmea or settings.can or settings.raw):
        return attempted("vehicle", settings.own_vehicle)
    return attempted("vehicle", lambda: ", ".join(settings.served()))


def exposure_finding(settings: Settings) -> str:
    """Who may ask over HTTP. Raises InputError where strangers could."""
    http = settings.http
    check_exposure(http)
    if http.tls_key is not None and not Path(http.tls_key).is_file():
        raise InputError(http.tls_key, "no such file", "correct http.tls_key")
    guarded = "with tokens" if http.tokens else "for this machine alone"
    return f"on {http.host}, {guarded}"


def route_finding(path: str) -> str:
    """A route that loads. Raises InputError."""
    route = load_route(Path(path))
    return f"{route.route_id}: {route.length_m:,.0f} m, {len(route.stops)} stops"


def check_database(url: str | None, row: ServiceRow, tables: Tables, *, is_default: bool) -> Check:
    """A service's database."""
    subject = f"database of {row.name}"
    if url is not None:
        if not is_installed("alembic"):
            return note(subject, "not looked at, a package is missing", "see below")
        from wayline_cli.check_database import database_finding  # noqa: PLC0415 - an extra's

        return attempted(subject, lambda: database_finding(url, row.name, row.package))
    mend = "set database_url or WAYLINE_DATABASE_URL, e.g. sqlite:///wayline.db"
    if tables.lost_without is not None:
        return note(subject, f"none is named, {tables.lost_without}", mend)
    return (note if is_default else wrong)(subject, "none is named", mend)


def network(settings: Settings, services: Sequence[str], *, is_default: bool) -> list[Check]:
    """Ports and the router."""
    own_router = settings.router or is_default
    router = check_router(settings.bus, own_router=own_router, open_session=try_session)
    return [*check_http_ports(settings, services, port_holder), router]


def devices(settings: Settings) -> list[Check]:
    """Serial lines, and CAN interfaces of the configuration, where their packages are installed."""
    checks = []
    # they come with the extras of the ingest services; that they are missing is said elsewhere
    if is_installed("serial") and is_installed("pynmea2"):
        from wayline_cli.check_serial import check_receivers, serial_devices  # noqa: PLC0415
        from wayline_cli.listen_serial import listen  # noqa: PLC0415

        checks += check_receivers((*settings.nmea, *settings.raw), listen, serial_devices)
    if settings.avl and is_installed("httpx2"):
        from wayline_cli.check_agency import check_agencies  # noqa: PLC0415

        checks += check_agencies(settings.avl, os.environ)
    if settings.can and is_installed("can") and is_installed("isotp"):
        from wayline_can_ingest.diagnosis.opening import try_can  # noqa: PLC0415
        from wayline_cli.check_can import check_can  # noqa: PLC0415

        checks += check_can(settings.can, try_can)
    return checks


def machine(
    settings: Settings | None = None, services: Sequence[str] = tuple(SERVICES)
) -> list[Check]:
    """Packages, page, disk and clock."""
    rerun_wanted = settings is not None and settings.rerun.enabled
    folder = data_folder(settings.database_url if settings else None)
    page = check_page(STATIC / "index.html", node_version()) if "dashboard" in services else []
    return [
        *check_packages(services, rerun_wanted=rerun_wanted, has=is_installed),
        *page,
        check_disk(folder, shutil.disk_usage(folder).free),
        check_clock(dt.datetime.now(dt.UTC)),
    ]


def data_folder(url: str | None) -> Path:
    """Where the database grows; this folder where that is not known."""
    if url is None or not url.startswith(SQLITE):
        return Path.cwd()
    folder = Path(url.removeprefix(SQLITE)).absolute().parent
    return folder if folder.is_dir() else Path.cwd()
