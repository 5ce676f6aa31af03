"""Pure: what a machine listens to: receivers and buses as the configuration names them."""

from typing import Annotated, Literal

from msgspec import Meta

from wayline.drive import CanMapping
from wayline.strict import Strict


class LiveNmea(Strict, frozen=True, kw_only=True):
    """`[[nmea]]`: a receiver."""

    url: Annotated[str, Meta(pattern=r"^(serial|tcp|udp|gpsd)://")]
    """serial:///dev/ttyUSB0, tcp://host:port, udp://:port or gpsd://host:2947"""
    baud: Annotated[int, Meta(gt=0)] | None = None
    """Of a serial line; found by itself where it is not given."""


class LiveRaw(Strict, frozen=True, kw_only=True):
    """`[[raw]]`: a u-blox receiver that sends RXM-RAWX and RXM-SFRBX."""

    url: Annotated[str, Meta(pattern=r"^(serial|tcp|udp)://")]
    """serial:///dev/ttyACM0, tcp://host:port or udp://:port"""
    baud: Annotated[int, Meta(gt=0)] | None = None
    """Of a serial line; found by itself where it is not given."""
    format: Literal["ubx"] = "ubx"
    """The only one that is heard live."""
    nav: str | tuple[str, ...] = ()
    """RINEX navigation files, in place of what the receiver hears; relative to this file."""

    @property
    def navs(self) -> tuple[str, ...]:
        """None, one or several."""
        return (self.nav,) if isinstance(self.nav, str) else self.nav


class LiveAvl(Strict, frozen=True, kw_only=True):
    """`[[avl]]`: the vehicles of an agency, as GTFS-Realtime vehicle positions."""

    url: Annotated[str, Meta(pattern=r"^https?://")]
    every_s: Annotated[float, Meta(ge=1.0, le=3600.0)] = 15.0
    """Between two looks; agencies say what they allow."""
    api_key_env: str | None = None
    """The environment variable that holds the key; a key has no place in a file."""
    api_key_header: str | None = None
    """The header that takes it..."""
    api_key_parameter: str | None = None
    """...or the parameter of the address."""


class LiveCan(CanMapping, frozen=True, kw_only=True):
    """`[[can]]`: a bus, by python-can's names of interface and channel."""

    interface: str
    channel: str | int
    bitrate: Annotated[int, Meta(gt=0)] | None = None
    options: dict[str, str | int | float | bool] = {}
    """What else python-can's interface takes, by its own names."""
    obd2: bool | None = None
    """Ask a car for its values over ISO-TP; by default where `vehicle.profile` is obd2."""
