"""Pure: what a machine listens to: receivers and buses as the configuration names them."""

from typing import Annotated

from msgspec import Meta

from wayline.drive import CanMapping
from wayline.strict import Strict


class LiveNmea(Strict, frozen=True, kw_only=True):
    """`[[nmea]]`: a receiver."""

    url: Annotated[str, Meta(pattern=r"^(serial|tcp|udp|gpsd)://")]
    """serial:///dev/ttyUSB0, tcp://host:port, udp://:port or gpsd://host:2947"""
    baud: Annotated[int, Meta(gt=0)] | None = None
    """Of a serial line; found by itself where it is not given."""


class LiveCan(CanMapping, frozen=True, kw_only=True):
    """`[[can]]`: a bus, by python-can's names of interface and channel."""

    interface: str
    channel: str | int
    bitrate: Annotated[int, Meta(gt=0)] | None = None
    options: dict[str, str | int | float | bool] = {}
    """What else python-can's interface takes, by its own names."""
    obd2: bool | None = None
    """Ask a car for its values over ISO-TP; by default where `vehicle.profile` is obd2."""
