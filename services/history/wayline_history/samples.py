"""Pure: poses and fixes as trips see them: of their rows, so that live and from the store agree."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from wayline.messages import GpsFix, PoseMode
from wayline_history.layouts import ENGINE, FIXES, NULL, POSES, SOURCE, US, Column


class Sample(NamedTuple):
    """What a trip is made of at one instant; the vehicle's place is known."""

    t_ns: int
    lat_deg: float
    lon_deg: float
    alt_m: float | None
    alt_std_m: float | None
    speed_mps: float | None
    """Negative in reverse."""
    speed_std_mps: float | None
    distance_m: float
    """That fusion counts since its start."""
    position_std_m: float
    mode: PoseMode
    is_engine_off: bool


_OF_POSE = {column.name: (place, column) for place, column in enumerate(POSES.columns)}
_OF_FIX = {
    column.name: (place, column)
    for place, column in enumerate(FIXES.columns[1:], 1)
    if column.name != SOURCE
}
UNPLACED: frozenset[PoseMode] = frozenset({"starting", "lost"})


def sample_of(row: Sequence[int]) -> Sample | None:
    """The sample of a row of `POSES`; None where nobody knows where the vehicle is."""
    told = {name: _told(row[place], column) for name, (place, column) in _OF_POSE.items()}
    if told["lat_deg"] is None or told["lon_deg"] is None or told["mode"] in UNPLACED:
        return None
    return Sample(
        t_ns=row[0] * US,
        lat_deg=told["lat_deg"],
        lon_deg=told["lon_deg"],
        alt_m=told["alt_m"],
        alt_std_m=told["alt_std_m"],
        speed_mps=told["speed_mps"],
        speed_std_mps=told["speed_std_mps"],
        distance_m=told["distance_m"] or 0.0,
        position_std_m=math.hypot(told["east_std_m"] or 0.0, told["north_std_m"] or 0.0),
        mode=told["mode"],
        is_engine_off=told[ENGINE] == 0,
    )


def fix_of(row: Sequence[int]) -> GpsFix:
    """The valid fix of a row of `FIXES`."""
    told = {name: _told(row[place], column) for name, (place, column) in _OF_FIX.items()}
    return GpsFix(t_ns=row[0] * US, valid=True, **told)


def _told(steps: int, column: Column) -> Any:
    if steps == NULL:
        return None
    if column.words:
        return column.words[steps]
    if column.is_flag:
        return bool(steps)
    return steps if column.per_unit == 1.0 else steps / column.per_unit
