"""Pure: rows as the points that people and programs are shown."""

from collections.abc import Iterable
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline_history.chunk import Chunk
from wayline_history.layouts import NULL, Column, Kind

US_PER_S = 1_000_000


class Point(msgspec.Struct, frozen=True, gc=False, kw_only=False):
    """A row of a track; `t` is RFC 3339 UTC with milliseconds, unknown is null."""

    t: str
    lat_deg: float | None
    lon_deg: float | None


class RawPoint(Point, frozen=True, gc=False):
    """A receiver's fix."""

    alt_m: float | None
    speed_mps: float | None
    course_deg: float | None
    fix: str
    mode: int
    satellites: int | None
    hdop: float | None
    h_std_m: float | None
    source: str


class FusedPoint(Point, frozen=True, gc=False):
    """A pose."""

    alt_m: float | None
    heading_deg: float | None
    speed_mps: float | None
    grade_pct: float | None
    distance_m: float
    mode: str
    east_std_m: float | None
    north_std_m: float | None
    alt_std_m: float | None


class OnRoutePoint(Point, frozen=True, gc=False):
    """A place along the route."""

    route_id: str
    trip_id: str | None
    distance_m: float
    lap: int
    cross_track_m: float
    distance_std_m: float
    on_route: bool
    speed_mps: float
    delay_s: float | None


POINTS: dict[Kind, type[Point]] = {
    "raw": RawPoint,
    "fused": FusedPoint,
    "on_route": OnRoutePoint,
}


class Steps:
    """Lets one row pass in so many seconds, over the chunks of a track; all, for 0."""

    def __init__(self, step_s: float) -> None:
        self._step_us = round(step_s * US_PER_S)
        self._last = -1

    def taken(self, chunk: Chunk) -> Chunk:
        """The first row of each step that none was taken of yet."""
        if self._step_us <= 0 or not len(chunk):
            return chunk
        steps = chunk.times_us // self._step_us
        taken = chunk.taken(np.diff(steps, prepend=self._last) > 0)
        self._last = int(steps[-1])
        return taken


def points_of(chunk: Chunk) -> list[Point]:
    """The rows of a chunk as points."""
    struct = POINTS[chunk.layout.kind]
    names = struct.__struct_fields__[1:]
    columns = [shown(chunk, name) for name in names]
    return list(map(struct, times_of(chunk), *columns))


def times_of(chunk: Chunk) -> list[str]:
    """The instants of the rows, RFC 3339 UTC, cut to the millisecond."""
    stamps = chunk.times_us.astype("datetime64[us]").astype("datetime64[ms]")
    texts: list[str] = np.datetime_as_string(stamps, unit="ms", timezone="UTC").tolist()
    return texts


def places_of(chunk: Chunk) -> Chunk:
    """The rows whose place is known."""
    return chunk.taken((chunk.column("lat_deg") != NULL) & (chunk.column("lon_deg") != NULL))


def shown(chunk: Chunk, name: str) -> list[Any]:
    """One quantity of all rows in its unit, None where it is unknown."""
    column = chunk.layout.columns[chunk.layout.place(name)]
    steps = chunk.column(name)
    unknown = steps == NULL
    values = _in_words(column, steps, chunk.texts, unknown)
    if unknown.any():
        return [None if gone else value for value, gone in zip(values, unknown, strict=True)]
    return values


def _in_words(
    column: Column, steps: NDArray[np.int64], texts: Iterable[str], unknown: NDArray[np.bool_]
) -> list[Any]:
    words = tuple(texts) if column.is_text else column.words
    if words:
        return [words[step] for step in np.where(unknown, 0, steps).tolist()]
    values: NDArray[np.generic] = steps
    if column.is_flag:
        values = steps.astype(bool)
    elif column.per_unit != 1.0:
        values = steps / column.per_unit
    told: list[Any] = values.tolist()
    return told
