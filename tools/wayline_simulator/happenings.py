"""Pure: what befell a simulated drive, for the yardstick that is told everything but the errors."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.strict import Strict
from wayline_simulator.gps_events import GpsEvents
from wayline_simulator.gps_gaps import scheduled
from wayline_simulator.journey import MOTION_STEP_S, Floats, Journey

SLIPPING_MPS, SLIPPING_SHARE = 0.2, 0.05
"""Wheels off the road's speed by more than both together spin or are locked: traction and brakes
alone let them slip by 1 to 2 %."""
WINDOW_S = 2.0
"""Slip is averaged over so long before its statistics are taken."""
MOVING_MPS = 3.0
"""Slower, the share of slip tells little of the way."""
SHORTEST_S, LONGEST_S = 1.0, 60.0
"""Bounds of slip's correlation time: from one shift of gears to one climb."""


class Span(NamedTuple):
    """From one Unix time to another."""

    start_s: float
    end_s: float


class Change(NamedTuple):
    """From a Unix time on."""

    time_s: float
    surroundings: int
    """A `course.Surroundings`."""


class Happenings(Strict, frozen=True, kw_only=True):
    """What befell one drive."""

    surroundings: tuple[Change, ...] = ()
    slips: tuple[Span, ...] = ()
    """Wheels that spun or were locked."""
    displaced: tuple[Span, ...] = ()
    """Fixes by their timestamp that an event moved."""
    slip_std: float = 0.0
    """Of true over rolled distance about its mean over the drive, those spans left out; of a
    first-order Gauss-Markov process."""
    slip_time_s: float = SHORTEST_S


def happenings(
    journey: Journey, events: GpsEvents, start_s: float, wheel_radius_m: float
) -> Happenings:
    """Of a drive that starts at Unix time `start_s`; the radius is the wheels' nominal one."""
    motion = journey.motion
    rolled_mps = motion.wheel_radps * wheel_radius_m
    off_mps = np.abs(rolled_mps - motion.speeds_mps)
    slipping = off_mps > SLIPPING_MPS + SLIPPING_SHARE * motion.speeds_mps
    std, time_s = _slip(journey, rolled_mps, slipping)
    kinds = journey.at(motion.times_s).surroundings
    changes = np.flatnonzero(np.diff(kinds, prepend=-1))
    return Happenings(
        surroundings=tuple(
            Change(start_s + float(motion.times_s[row]), int(kinds[row])) for row in changes
        ),
        slips=_spans(slipping, motion.times_s, start_s),
        displaced=_displaced(events, motion.times_s, start_s),
        slip_std=std,
        slip_time_s=time_s,
    )


def _displaced(events: GpsEvents, times_s: Floats, start_s: float) -> tuple[Span, ...]:
    moved = np.zeros(len(times_s), dtype=np.bool_)
    for event in events.displacements:
        moved |= scheduled(times_s, event)
    return _spans(moved, times_s, start_s)


def _spans(flags: NDArray[np.bool_], times_s: Floats, start_s: float) -> tuple[Span, ...]:
    edges = np.flatnonzero(np.diff(flags, prepend=False, append=False))
    unix_s = start_s + np.append(times_s, times_s[-1] + MOTION_STEP_S)
    return tuple(
        Span(float(unix_s[first]), float(unix_s[last]))
        for first, last in zip(edges[::2], edges[1::2], strict=True)
    )


def _slip(journey: Journey, rolled_mps: Floats, slipping: NDArray[np.bool_]) -> tuple[float, float]:
    """Std and correlation time, which is the area under the autocorrelation."""
    level_mps = np.abs(journey.at(journey.motion.times_s).speeds_mps)
    size = round(WINDOW_S / MOTION_STEP_S)
    count = len(rolled_mps) // size
    true_m, rolled_m = (
        part[: count * size].reshape(count, size).sum(axis=1) * MOTION_STEP_S
        for part in (level_mps, rolled_mps)
    )
    spoilt = slipping[: count * size].reshape(count, size).any(axis=1)
    moving = (np.minimum(true_m, rolled_m) > MOVING_MPS * WINDOW_S) & ~spoilt
    if np.count_nonzero(moving) < 10:
        return 0.0, SHORTEST_S
    scales = np.where(moving, true_m / np.where(moving, rolled_m, 1.0), np.nan)
    off = scales - np.nanmean(scales)
    variance = float(np.nanmean(np.square(off)))
    return math.sqrt(variance), float(np.clip(_area_s(off, variance), SHORTEST_S, LONGEST_S))


def _area_s(off: Floats, variance: float) -> float:
    """Under the autocorrelation on one side, up to where it is first negative."""
    area = 0.5
    for lag in range(1, round(LONGEST_S / WINDOW_S)):
        together = off[lag:] * off[:-lag]
        known = together[~np.isnan(together)]
        if not len(known) or np.mean(known) <= 0.0:
            break
        area += float(np.mean(known)) / variance
    return area * WINDOW_S if variance > 0.0 else SHORTEST_S
