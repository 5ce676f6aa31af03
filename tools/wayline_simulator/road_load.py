"""Pure: what road and air do to a vehicle, for each half metre of a course."""

from typing import NamedTuple

import numpy as np

from wayline_simulator.barometer import (
    GAS_CONSTANT,
    KELVIN,
    air_pressure_pa,
    air_temperature_c,
)
from wayline_simulator.course import STEP_M, Course, Floats, Surroundings
from wayline_simulator.noise import gauss_markov
from wayline_simulator.vehicle import VehicleModel
from wayline_simulator.weather import Weather

GRAVITY_MPS2 = 9.81
GUST_SHARE = 0.3
"""Std of the gusts, as a share of the mean wind: near the ground the intensity of turbulence over
open country is 0.2 to 0.3 at 2 m; judgement within."""
GUST_LENGTH_M = 80.0
"""Over which a gust lasts for a vehicle that drives into it (Taylor's frozen turbulence);
judgement."""


class RoadLoad(NamedTuple):
    """Per half metre, from each sample to the next; plain lists, which a loop reads fastest."""

    slope_n: list[float]
    """Weight along the road, positive where it holds the vehicle back."""
    rolling_n: list[float]
    air_n_per_mps2: list[float]
    """Air resistance over the square of the relative wind."""
    headwind_mps: list[float]
    level_share: list[float]
    """Horizontal metres for a metre along the surface."""


def road_load(
    course: Course,
    vehicle: VehicleModel,
    weather: Weather,
    random: np.random.Generator,
    masses_kg: Floats,
) -> RoadLoad:
    """Forces on a vehicle that drives the course in its direction of travel.

    `masses_kg` at each of the course's samples, shape (n,).
    """
    signs = np.where(course.backwards[:-1], -1.0, 1.0)
    grade = signs * _between(course.grade)
    level_share = 1.0 / np.sqrt(1.0 + grade**2)
    # from a sample on the load is that of the next: it changes while the vehicle stands there
    weight_n = masses_kg[1:] * GRAVITY_MPS2
    area_m2 = vehicle.frontal_area_m2 * vehicle.drag_coefficient
    return RoadLoad(
        slope_n=(weight_n * grade * level_share).tolist(),
        rolling_n=(weight_n * vehicle.rolling_coefficient * level_share).tolist(),
        air_n_per_mps2=(0.5 * _density_kg_per_m3(course, weather) * area_m2).tolist(),
        headwind_mps=_headwind_mps(course, signs, weather, random).tolist(),
        level_share=level_share.tolist(),
    )


def _between(values: Floats) -> Floats:
    middle: Floats = (values[:-1] + values[1:]) / 2.0
    return middle


def _density_kg_per_m3(course: Course, weather: Weather) -> Floats:
    alts_m, start_alt_m = _between(course.alts_m), float(course.alts_m[0])
    kelvin = KELVIN + air_temperature_c(alts_m, start_alt_m, weather)
    density: Floats = air_pressure_pa(alts_m, start_alt_m, weather) / (GAS_CONSTANT * kelvin)
    return density


def _headwind_mps(
    course: Course, signs: Floats, weather: Weather, random: np.random.Generator
) -> Floats:
    """Mean wind along the direction of travel and gusts; none under cover."""
    angle_rad = np.radians(weather.wind_from_deg) - _between(course.headings_rad)
    gusts = gauss_markov(len(signs), STEP_M, GUST_SHARE, GUST_LENGTH_M, random)
    covered = course.surroundings[:-1] > Surroundings.BRIDGE
    return np.where(covered, 0.0, signs * weather.wind_mps * (np.cos(angle_rad) + gusts))
