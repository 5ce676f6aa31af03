"""Pure: the trips of vehicles: where each goes, how it is driven, and what the receiver tells."""

import datetime as dt
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from wayline_simulator.journey import Journey, Truth
from wayline_simulator.road_model import Kind, RoadModel
from wayline_simulator.trips.model import Part, TripsModel, randomness
from wayline_simulator.trips.receiver import Fixes, fixes_of

MEDIAN_M, SPREAD = 10_000.0, 0.9
"""Of the lengths of trips, and the std of their logarithm: table 4 of papers/003 has half of them
below 8 miles and 2 in 100 above 40."""
LENGTHS_M = (1_500.0, 80_000.0)
TOWN_TO_M, MAIN_TO_M = 4_000.0, 20_000.0
"""Shorter trips are mostly in town, longer ones on motorways, those between on main roads."""
MOSTLY = 0.7
TRIPS_A_DAY = 6
FIRST_HOUR, EVERY_H = 7, 2.5


class Trip(NamedTuple):
    """One trip; times are seconds from its beginning, `start_s` Unix time."""

    vehicle: int
    number: int
    start_s: int
    truth: Truth
    """Every second."""
    distance_m: float
    fixes: Fixes


class Planned(NamedTuple):
    """A trip before it is driven; its road is made by `seed`."""

    vehicle: int
    number: int
    start_s: int
    road: RoadModel
    seed: int


def plan(model: TripsModel) -> Iterator[Planned]:
    """All trips, vehicle by vehicle, both numbered from 1."""
    midnight = dt.datetime.combine(model.start, dt.time(), tzinfo=dt.UTC)
    for vehicle in range(1, model.vehicles + 1):
        for number in range(1, model.trips + 1):
            random = randomness(model, vehicle, number, Part.PLAN)
            day, of_day = divmod(number - 1, TRIPS_A_DAY)
            start = midnight + dt.timedelta(days=day, hours=FIRST_HOUR + EVERY_H * of_day)
            seed = int(random.integers(2**31))
            yield Planned(vehicle, number, round(start.timestamp()), _road(random), seed)


def _road(random: np.random.Generator) -> RoadModel:
    length_m = float(np.clip(MEDIAN_M * np.exp(SPREAD * random.standard_normal()), *LENGTHS_M))
    usual: Kind = (
        "urban" if length_m < TOWN_TO_M else "main" if length_m < MAIN_TO_M else "motorway"
    )
    other: Kind = "main" if length_m >= TOWN_TO_M else "urban"
    kind = usual if random.random() < MOSTLY else other
    heading_deg = float(random.uniform(0.0, 360.0))
    return RoadModel(kind=kind, length_m=length_m, heading_deg=heading_deg)


def driven(model: TripsModel, planned: Planned, journey: Journey) -> Trip:
    """The trip as the receiver tells it."""
    truth = journey.at(np.arange(int(journey.duration_s) + 1, dtype=np.float64))
    random = randomness(model, planned.vehicle, planned.number, Part.RECEIVER)
    return Trip(
        vehicle=planned.vehicle,
        number=planned.number,
        start_s=planned.start_s,
        truth=truth,
        distance_m=float(truth.path_m[-1]),
        fixes=fixes_of(truth, random),
    )
