"""Pure: the six ways of smoothing a trip that the study compares."""

from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

import numpy as np

from wayline.trip_distance.trip import gps_way
from wayline_evaluation.estimates import Floats
from wayline_evaluation.smoothing.kalman import (
    POSITION_VARIANCE_M2,
    SPEED_VARIANCE_M2PS2,
    discrete_kalman,
)
from wayline_evaluation.smoothing.kernel import nadaraya_watson
from wayline_evaluation.smoothing.modified_kalman import (
    BAD_POSITION_VARIANCE_M2,
    BAD_SPEED_VARIANCE_M2PS2,
    modified_kalman,
)
from wayline_evaluation.smoothing.spline import least_squares_spline
from wayline_evaluation.smoothing.trip import Trip, added_up

Method = Literal["least_squares_spline", "kernel", "kalman", "modified_kalman", "rts", "fusion"]


class Made(NamedTuple):
    """What a smoother makes of a trip."""

    speeds_mps: Floats
    """At the fixes, shape (n,)."""
    distance_m: float
    """By positions, as the paper has it; by what the method has where it has more."""
    speed_distance_m: float
    """By its speeds, added up from fix to fix."""
    distance_std_m: float | None = None


def by_spline(trip: Trip) -> Made:
    """Least squares quadratic spline, 3 s."""
    return _made(trip, lambda values: least_squares_spline(trip.track.times_s, values))


def by_kernel(trip: Trip) -> Made:
    """Gaussian kernel, 3 s."""
    return _made(trip, lambda values: nadaraya_watson(trip.track.times_s, values))


def by_kalman(trip: Trip) -> Made:
    """Discrete Kalman filter."""
    times_s = trip.track.times_s
    speeds_mps = discrete_kalman(times_s, trip.told_mps, SPEED_VARIANCE_M2PS2)
    places_m = discrete_kalman(times_s, trip.track.places_m, POSITION_VARIANCE_M2)
    return Made(speeds_mps, added_up(places_m), _by_speeds(trip, speeds_mps))


def by_modified_kalman(trip: Trip) -> Made:
    """Modified Kalman filter: R by satellites and PDOP."""
    track = trip.track
    speeds_mps = modified_kalman(
        track.times_s,
        trip.told_mps,
        track.good,
        variance=SPEED_VARIANCE_M2PS2,
        bad_variance=BAD_SPEED_VARIANCE_M2PS2,
    )
    places_m = modified_kalman(
        track.times_s,
        track.places_m,
        track.good,
        variance=POSITION_VARIANCE_M2,
        bad_variance=BAD_POSITION_VARIANCE_M2,
    )
    return Made(speeds_mps, added_up(places_m), _by_speeds(trip, speeds_mps))


def by_rts(trip: Trip) -> Made:
    """Rauch-Tung-Striebel smoother, holes bridged: Wayline's own trip distance."""
    way = gps_way(trip.track)
    told = way.total()
    by_speeds_m = _by_speeds(trip, way.speeds_mps)
    return Made(way.speeds_mps, told.distance_m, by_speeds_m, told.distance_std_m)


SMOOTHERS: Mapping[Method, Callable[[Trip], Made]] = {
    "least_squares_spline": by_spline,
    "kernel": by_kernel,
    "kalman": by_kalman,
    "modified_kalman": by_modified_kalman,
    "rts": by_rts,
}
"""Those that are quick; fusion needs a replay."""


def _made(trip: Trip, smooth: Callable[[Floats], Floats]) -> Made:
    speeds_mps = smooth(trip.told_mps)
    return Made(speeds_mps, added_up(smooth(trip.track.places_m)), _by_speeds(trip, speeds_mps))


def _by_speeds(trip: Trip, speeds_mps: Floats) -> float:
    return float(np.sum(0.5 * (speeds_mps[1:] + speeds_mps[:-1]) * trip.track.steps_s))
