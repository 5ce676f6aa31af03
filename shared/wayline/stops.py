"""Pure: the stops of a route and where they lie along its line."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.errors import InputError
from wayline.line import Line

Floats = NDArray[np.float64]

STOP_REACH_M = 150.0
"""A stop farther from the line than this, in its order, is taken for a mistake."""
LEG_M = 200.0
"""On longer legs two stops in the wrong order would have no places that are near to both."""


class StopPlace(NamedTuple):
    """A stop before it is placed on a line."""

    stop_id: str
    name: str
    lat_deg: float
    lon_deg: float
    dwell_s: float = 0.0


class Stop(NamedTuple):
    """A stop of a route; `distance_m` is where it lies along the line."""

    stop_id: str
    name: str
    lat_deg: float
    lon_deg: float
    dwell_s: float
    distance_m: float


def place_stops(
    where: str, line: Line, stops: Sequence[StopPlace], *, loop: bool
) -> tuple[Stop, ...]:
    """Stops placed along a line in their order, with the least sum of offsets from it.

    Where the line passes a place twice the order decides (dynamic programming over the nearest
    points of all legs; the earlier place wins a tie). Raises InputError for a stop that has no
    place within STOP_REACH_M in its order.
    """
    alongs_m = [float(along_m) for along_m in _placed(where, line, stops, STOP_REACH_M)]
    if loop:
        alongs_m = [0.0 if line.length_m - along_m < 1e-6 else along_m for along_m in alongs_m]
    return tuple(Stop(*stop, along_m) for stop, along_m in zip(stops, alongs_m, strict=True))


def nearest_in_order(line: Line, stops: Sequence[StopPlace]) -> Floats:
    """Where stops lie along a line in their order, however far from it, shape (stops,).

    The sum of their offsets is the least; never falling.
    """
    return np.array(_placed("", _finely_divided(line), stops, np.inf), dtype=np.float64)


def _finely_divided(line: Line) -> Line:
    """The line in short legs, two at least: stops out of order then have places beside others."""
    counts = np.maximum(np.ceil(line.legs_m / LEG_M), 2 if len(line.legs_m) == 1 else 1)
    steps = [
        begin + np.arange(count) / count * leg
        for begin, count, leg in zip(line.distances_m, counts, line.legs_m, strict=False)
    ]
    distances_m = np.append(np.concatenate(steps), line.length_m)
    points = np.array([line.point_at(float(distance_m))[:2] for distance_m in distances_m])
    return Line(points[:, 0], points[:, 1])


def _placed(where: str, line: Line, stops: Sequence[StopPlace], reach_m: float) -> list[float]:
    nearest = [line.project_legs(stop.lat_deg, stop.lon_deg) for stop in stops]
    costs: list[Floats] = []
    came_from: list[NDArray[np.intp]] = []
    for position, projections in enumerate(nearest):
        within = projections.offsets_m <= reach_m
        cost = np.where(within, np.round(projections.offsets_m, 2), np.inf)
        if position:
            back = _best_so_far(costs[-1])
            last = np.searchsorted(nearest[position - 1].alongs_m, projections.alongs_m, "right")
            came_from.append(back[np.maximum(last - 1, 0)])
            cost = cost + np.where(last > 0, costs[-1][came_from[-1]], np.inf)
        if not np.isfinite(cost).any():
            _refuse_stop(where, stops[position], float(projections.offsets_m.min()))
        costs.append(cost)
    legs = _trace_back(costs, came_from)
    return [float(nearest[i].alongs_m[leg]) for i, leg in enumerate(legs)]


def _best_so_far(cost: Floats) -> NDArray[np.intp]:
    """For every leg the leg up to it with the least cost, the earliest of equals."""
    lowest = np.minimum.accumulate(cost)
    is_new = np.concatenate(([True], lowest[1:] < lowest[:-1]))
    return np.maximum.accumulate(np.where(is_new, np.arange(len(cost)), 0))


def _trace_back(costs: list[Floats], came_from: list[NDArray[np.intp]]) -> list[int]:
    if not costs:
        return []
    legs = [int(np.argmin(costs[-1]))]
    for back in reversed(came_from):
        legs.append(int(back[legs[-1]]))
    return legs[::-1]


def _refuse_stop(where: str, stop: StopPlace, offset_m: float) -> None:
    if offset_m > STOP_REACH_M:
        what, mend = f"is {offset_m:.0f} m from the line", "correct its position or the line"
    else:
        what, mend = "is out of order", "list the stops in the order of travel"
    raise InputError(where, f"stop {stop.stop_id} {what}", mend)
