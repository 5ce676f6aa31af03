"""Pure: an epoch of raw measurements on its way to the bus."""

import msgspec

from wayline.messages import RawSatellite


class RawEpoch(msgspec.Struct, frozen=True, kw_only=True):
    """What a receiver measured at one instant."""

    t_ns: int
    """Unix time, by the receiver."""
    satellites: tuple[RawSatellite, ...]
    received_ns: int | None = None
    """By the host's clock; None of a recorded one."""
    clock_reset: bool = False
    """The receiver says that it has set its clock since the last epoch."""
