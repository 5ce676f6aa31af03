"""Pure: one trip scored: what each method says beside the reference, as sums that add up."""

from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np

from wayline_evaluation.estimates import Floats
from wayline_evaluation.smoothing.smoothers import Made, Method
from wayline_evaluation.smoothing.statistics import Sums, sums_of
from wayline_evaluation.smoothing.trip import ReferenceKind, Trip

STEP_S = 1.5
"""Accelerations are of speeds not further apart (the paper: two consecutive seconds)."""
Pair = tuple[Method, Method]


class MethodScore(NamedTuple):
    """One method on one trip."""

    speed: Sums
    """Reference minus method, m/s, at all fixes."""
    bad_speed: Sums
    """At bad fixes."""
    acceleration: Sums
    """m/s2."""
    distance_m: float
    speed_distance_m: float
    distance_std_m: float | None


class TripScore(NamedTuple):
    """All methods on one trip."""

    name: str
    reference: ReferenceKind
    reference_m: float
    fixes: int
    bad_fixes: int
    holes: int
    methods: Mapping[Method, MethodScore]
    speed_pairs: Mapping[Pair, Sums]
    """What the speeds of two methods differ by."""
    acceleration_pairs: Mapping[Pair, Sums]


def score_of(trip: Trip, made: Mapping[Method, Made]) -> TripScore:
    """What is kept of a trip; a few hundred numbers however long it is."""
    wanted_mps2 = _accelerations(trip, trip.reference.speeds_mps)
    accelerations = {name: _accelerations(trip, each.speeds_mps) for name, each in made.items()}
    known = ~np.isnan(trip.reference.speeds_mps)
    return TripScore(
        name=trip.name,
        reference=trip.reference.kind,
        reference_m=trip.reference.distance_m,
        fixes=len(trip.track),
        bad_fixes=int(np.count_nonzero(~trip.track.good)),
        holes=int(np.count_nonzero(trip.track.steps_s > STEP_S)),
        methods={
            name: _method_score(trip, each, wanted_mps2 - accelerations[name])
            for name, each in made.items()
        },
        speed_pairs={
            (one, other): sums_of((made[one].speeds_mps - made[other].speeds_mps)[known])
            for one, other in pairs(made)
        },
        acceleration_pairs={
            (one, other): sums_of(accelerations[one] - accelerations[other])
            for one, other in pairs(made)
        },
    )


def pairs(methods: Mapping[Method, object]) -> Iterator[Pair]:
    """Every two methods, in order."""
    yield from combinations(methods, 2)


def _method_score(trip: Trip, made: Made, acceleration_errors: Floats) -> MethodScore:
    errors_mps = trip.reference.speeds_mps - made.speeds_mps
    return MethodScore(
        speed=sums_of(errors_mps),
        bad_speed=sums_of(errors_mps[~trip.track.good]),
        acceleration=sums_of(acceleration_errors),
        distance_m=made.distance_m,
        speed_distance_m=made.speed_distance_m,
        distance_std_m=made.distance_std_m,
    )


def _accelerations(trip: Trip, speeds_mps: Floats) -> Floats:
    """From fix to fix, shape (n - 1,); nan over holes and where a speed is unknown."""
    steps_s = trip.track.steps_s
    accelerations: Floats = np.where(steps_s <= STEP_S, np.diff(speeds_mps) / steps_s, np.nan)
    return accelerations
