"""Pure: one run of a scenario: the journey that a driver makes of a road, and what is sensed of it.

A run's random numbers come from the scenario's seed, the run's number and the part they are for, so
that a change of one part leaves the others as they were.
"""

from enum import IntEnum
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.drive import Vehicle
from wayline_simulator.course import Course
from wayline_simulator.driver import drawn as drawn_driver
from wayline_simulator.driving import drive
from wayline_simulator.facts import Facts
from wayline_simulator.gps import Fixes, measure_fixes
from wayline_simulator.journey import Journey
from wayline_simulator.presets import Preset
from wayline_simulator.scenario import Scenario
from wayline_simulator.torque import assumed_vehicle
from wayline_simulator.vehicle import vehicle_table
from wayline_simulator.vehicle_sensors import VehicleSamples, measure_vehicle
from wayline_simulator.weather import Weather
from wayline_simulator.weather import drawn as drawn_weather


class Part(IntEnum):
    """What random numbers are for; a number that is in use keeps its meaning."""

    DEVICE = 0
    DRIVER = 1
    MOTION = 2
    WEATHER = 3
    GPS = 4
    VEHICLE = 5
    SENTENCE_DAMAGE = 6
    FRAME_DAMAGE = 7
    MASS = 8
    RAW = 9


class Run(NamedTuple):
    """A drive before it is written."""

    number: int
    """From 1."""
    start_s: int
    """Unix time."""
    journey: Journey
    models: Preset
    assumed: Vehicle
    """What the vehicle believes of itself: `[vehicle]` of its drive.toml."""
    fixes: Fixes | None
    samples: VehicleSamples
    facts: Facts


def randomness(scenario: Scenario, run: int, part: Part) -> np.random.Generator:
    """The random numbers of one part of one run; run 0 is what all runs have in common."""
    return np.random.default_rng([scenario.seed, run, part])


def simulate_run(scenario: Scenario, course: Course, number: int) -> Run:
    """The scenario's run of that number, from 1, over the whole course with all its laps."""

    def random(part: Part) -> np.random.Generator:
        return randomness(scenario, number, part)

    vehicle, models = scenario.vehicle_model(), scenario.sensor_models()
    weather = drawn_weather(scenario.weather, random(Part.WEATHER))
    driver = drawn_driver(scenario.driver, random(Part.DRIVER))
    motion = drive(course, vehicle, driver, weather, random(Part.MOTION), loads=scenario.loads)
    journey = Journey(course, motion)
    start_s = round(scenario.start.timestamp() + (number - 1) * scenario.run_every_h * 3600.0)
    fixes = None
    if models.gps:
        fixes = measure_fixes(journey, models.gps, scenario.events, start_s, random(Part.GPS))
    assumed = _assumed(scenario, models)
    samples = measure_vehicle(
        journey,
        models,
        weather,
        vehicle=vehicle_table(vehicle, vehicle.mass_kg),
        assumed=assumed,
        device=randomness(scenario, 0, Part.DEVICE),
        random=random(Part.VEHICLE),
    )
    facts = _facts(scenario, models, weather, number)
    return Run(number, start_s, journey, models, assumed, fixes, samples, facts)


def _assumed(scenario: Scenario, models: Preset) -> Vehicle:
    """The vehicle as its drive.toml has it: with a mass that is off, and the receiver's latency."""
    model = scenario.vehicle_model()
    vehicle = vehicle_table(model, model.mass_kg)
    if models.torque:
        vehicle = assumed_vehicle(vehicle, models.torque, randomness(scenario, 0, Part.MASS))
    latency_s = models.gps.latency_s if models.gps else 0.0
    return msgspec.structs.replace(vehicle, gps_latency_s=latency_s)


def _facts(scenario: Scenario, models: Preset, weather: Weather, number: int) -> Facts:
    return Facts(
        preset=scenario.preset,
        seed=scenario.seed,
        run=number,
        gps=models.gps,
        gyro=models.gyro,
        odometer=models.odometer,
        torque=models.torque,
        barometer=models.barometer,
        weather=weather,
        mass_kg=scenario.vehicle_model().mass_kg,
        loads=scenario.loads,
        raw=scenario.raw if models.gps else None,
    )
