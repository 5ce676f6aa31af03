"""Pure: what an engine says of its torque, and the slope that a truck makes of it."""

from typing import Annotated

from msgspec import Meta

from wayline.toml import Strict

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]


class TorqueModel(Strict, frozen=True, kw_only=True):
    """`[torque]`: estimated from the fuel injected, in whole percents of the reference torque."""

    rate_hz: Positive = 10.0
    gain_std: NotNegative = 0.02
    """From one engine to the next."""
    gain_wander_std: NotNegative = 0.01
    gain_wander_time_s: Positive = 300.0
    offset_std_pct: NotNegative = 0.5
    """Accessories that the unit does not know, in percent of the reference torque."""
    noise_pct: NotNegative = 0.5
    resolution_pct: Positive = 1.0
    latency_s: NotNegative = 0.05
    jitter_s: NotNegative = 0.002
    mass_error_std: NotNegative = 0.03
    """Share by which the mass in drive.toml is off."""
    slope_reported: bool = False
    """The vehicle reports a slope of its own (papers/004), +13 % while braking."""
