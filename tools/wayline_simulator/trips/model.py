"""Pure: what is asked of simulated trips."""

import datetime as dt
from enum import IntEnum
from typing import Annotated

import numpy as np
from msgspec import Meta

from wayline.strict import Strict


class TripsModel(Strict, frozen=True, kw_only=True):
    """Some vehicles and the trips of each."""

    seed: Annotated[int, Meta(ge=0)] = 1
    vehicles: Annotated[int, Meta(ge=1, le=1_000)] = 7
    """As in papers/003."""
    trips: Annotated[int, Meta(ge=1, le=10_000)] = 15
    """Of each vehicle; papers/003 has 243."""
    start: dt.date = dt.date(2026, 5, 4)
    """The first day."""


class Part(IntEnum):
    """What random numbers are for; a number that is in use keeps its meaning."""

    PLAN = 0
    DRIVER = 1
    WEATHER = 2
    MOTION = 3
    RECEIVER = 4


def randomness(model: TripsModel, vehicle: int, trip: int, part: Part) -> np.random.Generator:
    """The random numbers of one part of one trip."""
    return np.random.default_rng([model.seed, vehicle, trip, part])
