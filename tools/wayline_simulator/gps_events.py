"""Pure: what befalls a receiver by schedule."""

from typing import Annotated

from msgspec import Meta

from wayline.strict import Strict

NotNegative = Annotated[float, Meta(ge=0.0)]
Positive = Annotated[float, Meta(gt=0.0)]


class Outage(Strict, frozen=True, kw_only=True):
    """`[[events.outages]]`: no satellites, whatever the surroundings."""

    start_s: NotNegative
    length_s: Positive
    every_s: Positive | None = None
    """Comes again this often until the end of the drive."""


class DisplacedFixes(Strict, frozen=True, kw_only=True):
    """`[[events.displacements]]`: fixes that agree with each other and are all wrong."""

    start_s: NotNegative
    length_s: Positive
    """1 s is one fix of a 1 Hz receiver."""
    east_m: float = 0.0
    north_m: float = 0.0
    every_s: Positive | None = None


class GpsEvents(Strict, frozen=True, kw_only=True):
    """`[events]`; seconds count from the start of the drive."""

    outages: tuple[Outage, ...] = ()
    displacements: tuple[DisplacedFixes, ...] = ()
