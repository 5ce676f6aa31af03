"""The day that a drive is made on."""

from typing import Annotated

from msgspec import Meta

from wayline.toml import Strict

NotNegative = Annotated[float, Meta(ge=0.0)]


class Weather(Strict, frozen=True, kw_only=True):
    """`[weather]`"""

    wind_mps: NotNegative = 3.0
    """Mean, at the vehicle's height; the driver's run adds gusts."""
    wind_from_deg: float = 240.0
    temperature_c: float = 12.0
    """Of the air, at the start."""
    sea_level_pa: Annotated[float, Meta(ge=87_000.0, le=108_500.0)] = 101_325.0
    """Air pressure reduced to sea level, at the start."""
    pressure_trend_pa_per_h: float = 0.0
    """A front passing changes it by 100 to 300."""
