"""Pure: leaves out poses that a straight line between their neighbours tells well enough.

Between the poses that stay, position, altitude and speed go on evenly in time; nowhere is that off
by more than the pose's own std, or by a metre (half a metre per second) where that is less. What
is left is the least that this finds by splitting where the error is largest (Douglas and Peucker
1973, with the distance taken at equal times).
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.geo import metres_per_degree
from wayline_history.chunk import Chunk
from wayline_history.layouts import ENGINE, NULL

POSITION_LEAST_M = 1.0
ALTITUDE_LEAST_M = 1.0
SPEED_LEAST_MPS = 0.5
Floats = NDArray[np.float64]
LONGEST_US = 60_000_000
"""Poses this far apart both stay: between them there may have been silence."""


def thinned(poses: Chunk) -> Chunk:
    """The poses that stay."""
    if len(poses) < 3:
        return poses
    keeps = _turning(poses)
    curves = _curves(poses)
    fixed = np.flatnonzero(keeps).tolist()
    for first, last in pairwise(fixed):
        _split(curves, first, last, keeps)
    return poses.taken(keeps)


def _turning(poses: Chunk) -> NDArray[np.bool_]:
    """Poses that stay whatever the line: the ends, silences, and where what is known changes."""
    words = np.column_stack(
        [
            poses.column("mode"),
            poses.column(ENGINE),
            *(poses.column(name) == NULL for name in ("lat_deg", "alt_m", "speed_mps")),
        ]
    )
    changes = np.any(np.diff(words, axis=0) != 0, axis=1)
    changes |= np.diff(poses.times_us) > LONGEST_US
    keeps = np.zeros(len(poses), bool)
    keeps[:-1] |= changes
    keeps[1:] |= changes
    keeps[0] = keeps[-1] = True
    return keeps


class _Curves(NamedTuple):
    """What goes on evenly between the poses that stay."""

    times: Floats
    values: Floats
    """(4, n) east, north, altitude and speed."""
    bounds: Floats
    """(3, n) how far off place, altitude and speed may be."""


def _curves(poses: Chunk) -> _Curves:
    lat_deg, lon_deg = _unit(poses, "lat_deg"), _unit(poses, "lon_deg")
    north_m, east_m = metres_per_degree(float(lat_deg[0]))
    eastward_deg = (lon_deg - lon_deg[0] + 180.0) % 360.0 - 180.0
    values = np.stack(
        [
            eastward_deg * east_m,
            (lat_deg - lat_deg[0]) * north_m,
            _unit(poses, "alt_m"),
            _unit(poses, "speed_mps"),
        ]
    )
    position_std_m = np.hypot(_unit(poses, "east_std_m"), _unit(poses, "north_std_m"))
    bounds = np.stack(
        [
            np.maximum(position_std_m, POSITION_LEAST_M),
            np.maximum(_unit(poses, "alt_std_m"), ALTITUDE_LEAST_M),
            np.maximum(_unit(poses, "speed_std_mps"), SPEED_LEAST_MPS),
        ]
    )
    return _Curves(poses.times_us.astype(np.float64), values, bounds)


def _unit(poses: Chunk, name: str) -> Floats:
    """A quantity in its unit, 0 where it is unknown."""
    steps = poses.column(name)
    per_unit = poses.layout.columns[poses.layout.place(name)].per_unit
    return np.where(steps == NULL, 0.0, steps / per_unit)


def _split(curves: _Curves, first: int, last: int, keeps: NDArray[np.bool_]) -> None:
    """Mark what has to stay between two poses that do."""
    times, values, bounds = curves
    waiting = [(first, last)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        inside = slice(first + 1, last)
        share = (times[inside] - times[first]) / (times[last] - times[first])
        ends = values[:, first, None], values[:, last, None]
        off = values[:, inside] - (ends[0] + (ends[1] - ends[0]) * share)
        errors = np.stack([np.hypot(off[0], off[1]), np.abs(off[2]), np.abs(off[3])])
        worst = (errors / bounds[:, inside]).max(axis=0)
        most = int(worst.argmax())
        if worst[most] > 1.0:
            middle = first + 1 + most
            keeps[middle] = True
            waiting += [(first, middle), (middle, last)]
