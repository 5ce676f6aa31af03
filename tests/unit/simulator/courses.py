"""Small courses, and vehicles that drive along them."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from wayline_simulator.course import STEP_M, Course, Floats, Halt, Surroundings, lay_course
from wayline_simulator.driver import DriverModel
from wayline_simulator.driving import drive
from wayline_simulator.journey import Journey, Motion
from wayline_simulator.vehicle import VEHICLES
from wayline_simulator.weather import Weather

CALM = Weather(wind_mps=0.0)
STEADY = DriverModel(
    pace=1.0,
    wander_std=0.0,
    traffic_density=0.0,
    spin_probability=0.0,
    lock_probability=0.0,
    dwell_spread=0.0,
)
HALTS = (Halt(700.0, "stop", 20.0), Halt(2500.0, "stop", 15.0), Halt(2503.0, "stop", 5.0))


def laid(
    grade: Floats,
    *,
    limit_mps: float | Floats = 22.0,
    curvature_per_m: float | Floats = 0.0,
    halts: Sequence[Halt] = (),
    backwards: Floats | None = None,
) -> Course:
    """A course of given grades; what is one number holds all along."""
    count = len(grade)
    return lay_course(
        lat_deg=48.0,
        lon_deg=11.0,
        heading_deg=30.0,
        alt_m=400.0,
        curvature_per_m=np.broadcast_to(np.asarray(curvature_per_m), (count,)),
        grade=grade,
        limits_mps=np.broadcast_to(np.asarray(limit_mps), (count,)),
        surroundings=np.full(count, Surroundings.OPEN, dtype=np.int8),
        backwards=None if backwards is None else backwards.astype(np.bool_),
        halts=halts,
    )


def level(length_m: float) -> Floats:
    """No grade."""
    return np.zeros(round(length_m / STEP_M) + 1)


def hills(length_m: float, steepest: float = 0.05) -> Floats:
    """Waves of 2 km with a level start and end."""
    distances_m = np.arange(round(length_m / STEP_M) + 1) * STEP_M
    ends = np.clip(np.minimum(distances_m, length_m - distances_m) / 300.0, 0.0, 1.0)
    grades: Floats = steepest * ends * np.sin(2.0 * np.pi * distances_m / 2000.0)
    return grades


def ramp(length_m: float, grade: float, from_m: float) -> Floats:
    """Level, then so steep to the end, with 100 m between."""
    distances_m = np.arange(round(length_m / STEP_M) + 1) * STEP_M
    grades: Floats = grade * np.clip((distances_m - from_m) / 100.0, 0.0, 1.0)
    return grades


@cache
def hilly(vehicle: str) -> Journey:
    """Six kilometres of hills with three stops and a bend, in traffic."""
    grade = hills(6000.0)
    bend = np.zeros_like(grade)
    bend[7000:7200] = 1.0 / 60.0
    course = laid(grade, curvature_per_m=bend, halts=HALTS)
    driver = DriverModel(traffic_density=0.5)
    return Journey(course, driven(course, vehicle, driver, Weather()))


def driven(
    course: Course,
    vehicle: str = "car",
    driver: DriverModel = STEADY,
    weather: Weather = CALM,
    seed: int = 4,
) -> Motion:
    """A run; unless told otherwise by a driver without moods, on a day without wind."""
    return drive(course, VEHICLES[vehicle], driver, weather, np.random.default_rng(seed))
