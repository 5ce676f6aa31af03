"""Pure: what makes a drive: its recordings, how their signals are mapped, what vehicle it was."""

import datetime as dt
from collections.abc import Mapping
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from wayline.strict import Strict
from wayline.tuning import Tuning

Positive = Annotated[float, Meta(gt=0.0)]
VEHICLE_ID_PATTERN = r"^[a-z0-9][a-z0-9_-]{0,63}$"
VehicleId = Annotated[str, Meta(pattern=VEHICLE_ID_PATTERN)]


class DriveInfo(Strict, frozen=True, kw_only=True):
    """`[drive]`"""

    vehicle_id: VehicleId
    description: str = ""


class NmeaSource(Strict, frozen=True, kw_only=True):
    """`[[nmea]]`: NMEA 0183 text, plain or one "<epoch seconds> <sentence>" a line."""

    path: str
    date: dt.date | None = None
    """UTC day of the first sentence, for a log whose sentences carry no date."""


class Condition(Strict, frozen=True, kw_only=True):
    """A signal's value that must hold for a mapped quantity to be valid."""

    signal: str
    message: str | None = None
    """Default: the message of the mapping."""
    equals: float | None = None
    min: float | None = None
    max: float | None = None


class SignalMapping(Strict, frozen=True, kw_only=True):
    """Where a quantity is on the bus; scale and offset apply after the DBC's own."""

    message: str
    signal: str | Annotated[tuple[str, ...], Meta(min_length=1)]
    """Several signals: their mean."""
    scale: float = 1.0
    offset: float = 0.0
    valid: Condition | tuple[Condition, ...] = ()
    values: dict[str, str] = {}
    """Raw value to word, for quantities that are words."""
    equals: float | None = None
    """For a boolean: true when the raw value is this; default true when nonzero."""
    latency_s: float = 0.0
    """The quantity is this much older than its frame."""

    @property
    def signals(self) -> tuple[str, ...]:
        """One or several."""
        return (self.signal,) if isinstance(self.signal, str) else self.signal

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """None, one or several; all must hold."""
        return (self.valid,) if isinstance(self.valid, Condition) else self.valid


Places = SignalMapping | Annotated[tuple[SignalMapping, ...], Meta(min_length=1)]
"""Where a quantity is; of several the first that says something, as long as it does."""


class Clock(Strict, frozen=True, kw_only=True):
    """A signal that holds UTC in Unix seconds; every bus of the drive is moved to it."""

    message: str
    signal: str
    valid: Condition | tuple[Condition, ...] = ()


class CanMapping(Strict, frozen=True, kw_only=True):
    """What a recorded and a live bus have in common: databases, mapping, clock."""

    dbc: tuple[str, ...] = ()
    signals: Mapping[str, Places] = {}
    j1939: bool = False
    """Match by PGN, whatever source address and priority; "not available" is null."""
    clock_offset_s: float = 0.0
    """Added to the source's times to make them UTC."""
    clock: Clock | None = None


class CanSource(CanMapping, frozen=True, kw_only=True):
    """`[[can]]`: a recording of a bus (docs/your-own-drive.md), and the mapping of its signals."""

    path: str | tuple[str, ...]
    channel: str | int | None = None
    """Read only this one of the recording's channels, as the file itself names or numbers it."""
    own_frames: bool = False
    """Take also frames that the logger sent itself (Tx)."""
    timezone: str = "UTC"
    """Of a header's date that is by the clock on the wall, and of `date`."""
    date: dt.date | None = None
    """Day on which the times of a recording without a date begin, at midnight."""

    @property
    def paths(self) -> tuple[str, ...]:
        """The recordings in order."""
        return (self.path,) if isinstance(self.path, str) else self.path


class AvlColumn(Strict, frozen=True, kw_only=True):
    """A column of numbers that are in another unit."""

    name: str
    scale: float = 1.0
    """Times this they are in our unit."""


Column = str | AvlColumn


class AvlColumns(Strict, frozen=True, kw_only=True):
    """Names of the columns of a CSV of position reports."""

    time: str
    lat_deg: Column
    lon_deg: Column
    heading_deg: Column | None = None
    speed_mps: Column | None = None
    satellites: Column | None = None
    hdop: Column | None = None
    pdop: Column | None = None
    assignment: str | None = None
    """The trip or block that the vehicle is on, in its system's own words."""


class AvlSource(Strict, frozen=True, kw_only=True):
    """`[[avl]]`: position reports of a transit system, as CSV or GTFS-Realtime."""

    path: str
    """A table; without `columns`, recorded vehicle positions: a file, or a folder of them."""
    columns: AvlColumns | None = None
    timezone: str = "UTC"
    where: Mapping[str, str | int] = {}
    """Only rows that have these values in these columns; of GTFS-Realtime vehicle_id, label,
    license_plate, trip_id, route_id."""


RawFormat = Literal["ubx", "rinex", "csv"]
Correction = Literal["atmosphere", "satellite_clock", "earth_rotation"]


class RawColumns(Strict, frozen=True, kw_only=True):
    """Names of the columns of a CSV of raw measurements, one satellite a row.

    All but `time` are fields of `wayline.messages.RawSatellite`, in their units.
    """

    time: str
    prn: str
    """A number, or as RINEX writes it with its system: G12."""
    system: str | None = None
    """gps, glonass, ... or RINEX's letter; without it `prn` tells, else it is gps."""
    pseudorange_m: Column | None = None
    pseudorange_std_m: Column | None = None
    doppler_hz: Column | None = None
    doppler_std_hz: Column | None = None
    cn0_dbhz: Column | None = None
    carrier_hz: Column | None = None
    elevation_deg: Column | None = None
    azimuth_deg: Column | None = None
    line_of_sight: str | None = None
    x_m: Column | None = None
    y_m: Column | None = None
    z_m: Column | None = None
    vx_mps: Column | None = None
    vy_mps: Column | None = None
    vz_mps: Column | None = None
    clock_bias_m: Column | None = None
    clock_drift_mps: Column | None = None


class RawSource(Strict, frozen=True, kw_only=True):
    """`[[raw]]`: what a receiver measured of each satellite, before any fix."""

    path: str
    format: RawFormat | None = None
    """Known by its content where it is not said; `columns` make it csv."""
    nav: str | tuple[str, ...] = ()
    """RINEX navigation files: satellites' orbits and clocks."""
    columns: RawColumns | None = None
    timezone: str = "UTC"
    """Of times in a table that carry no offset."""
    corrected: tuple[Correction, ...] = ()
    """What the pseudoranges of a table have behind them already. `earth_rotation`: they fit the
    places as these are told, whatever the Earth turned while the signal travelled."""

    @property
    def navs(self) -> tuple[str, ...]:
        """None, one or several."""
        return (self.nav,) if isinstance(self.nav, str) else self.nav


class Vehicle(Strict, frozen=True, kw_only=True):
    """`[vehicle]`: what the torque slope and the filters need; the defaults are a car's."""

    profile: str | tuple[str, ...] = ()
    """Known vehicles or boxes: mappings of their frames, and figures in place of the car's."""
    mass_kg: Positive = 1500.0
    wheel_radius_m: Positive = 0.31
    frontal_area_m2: Positive = 2.2
    drag_coefficient: Positive = 0.30
    rolling_coefficient: Positive = 0.010
    driveline_efficiency: Annotated[float, Meta(gt=0.0, le=1.0)] = 0.92
    """Divides on the overrun."""
    final_drive_ratio: Positive = 4.1
    gear_ratios: tuple[Positive, ...] = ()
    engine_reference_torque_nm: Positive | None = None
    """What 100 % means where the bus reports torque in percent."""
    gps_latency_s: float = 0.0
    """A fix describes the vehicle this long before its own timestamp."""

    @property
    def profiles(self) -> tuple[str, ...]:
        """None, one or several; the first that maps a quantity counts."""
        return (self.profile,) if isinstance(self.profile, str) else self.profile


class PathRef(Strict, frozen=True, kw_only=True):
    """`[truth]`: a file beside the drive."""

    path: str


class RouteRef(Strict, frozen=True, kw_only=True):
    """`[route]`: the route that a drive follows, or those of which it follows one."""

    path: str | tuple[str, ...]

    @property
    def paths(self) -> tuple[str, ...]:
        """One file or several."""
        return (self.path,) if isinstance(self.path, str) else self.path


class Assignment(Strict, frozen=True, kw_only=True):
    """`[assignment]`: what a vehicle runs, where it is known."""

    route_id: str | None = None
    block_id: str | None = None
    trip_id: str | None = None

    @property
    def name(self) -> str | None:
        """The trip or block, whichever says more; None where only a route is named."""
        return self.trip_id or self.block_id

    def __post_init__(self) -> None:
        if not (self.route_id or self.block_id or self.trip_id):
            raise ValueError("names neither route_id nor block_id nor trip_id")


class Drive(Strict, frozen=True, kw_only=True):
    """A whole `drive.toml`."""

    drive: DriveInfo
    nmea: tuple[NmeaSource, ...] = ()
    can: tuple[CanSource, ...] = ()
    avl: tuple[AvlSource, ...] = ()
    raw: tuple[RawSource, ...] = ()
    vehicle: Vehicle = msgspec.field(default_factory=Vehicle)
    tuning: Tuning = msgspec.field(default_factory=Tuning)
    route: RouteRef | None = None
    truth: PathRef | None = None
    assignment: Assignment | None = None
