"""Pure: what is known of the vehicle besides the filter's state, by more than one aid."""

from typing import NamedTuple

import msgspec

from wayline.cadence import UNKNOWN_S
from wayline.geo import LocalPlane


class TakenCourse(NamedTuple):
    """The last course that corrected the heading."""

    t_ns: int
    heading_rad: float
    """Where the vehicle's front points, by the course alone."""
    std_rad: float


class Situation(msgspec.Struct, frozen=True):
    """Immutable, so that a rewind only has to take the old one back."""

    plane: LocalPlane | None = None
    heading_known: bool = False
    wheels_ns: int | None = None
    """Of the last wheel speed, believed or not."""
    still_since_ns: int | None = None
    placed_ns: int | None = None
    """When the position was last set to a fix, not corrected with one."""
    accepted_fix_ns: int | None = None
    fix_interval_s: float = UNKNOWN_S
    """Between fixes, as their source usually tells them."""
    way_unknown_ns: int | None = None
    """Of the last fix before which the way there was given up."""
    speed_accepted_ns: int | None = None
    """Of the last speed of a fix that was believed."""
    course: TakenCourse | None = None
    position_unconfirmed: bool = False
    """The position is that of before a restart, and no fix has told since."""
    heading_unconfirmed: bool = False
    """The heading is that of before a restart, and no course has told since."""
