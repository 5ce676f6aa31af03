"""Pure: gpsd's reports in JSON, the parts of them that are read (man gpsd_json)."""

import datetime as dt
import math
from typing import Annotated

import msgspec

from wayline.messages import STD_MAX, Count, FixKind, NonNegative, Satellite
from wayline_gps_ingest.sky import system_of

KINDS: dict[int, FixKind] = {
    2: "dgps",
    3: "rtk_fixed",
    4: "rtk_float",
    5: "dead_reckoning",
    6: "dead_reckoning",
    8: "simulator",
}
"""TPV's status; all else is a plain fix."""
SYSTEMS: dict[int | None, str] = {
    0: "gps",
    1: "sbas",
    2: "galileo",
    3: "beidou",
    5: "qzss",
    6: "glonass",
    7: "navic",
}
"""By gpsd's gnssid, which is u-blox's."""
UNIX = dt.datetime(1970, 1, 1, tzinfo=dt.UTC)
Time = (
    Annotated[dt.datetime, msgspec.Meta(tz=True)] | Annotated[float, msgspec.Meta(ge=0.0, lt=1e10)]
)
"""ISO 8601, in the first versions Unix seconds."""


class Tpv(msgspec.Struct, frozen=True, tag="TPV", tag_field="class"):
    """Time, position, velocity: what is read of it."""

    device: str = ""
    mode: int = 0
    status: int = 0
    time: Time | None = None
    lat: float | None = None
    lon: float | None = None
    alt: float | None = None
    alt_hae: float | None = msgspec.field(name="altHAE", default=None)
    alt_msl: float | None = msgspec.field(name="altMSL", default=None)
    geoid_sep: float | None = msgspec.field(name="geoidSep", default=None)
    speed: float | None = None
    track: float | None = None

    @property
    def alt_m(self) -> float | None:
        """Above mean sea level; up to gpsd 3.18 `alt` is that and the only one."""
        if self.alt_msl is not None:
            return self.alt_msl
        if self.alt_hae is None:
            return self.alt
        return None if self.geoid_sep is None else self.alt_hae - self.geoid_sep


class Gst(msgspec.Struct, frozen=True, tag="GST", tag_field="class"):
    """Standard deviations, in metres."""

    device: str = ""
    lat: float | None = None
    lon: float | None = None
    alt: float | None = None


class SkyView(msgspec.Struct, frozen=True):
    """One satellite of a SKY."""

    prn: int = msgspec.field(name="PRN", default=0)
    gnssid: int | None = None
    el: float | None = None
    az: float | None = None
    ss: float | None = None
    used: bool = False


class Sky(msgspec.Struct, frozen=True, tag="SKY", tag_field="class"):
    """Satellites and dilutions of precision."""

    device: str = ""
    time: Time | None = None
    seen: int | None = msgspec.field(name="nSat", default=None)
    used: Count | None = msgspec.field(name="uSat", default=None)
    hdop: NonNegative | None = None
    pdop: NonNegative | None = None
    vdop: NonNegative | None = None
    satellites: tuple[SkyView, ...] = ()


class Kind(msgspec.Struct, frozen=True):
    """Which report a line is."""

    name: str = msgspec.field(name="class")


READ = {"TPV", "SKY", "GST"}
KIND = msgspec.json.Decoder(Kind)
DECODER = msgspec.json.Decoder(Tpv | Sky | Gst)


def read_report(line: str) -> Tpv | Sky | Gst | None:
    """A line from gpsd, None for a report of no interest. Raises msgspec.DecodeError."""
    return DECODER.decode(line) if KIND.decode(line).name in READ else None


def time_ns(time: dt.datetime | float) -> int:
    """Unix time."""
    if isinstance(time, float):
        return round(time * 1e6) * 1000
    return (time - UNIX) // dt.timedelta(microseconds=1) * 1000


def horizontal_std_m(gst: Gst) -> float | None:
    """Of one axis, in the mean of both; None where they are no deviations."""
    lat_m, lon_m = gst.lat or 0.0, gst.lon or 0.0
    if not (0.0 < lat_m <= STD_MAX and 0.0 < lon_m <= STD_MAX):
        return None
    return math.sqrt((lat_m**2 + lon_m**2) / 2.0)


def vertical_std_m(gst: Gst) -> float | None:
    """None where it is no deviation."""
    return gst.alt if gst.alt is not None and 0.0 < gst.alt <= STD_MAX else None


def satellite_of(view: SkyView) -> Satellite:
    """As the bus has it."""
    return Satellite(
        system=SYSTEMS.get(view.gnssid) or system_of("", "", view.prn),
        prn=view.prn,
        elevation_deg=view.el if view.el is not None and abs(view.el) <= 90.0 else None,
        azimuth_deg=view.az % 360.0 if view.az is not None else None,
        snr_dbhz=view.ss or None,
        used=view.used,
    )
