"""Pure: every tunable of the estimators, with unit and reason, overridable by `[tuning]`."""

from typing import Annotated, Literal

from msgspec import Meta

from wayline.toml import Strict

Positive = Annotated[float, Meta(gt=0.0)]


class Tuning(Strict, frozen=True, kw_only=True):
    """Defaults suit a car with a consumer receiver, wheel speed and a MEMS gyro."""

    # eta
    route_filter: Literal["default", "avl"] = "default"
    """`avl` is the published filter of papers/000, kept as a reference."""
