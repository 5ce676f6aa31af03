"""Pure: the standard ellipse of a horizontal position error."""

import math

import msgspec

from wayline.messages import Pose


class Ellipse(msgspec.Struct, frozen=True):
    """One sigma along its two axes; the major axis points `orientation_deg` from north."""

    semi_major_m: float
    semi_minor_m: float
    orientation_deg: float
    """Clockwise from north, 0 <= x < 180."""


def standard_ellipse(east_std_m: float, north_std_m: float, east_north_cov_m2: float) -> Ellipse:
    """Principal axes of a 2 by 2 covariance, by its closed-form eigenvalues.

    A covariance that is not one (|cov| > product of the stds) gives a minor axis of 0.
    """
    east_m2, north_m2 = east_std_m**2, north_std_m**2
    mean_m2 = (east_m2 + north_m2) / 2.0
    spread_m2 = math.hypot((east_m2 - north_m2) / 2.0, east_north_cov_m2)
    twice_rad = math.atan2(2.0 * east_north_cov_m2, north_m2 - east_m2)
    return Ellipse(
        math.sqrt(mean_m2 + spread_m2),
        math.sqrt(max(mean_m2 - spread_m2, 0.0)),
        math.degrees(twice_rad / 2.0) % 180.0,
    )


def ellipse_of(pose: Pose) -> Ellipse | None:
    """The ellipse that a pose claims, or None where it claims none."""
    if pose.east_std_m is None or pose.north_std_m is None:
        return None
    return standard_ellipse(pose.east_std_m, pose.north_std_m, pose.east_north_cov_m2 or 0.0)
