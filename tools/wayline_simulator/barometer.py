"""Pure: what a barometer in a vehicle measures."""

from typing import Annotated, NamedTuple

import numpy as np
from msgspec import Meta
from scipy.signal import lfilter

from wayline.air import EXPONENT, SCALE_M
from wayline.strict import Strict
from wayline_simulator.course import Surroundings
from wayline_simulator.journey import Floats, Journey, Truth
from wayline_simulator.noise import gauss_markov, in_steps, random_steps
from wayline_simulator.sampling import frame_times, instants
from wayline_simulator.weather import Weather

Positive = Annotated[float, Meta(gt=0.0)]
NotNegative = Annotated[float, Meta(ge=0.0)]

KELVIN = 273.15
STANDARD_KELVIN = 288.15
LAPSE_KELVIN_PER_M = 0.0065
"""Lapse rate of the standard atmosphere (ISO 2533)."""
GAS_CONSTANT = 287.053
"""Of dry air, J/(kg K) (ISO 2533)."""
TUNNEL_MPS = 25.0
"""Speed at which `tunnel_pa` is felt."""
TUNNEL_FADE_S = 4.0
"""In which a tunnel's pressure step falls to a third; judgement: cabins are let through to the
outside air by their ventilation."""
TEMPERATURE_STEP_C = 1.0


class BarometerModel(Strict, frozen=True, kw_only=True):
    """`[barometer]`"""

    rate_hz: Positive = 2.0
    """Judgement; papers/004 has 1 Hz, OBD-II what it is asked for."""
    offset_std_pa: NotNegative = 100.0
    """From one device to the next; the BMP280's data sheet has an absolute accuracy of 100 Pa."""
    wander_std_pa: NotNegative = 10.0
    """Of a first-order Gauss-Markov process: weather, gusts, ventilation; judgement."""
    wander_time_s: Positive = 600.0
    """Judgement."""
    noise_pa: NotNegative = 3.0
    """White; the device's own is near 1 (BMP280), the road and the wind add to it: judgement."""
    buffeting_share: NotNegative = 0.0
    """White, too, its std as a share of the dynamic pressure: the flow round a cab with a window
    ajar; judgement. 0 for a device that is tucked away."""
    resolution_pa: Positive = 10.0
    """Judgement; 50 in papers/004, 1000 in OBD-II (SAE J1979, PID 33h)."""
    airflow_coefficient: float = -0.03
    """Share of the dynamic pressure that is felt in the cab; judgement: cabs are sucked a little
    by the flow over their vents."""
    fan_step_pa: NotNegative = 10.0
    """The ventilation changes its stage by steps of this std; judgement, papers/004 section 3.2
    names the effect without a figure."""
    fan_every_s: Positive = 400.0
    """Mean time between two changes of the ventilation's stage; judgement."""
    tunnel_pa: NotNegative = 60.0
    """Piston effect: pressure at a tunnel's entrance at 25 m/s, with the square of the speed, and
    the same suction at its exit; judgement: a sixth of the dynamic pressure."""
    jitter_s: NotNegative = 0.005
    """Std of a frame's time around its instant; judgement for a slow message."""
    temperature_reported: bool = True
    """Of the air, beside the pressure."""


class BarometerSamples(NamedTuple):
    """One frame each, shape (n,)."""

    times_s: Floats
    """When the frames came, from the drive's start; never decreases."""
    instants_s: Floats
    """When the pressure was so."""
    pressures_pa: Floats
    temperatures_c: Floats
    """Of the air outside."""


def measure(
    journey: Journey,
    model: BarometerModel,
    weather: Weather,
    *,
    device: np.random.Generator,
    random: np.random.Generator,
) -> BarometerSamples:
    """Air pressure over a drive. From `device` comes what stays from one drive to the next."""
    offset_pa = model.offset_std_pa * device.standard_normal()
    instants_s = instants(journey.duration_s, model.rate_hz, random)
    truth = journey.at(instants_s)
    temperatures_c = air_temperature_c(truth.alts_m, float(journey.course.alts_m[0]), weather)
    outside_pa = air_pressure_pa(truth.alts_m, float(journey.course.alts_m[0]), weather)
    flow_pa = dynamic_pressure_pa(truth, outside_pa, weather)
    white_pa = np.hypot(model.noise_pa, model.buffeting_share * flow_pa)
    pressures_pa = (
        outside_pa
        + offset_pa
        + weather.pressure_trend_pa_per_h * instants_s / 3600.0
        + model.airflow_coefficient * flow_pa
        + tunnel_pressure_pa(truth, model)
        + _disturbances_pa(instants_s, model, random)
        + white_pa * random.standard_normal(len(instants_s))
    )
    return BarometerSamples(
        times_s=frame_times(instants_s, model.jitter_s, random),
        instants_s=instants_s,
        pressures_pa=in_steps(pressures_pa, model.resolution_pa),
        temperatures_c=in_steps(temperatures_c, TEMPERATURE_STEP_C),
    )


def air_temperature_c(alts_m: Floats, start_alt_m: float, weather: Weather) -> Floats:
    """The weather's at the drive's start, and the standard lapse from there."""
    return weather.temperature_c - LAPSE_KELVIN_PER_M * (alts_m - start_alt_m)


def air_pressure_pa(alts_m: Floats, start_alt_m: float, weather: Weather) -> Floats:
    """Of the atmosphere that the weather makes of the standard one.

    Colder air is denser and shrinks the heights between two pressures in proportion, so that a
    reader of the standard atmosphere errs by 1 % of a climb at 12 degrees.
    """
    sea_level_kelvin = KELVIN + weather.temperature_c + LAPSE_KELVIN_PER_M * start_alt_m
    scale_m = SCALE_M * sea_level_kelvin / STANDARD_KELVIN
    pressures_pa: Floats = weather.sea_level_pa * (1.0 - alts_m / scale_m) ** (1.0 / EXPONENT)
    return pressures_pa


def dynamic_pressure_pa(truth: Truth, outside_pa: Floats, weather: Weather) -> Floats:
    """Of the flow that the vehicle meets, the mean wind included."""
    courses_rad = np.radians(truth.courses_deg)
    from_rad = np.radians(weather.wind_from_deg)
    speeds_mps = np.abs(truth.speeds_mps)
    east_mps = speeds_mps * np.sin(courses_rad) + weather.wind_mps * np.sin(from_rad)
    north_mps = speeds_mps * np.cos(courses_rad) + weather.wind_mps * np.cos(from_rad)
    density_kg_per_m3 = outside_pa / (GAS_CONSTANT * (KELVIN + weather.temperature_c))
    pressures_pa: Floats = 0.5 * density_kg_per_m3 * (east_mps**2 + north_mps**2)
    return pressures_pa


def tunnel_pressure_pa(truth: Truth, model: BarometerModel) -> Floats:
    """A step at every entrance, one down at every exit, both fading."""
    inside = (truth.surroundings == Surroundings.TUNNEL).astype(np.float64)
    entered = np.diff(inside, prepend=inside[:1])
    steps_pa = entered * model.tunnel_pa * (truth.speeds_mps / TUNNEL_MPS) ** 2
    kept = np.exp(-1.0 / (model.rate_hz * TUNNEL_FADE_S))
    pressures_pa: Floats = lfilter([1.0], [1.0, -kept], steps_pa)
    return pressures_pa


def _disturbances_pa(
    instants_s: Floats, model: BarometerModel, random: np.random.Generator
) -> Floats:
    """What nothing else explains: slow wander and the fan's stages."""
    count = len(instants_s)
    wander_pa = gauss_markov(
        count, 1.0 / model.rate_hz, model.wander_std_pa, model.wander_time_s, random
    )
    fan_pa = random_steps(instants_s, model.fan_step_pa, model.fan_every_s, random)
    return wander_pa + fan_pa
