"""Pure: what the page is told of a vehicle. The TypeScript side mirrors this in web/src/view.ts.

Times are RFC 3339 UTC (SPEC section 5). Every section is null until its first message.
"""

from typing import Literal

import msgspec

from wayline.drive import VehicleId
from wayline.messages import Calibration, FixKind, PoseMode
from wayline_dashboard.ellipse import Ellipse
from wayline_dashboard.trail import TrailPoint


class PoseView(msgspec.Struct, frozen=True, kw_only=True):
    """Where the vehicle is and how well that is known; units as in the topic `pose`."""

    t: str
    mode: PoseMode
    lat_deg: float | None
    lon_deg: float | None
    alt_m: float | None
    alt_std_m: float | None
    heading_deg: float | None
    heading_std_deg: float | None
    speed_mps: float | None
    speed_std_mps: float | None
    grade_pct: float | None
    grade_std_pct: float | None
    distance_m: float
    ellipse: Ellipse | None


class FixView(msgspec.Struct, frozen=True, kw_only=True):
    """The receiver's own last word, beside the pose and never mixed with it."""

    t: str
    source: str
    valid: bool
    fix: FixKind
    lat_deg: float | None
    lon_deg: float | None
    satellites: int | None
    hdop: float | None
    h_std_m: float | None


class SensorSlopeView(msgspec.Struct, frozen=True, kw_only=True):
    """What one sensor alone says of the slope of the last 200 m."""

    sensor: str
    source: str | None
    """The receiver, of altitudes."""
    slope_pct: float
    slope_std_pct: float
    refused: bool
    """Whether a reading of it was refused since the status before."""


class StatusView(msgspec.Struct, frozen=True, kw_only=True):
    """How fusion gets on with its sensors."""

    t: str
    calibration: Calibration
    outage_s: float
    late: int
    rejected: int
    last_rejection: str | None
    """Sensor and reason of the newest refused measurement."""
    slopes: tuple[SensorSlopeView, ...]


class ProgressView(msgspec.Struct, frozen=True, kw_only=True):
    """Where the vehicle is along its route."""

    t: str
    route_id: str
    trip_id: str | None
    distance_m: float
    distance_std_m: float
    lap: int
    cross_track_m: float
    on_route: bool
    delay_s: float | None
    """Behind the timetable."""


class StopView(msgspec.Struct, frozen=True, kw_only=True):
    """The next arrival at a stop: median, 10 and 90 % quantiles."""

    stop_id: str
    name: str
    distance_m: float
    arrival: str
    early: str
    late: str
    scheduled: str | None
    delay_s: float | None
    """Behind the timetable, when it comes."""
    trip_id: str | None
    """Of a later trip than the one under way."""


class ArrivalsView(msgspec.Struct, frozen=True, kw_only=True):
    """The next arrivals; `t` is the vehicle's time that "in 3 min" counts from."""

    t: str
    route_id: str
    trip_id: str | None
    headsign: str | None
    stale: bool
    stops: tuple[StopView, ...]


class SlopePoint(msgspec.Struct, frozen=True, kw_only=True):
    """Slope at a distance ahead."""

    distance_m: float
    grade_pct: float | None
    grade_std_pct: float | None
    alt_m: float | None
    runs: int


class HorizonView(msgspec.Struct, frozen=True, kw_only=True):
    """The road ahead, as earlier runs knew it."""

    t: str
    road_id: str | None
    points: tuple[SlopePoint, ...]


class MissingView(msgspec.Struct, frozen=True, kw_only=True):
    """What a service lacks, and since when."""

    subject: str
    what: str
    since: str


class ServiceView(msgspec.Struct, frozen=True, kw_only=True):
    """One service: up or down by its liveliness token, the rest by its last health."""

    service: str
    up: bool
    t: str | None = None
    version: str | None = None
    in_rate_hz: float | None = None
    out_rate_hz: float | None = None
    backlog: int = 0
    dropped: int = 0
    dropped_rate_hz: float = 0.0
    bad_input: int = 0
    bad_input_rate_hz: float = 0.0
    lag_ms_p50: float | None = None
    lag_ms_p99: float | None = None
    detail: str | None = None
    missing: tuple[MissingView, ...] = ()
    """Empty where it is ready."""
    recorded: bool = False
    """What it puts on the bus is of a recording, so its times may be old."""


class VehicleView(msgspec.Struct, kw_only=True, omit_defaults=True):
    """A vehicle, or in a change only those sections of it that changed.

    Sections left out are unchanged. `trail` is what follows the trail already told;
    with `trail_restart` it replaces it.
    """

    vehicle_id: str
    heard: str | None = None
    """As long before the fleet's `now` as the pose is old; one of a recording ages from receipt."""
    pose: PoseView | None = None
    fix: FixView | None = None
    status: StatusView | None = None
    progress: ProgressView | None = None
    arrivals: ArrivalsView | None = None
    horizon: HorizonView | None = None
    services: tuple[ServiceView, ...] | None = None
    trail: tuple[TrailPoint, ...] = ()
    trail_restart: bool = False
    trail_began: str | None = None
    """With `trail_restart`: when the vehicle was at the trail's first point."""


class FleetView(msgspec.Struct, frozen=True, kw_only=True):
    """What `/v1/view` answers and `/v1/live` sends: first a snapshot, then changes."""

    kind: Literal["snapshot", "changes"]
    now: str
    """The server's clock, so that a page on a wrong clock still shows right ages."""
    selected: str | None
    """The vehicle that is told whole; `/v1/live` tells of the others only where they are."""
    vehicles: tuple[VehicleView, ...]
    gone: tuple[str, ...]
    """Vehicles to drop before `vehicles` are taken: they were silent for long."""
    services: tuple[ServiceView, ...] | None
    """Those that serve the whole fleet; null in a change where none changed."""


class Selection(msgspec.Struct, frozen=True, kw_only=True):
    """What a page sends over `/v1/live`: the vehicle that it shows, null for none."""

    vehicle_id: VehicleId | None
