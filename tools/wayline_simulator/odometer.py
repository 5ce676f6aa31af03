"""Pure: what wheel sensors measure."""

from typing import Annotated, Literal

from msgspec import Meta

from wayline.toml import Strict

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]


class OdometerModel(Strict, frozen=True, kw_only=True):
    """`[odometer]`: wheel rate x nominal radius x (1 + scale) + noise, in whole steps."""

    rate_hz: Positive = 10.0
    scale_std: NotNegative = 0.02
    """Wear and the maker's choice, from one vehicle to the next."""
    scale_wander_std: NotNegative = 0.001
    """Of a first-order Gauss-Markov process on top."""
    scale_wander_time_s: Positive = 1200.0
    noise_mps: NotNegative = 0.02
    resolution_mps: Positive = 0.01
    dead_zone_mps: NotNegative = 0.3
    """Slower reads 0."""
    latency_s: NotNegative = 0.02
    """A frame's speed is this old."""
    jitter_s: NotNegative = 0.001
    counter_resolution_m: Positive | None = 0.05
    """Of a cumulative distance beside the speed; None: the bus has none."""
    counter_bits: Literal[16, 32] = 16
    reverse_reported: bool = True
