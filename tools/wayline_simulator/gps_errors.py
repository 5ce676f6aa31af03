"""Pure: the shapes of a receiver's errors over time."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from wayline_simulator.journey import Floats

ACROSS_SHARE, ALONG_SHARE = 0.9, 0.44
"""Walls along a street reflect across it; squares sum to 1. A judgement."""


def lagged(values: Floats, step_s: float, time_s: float) -> Floats:
    """First-order lag along the first axis, settled at the start."""
    if time_s <= 0.0:
        return values
    kept = np.exp(-step_s / time_s)
    smooth, _ = lfilter([1.0 - kept], [1.0, -kept], values, axis=0, zi=kept * values[:1])
    return np.asarray(smooth)


def held(values: Floats, known: NDArray[np.bool_]) -> Floats:
    """Where a value is not known, the last one that was; before the first, that one."""
    if not known.any():
        return np.zeros_like(values)
    index = np.where(known, np.arange(len(values)), -1)
    last = np.maximum.accumulate(index)
    return values[np.where(last < 0, np.argmax(known), last)]


def reflections(
    courses_rad: Floats, step_s: float, lasting_s: float, random: np.random.Generator
) -> Floats:
    """Offsets east, north and up, shape (n, 3), of mean square 1 horizontally and 1 upwards.

    Each lasts for an exponentially distributed time, then another set of walls reflects.
    """
    changes = random.random(len(courses_rad)) < -np.expm1(-step_s / lasting_s)
    number = np.cumsum(changes)
    drawn = random.standard_normal((int(number[-1]) + 1, 3))[number]
    across, along = ACROSS_SHARE * drawn[:, 0], ALONG_SHARE * drawn[:, 1]
    # a set of walls stands where it stands: it keeps the direction of its beginning
    first = np.maximum.accumulate(np.where(changes, np.arange(len(changes)), 0))
    course = courses_rad[first]
    return np.column_stack(
        (
            across * np.cos(course) + along * np.sin(course),
            along * np.cos(course) - across * np.sin(course),
            drawn[:, 2],
        )
    )


def decays(begins: NDArray[np.intp], count: int, step_s: float, time_s: float) -> Floats:
    """1 at every beginning, falling to a third in `time_s` until the next; 0 before the first."""
    if not len(begins):
        return np.zeros(count)
    which = np.searchsorted(begins, np.arange(count), side="right") - 1
    since_s = (np.arange(count) - begins[np.maximum(which, 0)]) * step_s
    return np.where(which < 0, 0.0, np.exp(-np.maximum(since_s, 0.0) / time_s))


def drawn_at(begins: NDArray[np.intp], count: int, random: np.random.Generator) -> Floats:
    """Three normal numbers drawn at every beginning and held until the next, shape (count, 3)."""
    values = random.standard_normal((len(begins) + 1, 3))
    return values[np.searchsorted(begins, np.arange(count), side="right")]
