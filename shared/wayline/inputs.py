"""Pure: what reaches a core but never travels on the bus."""

import msgspec


class Tick(msgspec.Struct, frozen=True):
    """Measurement time has reached an instant of the grid (SPEC section 2)."""

    t_ns: int
    age_ns: int = 0
    """How old the newest message was when it came, by the host's clock (0 in a replay): so much
    more than by `t_ns` everything is."""


class Flush(msgspec.Struct, frozen=True):
    """Input has ended: finish what is open (an epoch, a run)."""

    t_ns: int


class Sentence(msgspec.Struct, frozen=True):
    """A line from an NMEA 0183 receiver, as it came, line end removed.

    `arrival_ns` is when it was received; None in a log without times.
    """

    received_ns: int | None
    text: str


class Frame(msgspec.Struct, frozen=True, gc=False):
    """A raw CAN frame. `t_ns` is the logger's or interface's time, on its own clock."""

    t_ns: int
    channel: str
    arbitration_id: int
    extended: bool
    data: bytes


class PositionReport(msgspec.Struct, frozen=True):
    """A row of a transit system's position reports (AVL), parsed, not yet checked for ranges."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    heading_deg: float | None = None
    speed_mps: float | None = None
    satellites: float | None = None
    hdop: float | None = None
    pdop: float | None = None
    assignment: str | None = None
    received_ns: int | None = None
    """By the host's clock; None of a recorded one."""
