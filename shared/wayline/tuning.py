"""Pure: every tunable of the estimators, with unit and reason, overridable by `[tuning]`."""

from typing import Annotated, Literal

from msgspec import Meta

from wayline.toml import Strict

Positive = Annotated[float, Meta(gt=0.0)]


class Tuning(Strict, frozen=True, kw_only=True):
    """Defaults suit a car with a consumer receiver, wheel speed and a MEMS gyro."""

    # what a fix is worth
    good_satellites_min: int = 4
    """Fewer is a bad fix (papers/003)."""
    good_pdop_max: Positive = 8.0
    """More is a bad fix (papers/003)."""
    bad_gps_factor: Positive = 10.0
    """A bad fix's stds are this much larger; papers/003 all but ignores it."""
    gps_range_std_m: Positive = 3.0
    """User-equivalent range error: a std is this times the dilution of precision."""
    gps_position_std_m: Positive = 4.0
    """Per axis, for a receiver that reports neither std nor HDOP."""
    gps_position_std_floor_m: Positive = 1.5
    """Receivers claim less than they deliver."""
    gps_vertical_factor: Positive = 2.0
    """Altitude is this much worse than a horizontal axis where nothing else is known."""
    gps_altitude_std_floor_m: Positive = 3.0
    """Altitude errors wander; smaller claims would follow them."""

    # eta
    route_filter: Literal["default", "avl"] = "default"
    """`avl` is the published filter of papers/000, kept as a reference."""
