"""Pure: what the air adds to pseudoranges, as whoever takes it out asks of a model."""

from typing import NamedTuple, Protocol

L1_HZ = 1_575.42e6
"""Of signals whose frequency is not told."""


class SignalPath(NamedTuple):
    """A signal's way to a receiver."""

    t_ns: int
    """Unix time."""
    lat_deg: float
    lon_deg: float
    height_m: float
    """Above the ellipsoid."""
    elevation_deg: float
    azimuth_deg: float
    carrier_hz: float = L1_HZ


class Air(Protocol):
    """A model of the ionosphere and the troposphere."""

    def delay_m(self, path: SignalPath) -> float:
        """By how much a pseudorange that came along a path is too long."""
        ...
