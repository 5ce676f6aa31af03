"""Pure: the day that a drive is made on."""

from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta

from wayline.strict import Strict

NotNegative = Annotated[float, Meta(ge=0.0)]
LOWEST_PA, HIGHEST_PA = 95_000.0, 105_500.0
"""Storms and winter highs of temperate latitudes."""


class Weather(Strict, frozen=True, kw_only=True):
    """`[weather]`: what days have in common; each run draws its own."""

    wind_mps: NotNegative = 3.0
    """Mean, at the vehicle's height; gusts come on top."""
    wind_std_mps: NotNegative = 1.5
    """From day to day."""
    wind_from_deg: float = 240.0
    wind_from_std_deg: NotNegative = 60.0
    temperature_c: float = 12.0
    """Of the air, at the start."""
    temperature_std_c: NotNegative = 6.0
    sea_level_pa: Annotated[float, Meta(ge=LOWEST_PA, le=HIGHEST_PA)] = 101_325.0
    """Air pressure reduced to sea level, at the start."""
    sea_level_std_pa: NotNegative = 800.0
    """From day to day; judgement."""
    pressure_trend_pa_per_h: float = 0.0
    pressure_trend_std_pa_per_h: NotNegative = 40.0
    """Most days; a front that passes changes it by 100 to 300. Judgement."""


def drawn(weather: Weather, random: np.random.Generator) -> Weather:
    """One day of this weather."""
    wind_mps, temperature, pressure, trend, wind_from = random.standard_normal(5).tolist()
    sea_level_pa = weather.sea_level_pa + weather.sea_level_std_pa * pressure
    return msgspec.structs.replace(
        weather,
        wind_mps=max(weather.wind_mps + weather.wind_std_mps * wind_mps, 0.0),
        wind_from_deg=(weather.wind_from_deg + weather.wind_from_std_deg * wind_from) % 360.0,
        temperature_c=weather.temperature_c + weather.temperature_std_c * temperature,
        sea_level_pa=min(max(sea_level_pa, LOWEST_PA), HIGHEST_PA),
        pressure_trend_pa_per_h=weather.pressure_trend_pa_per_h
        + weather.pressure_trend_std_pa_per_h * trend,
    )
