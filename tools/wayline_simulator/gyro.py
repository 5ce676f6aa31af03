"""Pure: what a yaw-rate gyro measures."""

from typing import Annotated

from msgspec import Meta

from wayline.toml import Strict

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]


class GyroModel(Strict, frozen=True, kw_only=True):
    """`[gyro]`: measured = true x (1 + scale) + bias + white noise, in whole steps."""

    rate_hz: Positive = 50.0
    bias_std_degps: NotNegative = 0.5
    """From one switching-on to the next."""
    bias_wander_std_degps: NotNegative = 0.02
    """Of a first-order Gauss-Markov process on top."""
    bias_wander_time_s: Positive = 600.0
    bias_per_kelvin_degps: NotNegative = 0.005
    """Std of the bias's slope with temperature."""
    warm_up_kelvin: float = 8.0
    """The device ends so much warmer than it was switched on."""
    warm_up_time_s: Positive = 600.0
    scale_std: NotNegative = 0.01
    """From one device to the next."""
    noise_deg_per_sqrt_s: NotNegative = 0.01
    """Angle random walk; a sample's std is this times the square root of the rate."""
    resolution_degps: Positive = 0.01
    jitter_s: NotNegative = 0.0005
    """Std of a frame's time around its instant."""
    temperature_reported: bool = True
