"""Reads the configuration file of the services; the environment overrides identity and secrets."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
from msgspec import Meta

from wayline.drive import VEHICLE_ID_PATTERN, Assignment, Vehicle, VehicleId
from wayline.errors import InputError
from wayline.http_settings import HttpSettings
from wayline.live_sources import LiveAvl, LiveCan, LiveNmea, LiveRaw
from wayline.profile import with_profiles
from wayline.services import SERVICES
from wayline.strict import Strict, fitted
from wayline.toml import read_toml
from wayline.tuning import Tuning

if TYPE_CHECKING:
    ServiceName = str
else:
    # a Literal, so that whoever misspells a name is told which there are
    ServiceName = Literal[tuple(SERVICES)]
Port = Annotated[int, Meta(ge=0, le=65535)]
EVERY_VEHICLE = "*"
Served = Annotated[str, Meta(pattern=rf"^(\*|{VEHICLE_ID_PATTERN.strip('^$')})$")]


class BusSettings(Strict, frozen=True, kw_only=True):
    """`[bus]`"""

    connect: tuple[str, ...] = ("tcp/127.0.0.1:7447",)
    """Endpoints of the router, tried in order."""
    user: str | None = None
    password: str | None = None
    """Where the router asks for them; better in WAYLINE_ZENOH_PASSWORD than in a file."""
    tls_root_ca: str | None = None
    """PEM file with the authority that signed the router's certificate, for tls/ endpoints."""
    tls_cert: str | None = None
    """PEM file with this machine's own certificate, where the router asks for one."""
    tls_key: str | None = None
    """PEM file with its private key."""


class RerunSettings(Strict, frozen=True, kw_only=True):
    """`[rerun]`: fusion's live view."""

    enabled: bool = False
    port: Port = 9876
    """On loopback: rerun+http://127.0.0.1:9876/proxy"""
    memory_limit: str = "256MB"
    """What late viewers can still see."""
    record: str | None = None
    """File (.rrd) that the live view is also written to."""


class VehicleAssignment(Assignment, frozen=True, kw_only=True):
    """`[[assignment]]`: what one vehicle runs."""

    vehicle_id: VehicleId


class Settings(Strict, frozen=True, kw_only=True):
    """A whole `wayline.toml`; one file may serve all services of a machine."""

    vehicle_id: VehicleId | None = None
    """The vehicle that this machine rides on."""
    vehicles: tuple[Served, ...] = ()
    """On a server: the vehicles served; `["*"]` is every vehicle heard."""
    forget_vehicle_after_s: Annotated[float, Meta(gt=0.0)] = 3600.0
    """Of every vehicle: one that is silent this long is dropped until it is heard again."""
    services: tuple[ServiceName, ...] = ()
    """What `wayline up` runs."""
    router: bool = False
    """`wayline up` also runs a router on the first endpoint of `bus.connect`."""
    database_url: str | None = None
    """SQLite file or PostgreSQL, e.g. sqlite:////var/lib/wayline/wayline.db"""
    database_retry_s: Annotated[float, Meta(gt=0.0)] = 5.0
    """The longest pause between two tries of a database that is away."""
    database_refresh_s: Annotated[float, Meta(gt=0.0)] = 10.0
    """How often is looked for what other processes have written."""
    history_days: Annotated[float, Meta(gt=0.0)] = 30.0
    """How long history keeps what has come."""
    history_max_mb: Annotated[float, Meta(gt=0.0)] = 10_000.0
    """How much, in millions of bytes; the oldest goes first."""
    history_thin_after_h: Annotated[float, Meta(ge=0.0)] = 24.0
    """Poses that a straight line tells as well are left out so many hours later."""
    history_url: str | None = None
    """Where the dashboard asks for the past; default: history's own port on this machine."""
    routes: tuple[str, ...] = ()
    """GeoJSON files of the routes, relative to this file."""
    feeds: tuple[str, ...] = ()
    """Timetables (GTFS folders or zip files), relative to this file: eta follows their trips."""
    assignment: tuple[VehicleAssignment, ...] = ()
    """What vehicles run, where that is known and their reports do not say it."""
    bus: BusSettings = msgspec.field(default_factory=BusSettings)
    http: HttpSettings = msgspec.field(default_factory=HttpSettings)
    ports: dict[ServiceName, Port] = {}
    """HTTP ports where they differ from the services' own."""
    rerun: RerunSettings = msgspec.field(default_factory=RerunSettings)
    nmea: tuple[LiveNmea, ...] = ()
    avl: tuple[LiveAvl, ...] = ()
    raw: tuple[LiveRaw, ...] = ()
    can: tuple[LiveCan, ...] = ()
    vehicle: Vehicle = msgspec.field(default_factory=Vehicle)
    tuning: Tuning = msgspec.field(default_factory=Tuning)

    def served(self) -> tuple[str, ...]:
        """The vehicles served, `("*",)` for every one. Raises InputError where none is named."""
        served = self.vehicles or ((self.vehicle_id,) if self.vehicle_id else ())
        if served:
            return (EVERY_VEHICLE,) if EVERY_VEHICLE in served else served
        raise InputError(
            "configuration",
            "no vehicle is named",
            'set vehicle_id or WAYLINE_VEHICLE_ID, or vehicles = ["*"]',
        )

    def own_vehicle(self) -> str:
        """The vehicle that this machine rides on. Raises InputError where it is not named."""
        if self.vehicle_id is None:
            mend = "set vehicle_id or WAYLINE_VEHICLE_ID"
            raise InputError("configuration", "no vehicle is named", mend)
        return self.vehicle_id

    def http_of(self, service: str) -> HttpSettings:
        """HTTP settings of one service, with its port."""
        port = self.ports.get(service, self.http.port)
        own = SERVICES[service].port if port is None else port
        return msgspec.structs.replace(self.http, port=own)


def load_settings(path: Path, environment: Mapping[str, str] = os.environ) -> Settings:
    """Read a configuration file; paths in it become absolute, the environment overrides.

    Raises InputError for a missing file, an unknown key or a value that does not fit.
    """
    settings = fitted(with_profiles(read_toml(path), str(path)), Settings, str(path))
    folder = path.resolve().parent

    def absolute(name: str) -> str:
        return str(folder / name)

    settings = msgspec.structs.replace(
        settings,
        routes=tuple(absolute(route) for route in settings.routes),
        feeds=tuple(absolute(feed) for feed in settings.feeds),
        raw=tuple(
            msgspec.structs.replace(raw, nav=tuple(map(absolute, raw.navs))) for raw in settings.raw
        ),
        can=tuple(
            msgspec.structs.replace(can, dbc=tuple(absolute(dbc) for dbc in can.dbc))
            for can in settings.can
        ),
    )
    return overridden(settings, environment)


def overridden(settings: Settings, environment: Mapping[str, str]) -> Settings:
    """Settings with what the environment says (SPEC section 2)."""
    bus, http = settings.bus, settings.http
    if connect := environment.get("WAYLINE_ZENOH_CONNECT"):
        bus = msgspec.structs.replace(bus, connect=tuple(connect.split(",")))
    if user := environment.get("WAYLINE_ZENOH_USER"):
        bus = msgspec.structs.replace(bus, user=user)
    if password := environment.get("WAYLINE_ZENOH_PASSWORD"):
        bus = msgspec.structs.replace(bus, password=password)
    if token := environment.get("WAYLINE_HTTP_TOKEN"):
        http = msgspec.structs.replace(http, tokens=(*http.tokens, token))
    changed = {
        "vehicle_id": environment.get("WAYLINE_VEHICLE_ID", settings.vehicle_id),
        "database_url": environment.get("WAYLINE_DATABASE_URL", settings.database_url),
        "bus": bus,
        "http": http,
    }
    try:
        whole = msgspec.structs.replace(settings, **changed)
        return msgspec.convert(msgspec.to_builtins(whole), Settings)
    except msgspec.ValidationError as error:
        raise InputError("environment", str(error), "correct the WAYLINE_ variable") from None
