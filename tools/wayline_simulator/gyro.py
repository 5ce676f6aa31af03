"""Pure: what a yaw-rate gyro measures."""

from typing import Annotated, NamedTuple

import numpy as np
from msgspec import Meta

from wayline.strict import Strict
from wayline_simulator.journey import Floats, Journey
from wayline_simulator.noise import gauss_markov, in_steps
from wayline_simulator.sampling import frame_times, instants
from wayline_simulator.weather import Weather

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]

TEMPERATURE_STEP_C = 1.0
"""What automotive buses give a temperature in (SAE J1939-71)."""


class GyroModel(Strict, frozen=True, kw_only=True):
    """`[gyro]`: measured = true x (1 + scale) + bias + noise, in whole steps."""

    rate_hz: Positive = 50.0
    """Stability control asks for 50 to 100; judgement."""
    bias_degps: float = 0.0
    """Where the bias of this very device is known."""
    bias_std_degps: NotNegative = 0.5
    """From one switching-on to the next; judgement for a device trimmed at the factory (an
    untrimmed MPU-6050 may be off by 20, says its data sheet)."""
    bias_wander_std_degps: NotNegative = 0.02
    """Of a first-order Gauss-Markov process on top; judgement for an automotive MEMS."""
    bias_wander_time_s: Positive = 600.0
    """Judgement: Allan deviations of such devices are flat from about 100 s to 1000 s."""
    bias_per_kelvin_degps: NotNegative = 0.005
    """Std of the bias's slope with temperature; judgement, what is left of a compensation."""
    warm_up_kelvin: float = 8.0
    """The device ends so much warmer than it was switched on; judgement for a closed box."""
    warm_up_time_s: Positive = 600.0
    """Time constant of that; judgement."""
    scale_std: NotNegative = 0.01
    """From one device to the next; the MPU-6050's data sheet has a tolerance of 3 %, taken as
    three sigma."""
    noise_deg_per_sqrt_s: NotNegative = 0.01
    """Angle random walk; a sample's std is this times the square root of the rate. The MPU-6050's
    0.005 deg/s/sqrt(Hz) is 0.0035 here (a density of positive frequencies only); three times that
    for the vibrations of a vehicle is a judgement."""
    vibration_degps: NotNegative = 0.0
    """Std of a sample while the vehicle moves, on top: a road shakes a box. White, as it is faster
    than the frames; it carries a coarse gyro over its steps, so that their error averages out."""
    resolution_degps: Positive = 0.01
    """One bit; judgement."""
    latency_s: NotNegative = 0.01
    """A frame's rate is this old: the delay of the device's own low-pass of some 20 Hz."""
    jitter_s: NotNegative = 0.0005
    """Std of a frame's time around its instant: two or three frames of 8 bytes at 500 kbit/s."""
    temperature_reported: bool = True
    """Beside the rate."""


class GyroSamples(NamedTuple):
    """One frame each, shape (n,)."""

    times_s: Floats
    """When the frames came, from the drive's start; never decreases."""
    instants_s: Floats
    """When the rates were measured."""
    yaw_rates_degps: Floats
    """Positive turning right."""
    temperatures_c: Floats
    """Of the device."""


def measure(
    journey: Journey,
    model: GyroModel,
    weather: Weather,
    *,
    device: np.random.Generator,
    random: np.random.Generator,
) -> GyroSamples:
    """Yaw rate over a drive. From `device` comes what stays from one drive to the next."""
    scale = 1.0 + model.scale_std * device.standard_normal()
    per_kelvin_degps = model.bias_per_kelvin_degps * device.standard_normal()
    grid_s = instants(journey.duration_s, model.rate_hz, random)
    instants_s = grid_s - model.latency_s
    warmed_kelvin = model.warm_up_kelvin * -np.expm1(-grid_s / model.warm_up_time_s)
    errors_degps = _errors(model, len(grid_s), random) + per_kelvin_degps * warmed_kelvin
    moving = journey.at(instants_s)
    rates_degps = moving.yaw_rates_degps * scale + errors_degps
    times_s = frame_times(grid_s, model.jitter_s, random)
    # drawn last: models without it keep the numbers that they had
    shaken_degps = model.vibration_degps * random.standard_normal(len(grid_s))
    rates_degps += np.where(moving.speeds_mps > 0.0, shaken_degps, 0.0)
    return GyroSamples(
        times_s=times_s,
        instants_s=instants_s,
        yaw_rates_degps=in_steps(rates_degps, model.resolution_degps),
        temperatures_c=in_steps(weather.temperature_c + warmed_kelvin, TEMPERATURE_STEP_C),
    )


def _errors(model: GyroModel, count: int, random: np.random.Generator) -> Floats:
    """Bias of this switching-on, its wander, and white noise."""
    bias_degps = model.bias_degps + model.bias_std_degps * random.standard_normal()
    wander_degps = gauss_markov(
        count,
        1.0 / model.rate_hz,
        model.bias_wander_std_degps,
        model.bias_wander_time_s,
        random,
    )
    noise_degps = model.noise_deg_per_sqrt_s * np.sqrt(model.rate_hz)
    white_degps = noise_degps * random.standard_normal(count)
    errors_degps: Floats = bias_degps + wander_degps + white_degps
    return errors_degps
