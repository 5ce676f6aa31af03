"""Pure: poses and fixes as trips see them: as kept, so that live and from the store agree."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from wayline.messages import FixKind, GpsFix, PoseMode
from wayline_history.layouts import ENGINE, FIXES, NULL, POSES, US, Column


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


_PLACES = {column.name: place for place, column in enumerate(POSES.columns)}
_PER_UNIT = {column.name: column.per_unit for column in POSES.columns}
_FIX_KIND = FIXES.place("fix")
_KINDS = FIXES.columns[_FIX_KIND].words
_MODES = POSES.columns[_PLACES["mode"]].words
_OF_FIX = {
    column.name: (place, column)
    for place, column in enumerate(FIXES.columns)
    if place and not column.is_text and not column.words
}
UNPLACED: frozenset[PoseMode] = frozenset({"starting", "lost"})


def sample_of(row: Sequence[int]) -> Sample | None:
    """The sample of a row of `POSES`; None where nobody knows where the vehicle is."""
    mode: PoseMode = _MODES[row[_PLACES["mode"]]]  # type: ignore[assignment]
    lat_deg, lon_deg = _unit(row, "lat_deg"), _unit(row, "lon_deg")
    if lat_deg is None or lon_deg is None or mode in UNPLACED:
        return None
    stds_m = [_unit(row, name) or 0.0 for name in ("east_std_m", "north_std_m")]
    return Sample(
        t_ns=row[0] * US,
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        alt_m=_unit(row, "alt_m"),
        alt_std_m=_unit(row, "alt_std_m"),
        speed_mps=_unit(row, "speed_mps"),
        speed_std_mps=_unit(row, "speed_std_mps"),
        distance_m=_unit(row, "distance_m") or 0.0,
        position_std_m=math.hypot(*stds_m),
        mode=mode,
        is_engine_off=row[_PLACES[ENGINE]] == 0,
    )


def fix_of(row: Sequence[int]) -> GpsFix:
    """The fix of a row of `FIXES`, as far as it was kept."""
    known: dict[str, Any] = {
        name: _told(row[place], column)
        for name, (place, column) in _OF_FIX.items()
        if row[place] != NULL
    }
    fix: FixKind = _KINDS[row[_FIX_KIND]]  # type: ignore[assignment]
    return GpsFix(t_ns=row[0] * US, valid=not known["repeat"], fix=fix, **known)


def _told(steps: int, column: Column) -> float | bool:
    if column.is_flag:
        return bool(steps)
    return steps if column.per_unit == 1.0 else steps / column.per_unit


def _unit(row: Sequence[int], name: str) -> float | None:
    steps = row[_PLACES[name]]
    return None if steps == NULL else steps / _PER_UNIT[name]
