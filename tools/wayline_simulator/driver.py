"""Pure: who drives, and how one run differs from the next."""

import math
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta

from wayline.strict import Strict

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]


class DriverModel(Strict, frozen=True, kw_only=True):
    """`[driver]`; accelerations are those of a car, heavier vehicles use a share of them."""

    pace: Annotated[float, Meta(gt=0.2, le=1.5)] = 0.97
    """Of the speed limits; judgement: a speedometer shows a little more than there is."""
    pace_std: NotNegative = 0.04
    """From run to run; judgement."""
    style_std: NotNegative = 0.12
    """From run to run, of the logarithm of all accelerations; judgement."""
    lateral_mps2: Positive = 2.2
    """Acceleration in bends; drivers stay below some 2 to 3 (comfort, not grip); judgement."""
    acceleration_mps2: Positive = 1.6
    """From rest; falls with speed. Judgement: half a minute to 100 km/h."""
    braking_mps2: Positive = 1.5
    """Comfortable; highway design reckons with 3.4 as what nearly all drivers can (AASHTO Green
    Book, stopping sight distance), a planned stop takes less than half. Judgement."""
    jerk_mps3: Positive = 1.5
    """Of a foot on a pedal; judgement."""
    dwell_spread: NotNegative = 0.3
    """Std of the logarithm of the time at a stop; judgement."""
    red_probability: Share = 0.45
    """That a light is red; judgement."""
    wander_std: NotNegative = 0.025
    """Of the speed that a driver keeps, as a share; judgement."""
    wander_length_m: Positive = 600.0
    """Over which it changes; judgement."""
    traffic_density: Share = 0.15
    """0 an empty road, 1 a crowded one: slow-downs and queues grow with it."""
    wait_start_s: NotNegative = 20.0
    """Time of standing with the engine idling before the drive."""
    wait_end_s: NotNegative = 10.0
    """Time of standing with the engine idling after the drive."""
    reverse_mps: Positive = 2.0
    """Backwards not faster; judgement."""
    spin_probability: Share = 0.01
    """That the driven wheels spin at a launch; 0.2 on snow. Judgement."""
    lock_probability: Share = 0.01
    """That wheels lock for a moment in a braking; 0.2 on snow. Judgement."""


def drawn(driver: DriverModel, random: np.random.Generator) -> DriverModel:
    """The driver of one run: pace and style of the day."""
    pace, style = random.standard_normal(2)
    lively = math.exp(driver.style_std * style)
    return msgspec.structs.replace(
        driver,
        pace=min(max(driver.pace + driver.pace_std * pace, 0.5), 1.3),
        lateral_mps2=driver.lateral_mps2 * lively,
        acceleration_mps2=driver.acceleration_mps2 * lively,
        braking_mps2=driver.braking_mps2 * lively,
    )
