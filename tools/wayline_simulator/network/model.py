"""Pure: what is asked of a simulated network."""

import datetime as dt
from enum import IntEnum
from typing import Annotated

import numpy as np
from msgspec import Meta

from wayline.strict import Strict

ZONE = "Europe/Berlin"
LINES = ("A", "B")


class NetworkModel(Strict, frozen=True, kw_only=True):
    """A network and some days of its service."""

    seed: Annotated[int, Meta(ge=0)] = 1
    vehicles: Annotated[int, Meta(ge=1)] = 4
    """Of each day's blocks the first so many are driven, one by each vehicle."""
    days: Annotated[int, Meta(ge=1, le=366)] = 1
    every_s: Annotated[float, Meta(ge=1.0, le=600.0)] = 30.0
    """Between two reports of a vehicle."""
    hours: Annotated[float, Meta(gt=0.0, le=18.0)] = 6.0
    """Of service a day, from FIRST_S on."""
    headway_min: Annotated[int, Meta(ge=4, le=120)] = 15
    """Between two trips of a line, in the direction of both."""
    start: dt.date = dt.date(2026, 5, 4)
    """The first day; a Monday, so that six and seven are another kind of day."""
    assigned: bool = False
    """Reports name the block; else nobody says what a vehicle runs."""


class Part(IntEnum):
    """What random numbers are for; a number that is in use keeps its meaning."""

    STREETS = 0
    STREET_SPEEDS = 1
    TRAFFIC = 2
    RIDE = 3
    REPORTS = 4


def randomness(model: NetworkModel, part: Part, *of: int) -> np.random.Generator:
    """The random numbers of one part of a network, a day or a vehicle."""
    return np.random.default_rng([model.seed, part, *of])
