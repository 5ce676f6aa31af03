"""Collects rows of entities and sends them to Rerun by the column.

A call of `log` costs Rerun about 100 us whatever it holds; a column of a thousand rows costs
hardly more, so rows wait for `batch_s` of measurement time.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import rerun as rr

from wayline.rerun_view.shapes import Line
from wayline.rerun_view.styles import Colour, style_of

TIMELINE = "measurement_time"
"""Every row lies on it: `t_ns` as a timestamp."""

Encode = Callable[[Sequence[Any]], rr.ComponentColumnList]


def _scalars(rows: Sequence[tuple[float, ...]]) -> rr.ComponentColumnList:
    values = np.array(rows, dtype=np.float64)
    return rr.Scalars.columns(scalars=values.ravel()).partition([values.shape[1]] * len(rows))


def _states(rows: Sequence[str]) -> rr.ComponentColumnList:
    return rr.StateChange.columns(state=rows)


def _points(rows: Sequence[tuple[float, float]]) -> rr.ComponentColumnList:
    return rr.GeoPoints.columns(positions=np.array(rows, dtype=np.float64))


def _lines(rows: Sequence[Line]) -> rr.ComponentColumnList:
    return rr.GeoLineStrings.columns(line_strings=list(rows))


def _texts(rows: Sequence[str]) -> rr.ComponentColumnList:
    return rr.TextLog.columns(text=rows)


class SkyPoint(NamedTuple):
    """A satellite in a sky plot."""

    place: tuple[float, float]
    """Right and down of the zenith."""
    colour: Colour
    name: str


def _skies(rows: Sequence[Sequence[SkyPoint]]) -> rr.ComponentColumnList:
    points = [point for row in rows for point in row]
    columns = rr.Points2D.columns(
        positions=[point.place for point in points],
        colors=[point.colour for point in points],
        labels=[point.name for point in points],
    )
    return columns.partition([len(row) for row in rows])


class _Column(NamedTuple):
    encode: Encode
    times_ns: list[int]
    rows: list[Any]


class Columns:
    """The entities of one vehicle below its id, and their rows not yet sent."""

    def __init__(self, stream: rr.RecordingStream, vehicle_id: str, batch_s: float) -> None:
        self._stream = stream
        self._root = vehicle_id
        self._batch_ns = round(batch_s * 1e9)
        self._columns: dict[str, _Column] = {}
        self._styled: set[str] = set()
        self._batch_start_ns: int | None = None
        self.rows_sent = 0

    def scalars(self, path: str, t_ns: int, *values: float) -> None:
        """A row of a plot: one value a line; an entity has always the same number of them."""
        self._add(path, _scalars, t_ns, values)

    def state(self, path: str, t_ns: int, state: str) -> None:
        """The state that begins."""
        self._add(path, _states, t_ns, state)

    def text(self, path: str, t_ns: int, text: str) -> None:
        """A line of a log."""
        self._add(path, _texts, t_ns, text)

    def point(self, path: str, t_ns: int, lat_deg: float, lon_deg: float) -> None:
        """A point on the map."""
        self._add(path, _points, t_ns, (lat_deg, lon_deg))

    def line(self, path: str, t_ns: int, line: Line) -> None:
        """A line on the map."""
        self._add(path, _lines, t_ns, line)

    def sky(self, path: str, t_ns: int, points: Sequence[SkyPoint]) -> None:
        """All satellites of an instant in a sky plot."""
        self._add(path, _skies, t_ns, points)

    def static(self, path: str, *archetypes: rr.AsComponents) -> None:
        """What holds at all times; sent at once."""
        self._style(path)
        self._stream.log(self._entity(path), *archetypes, static=True)

    def send_when_due(self, t_ns: int) -> None:
        """Send what waits when it spans a batch; a clock that stepped back ends a batch too."""
        if self._batch_start_ns is None:
            self._batch_start_ns = t_ns
        elif abs(t_ns - self._batch_start_ns) >= self._batch_ns:
            self.send()
            self._batch_start_ns = t_ns

    def send(self) -> None:
        """Send what waits."""
        for path, column in self._columns.items():
            if not column.rows:
                continue
            self._style(path)
            times = np.array(column.times_ns, dtype="datetime64[ns]")
            index = rr.TimeColumn(TIMELINE, timestamp=times)
            self._stream.send_columns(self._entity(path), [index], column.encode(column.rows))
            self.rows_sent += len(column.rows)
            column.times_ns.clear()
            column.rows.clear()

    def _style(self, path: str) -> None:
        """Send the look of an entity before its first row."""
        if path in self._styled:
            return
        self._styled.add(path)
        style = style_of(path)
        if style is not None:
            self._stream.log(self._entity(path), style, static=True)

    def _entity(self, path: str) -> str:
        return rr.new_entity_path([self._root, *path.split("/")])

    def _add(self, path: str, encode: Encode, t_ns: int, row: object) -> None:
        column = self._columns.get(path)
        if column is None:
            column = self._columns[path] = _Column(encode, [], [])
        column.times_ns.append(t_ns)
        column.rows.append(row)
