"""Pure: a load that changes on the way, at a stand."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from msgspec import Meta

from wayline.strict import Strict
from wayline_simulator.journey import Floats
from wayline_simulator.traffic import MERGE_M, Standstill


class LoadChange(Strict, frozen=True, kw_only=True):
    """`[[loads]]`: the vehicle parks, and goes on with another mass."""

    distance_m: Annotated[float, Meta(gt=0.0)]
    """Along the whole course, laps included."""
    mass_kg: Annotated[float, Meta(gt=0.0)]
    """From there on."""
    wait_s: Annotated[float, Meta(ge=1.0)] = 600.0


def masses_kg(path_m: Floats, first_kg: float, loads: Sequence[LoadChange]) -> Floats:
    """The vehicle's mass at distances along the course, shape (n,)."""
    masses = np.full(len(path_m), first_kg)
    for load in sorted(loads, key=lambda each: each.distance_m):
        masses[path_m > load.distance_m] = load.mass_kg
    return masses


def with_loads(stops: Sequence[Standstill], loads: Sequence[LoadChange]) -> list[Standstill]:
    """The stops of a run in order, with those at which the load changes; these go before others."""
    places = [Standstill(load.distance_m, load.wait_s, parked=True) for load in loads]
    others = [
        stop
        for stop in stops
        if all(abs(stop.distance_m - place.distance_m) >= MERGE_M for place in places)
    ]
    return sorted([*places, *others])
