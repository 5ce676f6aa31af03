"""Pure: what wheels and gyro say of the motion between instants."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wayline_evaluation.estimates import Floats
from wayline_evaluation.sensed import Sensed, Series

STANDING_S = 0.5
"""Wheels at rest so long on either side of an instant: the vehicle stands. Ahead, too, because a
wheel sensor's dead zone hides the first turn of the wheels."""
LONGEST_S = 60.0
"""No road is so straight that a steering hand rests for longer; judgement."""


@dataclass(frozen=True, slots=True)
class SensedMotion:
    """At the instants, shape (n,), and from the instant before to each."""

    times_s: Floats
    turned_deg: Floats
    driven_m: Floats
    """Negative in reverse."""
    speeds_mps: Floats
    steady_s: Floats
    """How long the wheel speed has had its reading and will keep it."""
    standing: NDArray[np.bool_]


def motion_at(times_s: Floats, sensed: Sensed, *, wheels_low_mps: float = 0.0) -> SensedMotion:
    """Both sensors integrated exactly; wheels that turn read too low by `wheels_low_mps`."""
    raw = sensed.speed_mps
    wheels = Series(raw.times_s, raw.values + wheels_low_mps * np.sign(raw.values))
    return SensedMotion(
        times_s=times_s,
        turned_deg=np.diff(integral(sensed.yaw_rate_degps, times_s), prepend=0.0),
        driven_m=np.diff(integral(wheels, times_s), prepend=0.0),
        speeds_mps=np.interp(times_s, wheels.times_s, wheels.values),
        steady_s=_steady_s(wheels, times_s),
        standing=_standing(wheels, times_s),
    )


def integral(rates: Series, times_s: Floats) -> Floats:
    """A rate's integral up to instants, straight lines between its samples."""
    steps_s = np.diff(rates.times_s)
    areas = 0.5 * (rates.values[1:] + rates.values[:-1]) * steps_s
    totals = np.concatenate(([0.0], np.cumsum(areas)))
    return np.interp(times_s, rates.times_s, totals)


def period_s(series: Series) -> float:
    """Usual time between samples."""
    return float(np.median(np.diff(series.times_s)))


def changing_s(rates: Series, step: float) -> float:
    """How long a rate, averaged over a second, takes to change by a step."""
    seconds_s = np.arange(rates.times_s[0], rates.times_s[-1])
    means = np.diff(integral(rates, seconds_s))
    change = max(float(np.mean(np.abs(np.diff(means)))), step / LONGEST_S)
    return max(step / change, period_s(rates))


def _steady_s(wheels: Series, times_s: Floats) -> Floats:
    changes = np.flatnonzero(np.diff(wheels.values)) + 1
    edges_s = wheels.times_s[np.concatenate(([0], changes))]
    run = np.searchsorted(edges_s, times_s, "right")
    ends_s = np.append(edges_s, wheels.times_s[-1])
    lengths_s = ends_s[np.clip(run, 1, len(ends_s) - 1)] - ends_s[np.clip(run - 1, 0, None)]
    return np.asarray(np.maximum(lengths_s, period_s(wheels)))


def _standing(wheels: Series, times_s: Floats) -> NDArray[np.bool_]:
    turning = np.concatenate(([0], np.cumsum(wheels.values != 0.0)))
    first = np.searchsorted(wheels.times_s, times_s - STANDING_S)
    last = np.searchsorted(wheels.times_s, times_s + STANDING_S, "right")
    standing: NDArray[np.bool_] = (turning[last] == turning[first]) & (last > first)
    return standing
