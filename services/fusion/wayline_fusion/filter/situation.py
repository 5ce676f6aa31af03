"""Pure: what is known of the vehicle besides the filter's state, by more than one aid."""

import math
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.cadence import UNKNOWN_S
from wayline.geo import LocalPlane
from wayline_fusion.filter.states import Floats


class TakenCourse(NamedTuple):
    """The last course that corrected the heading."""

    t_ns: int
    heading_rad: float
    """Where the vehicle's front points, by the course alone."""
    std_rad: float


class Velocity(NamedTuple):
    """How the vehicle moved."""

    speed_mps: float
    speed_std_mps: float
    heading_rad: float
    heading_std_rad: float

    @property
    def vector_mps(self) -> Floats:
        """East and north."""
        return self.speed_mps * direction(self.heading_rad)

    def covariance_m2ps2(self) -> Floats:
        """Of east and north."""
        along = direction(self.heading_rad)
        across_mps = self.speed_mps * min(self.heading_std_rad, 1.0)
        aside = np.eye(2) - np.outer(along, along)
        return self.speed_std_mps**2 * np.outer(along, along) + across_mps**2 * aside


def direction(heading_rad: float) -> Floats:
    """East and north of a step of 1 m."""
    return np.array([math.sin(heading_rad), math.cos(heading_rad)])


class Waypoint(NamedTuple):
    """Where the vehicle was at a fix, and how it moved there."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    covariance: Floats
    """Of east and north and the fixes' slow errors, shape (4, 4)."""
    velocity: Velocity


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
    ranged_ns: int | None = None
    """When a satellite's range corrected last."""
    fix_interval_s: float = UNKNOWN_S
    """Between fixes, as their source usually tells them."""
    way_unknown_ns: int | None = None
    """Of the last fix before which the way there was given up."""
    speed_accepted_ns: int | None = None
    """Of the last speed of a fix that was believed."""
    course: TakenCourse | None = None
    waypoint: Waypoint | None = None
    """The last fix that told speed and course."""
    position_unconfirmed: bool = False
    """The position is that of before a restart, and no fix has told since."""
    heading_unconfirmed: bool = False
    """The heading is that of before a restart, and no course has told since."""
