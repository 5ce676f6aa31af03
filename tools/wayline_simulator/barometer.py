"""Pure: what a barometer in a vehicle measures."""

from typing import Annotated

from msgspec import Meta

from wayline.toml import Strict

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]


class BarometerModel(Strict, frozen=True, kw_only=True):
    """`[barometer]`"""

    rate_hz: Positive = 2.0
    offset_std_pa: NotNegative = 100.0
    """From one device to the next."""
    wander_std_pa: NotNegative = 10.0
    """Of a first-order Gauss-Markov process: weather, gusts, ventilation."""
    wander_time_s: Positive = 600.0
    noise_pa: NotNegative = 3.0
    resolution_pa: Positive = 10.0
    airflow_coefficient: float = -0.03
    """Share of the dynamic pressure that is felt in the cab."""
    fan_step_pa: NotNegative = 10.0
    """The ventilation changes its stage by steps of this std..."""
    fan_every_s: Positive = 400.0
    """...this often on average."""
    tunnel_pa: NotNegative = 60.0
    """Piston effect: pressure at a tunnel's entrance at 25 m/s, with the square of the speed."""
    jitter_s: NotNegative = 0.005
    temperature_reported: bool = True
