"""Pure: tracks as documents, a part at a time: JSON, GPX, CSV, GeoJSON."""

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from xml.sax.saxutils import escape

import msgspec
import numpy as np

from wayline.rfc3339 import rfc3339
from wayline_history.chunk import Chunk
from wayline_history.instants import Stretch
from wayline_history.layouts import US, TrackKind
from wayline_history.points import POINTS, Steps, places_of, points_of, shown, times_of
from wayline_history.questions import Format

BREAK_US = 600_000_000
"""After such a silence, a line goes on as another one."""
WITHOUT_LIMIT = 2**53
Reread = Callable[[], Iterable[Chunk]]


def document_of(
    form: Format, vehicle_id: str, kind: TrackKind, stretch: Stretch, reread: Reread
) -> Iterator[bytes]:
    """A track as a file, a part at a time; what is wrong with reading it is raised at once.

    `reread` reads the track anew each time.
    """
    chunks = begun(reread())
    match form:
        case "gpx":
            return gpx_track(vehicle_id, kind, chunks)
        case "csv":
            return csv_track(kind, chunks)
        case "geojson":
            return geojson_track(vehicle_id, kind, stretch, reread)
        case "json":
            return json_track(vehicle_id, kind, stretch, chunks, WITHOUT_LIMIT)


def begun(chunks: Iterable[Chunk]) -> Iterator[Chunk]:
    """The chunks, of which the first has been read."""
    stream = iter(chunks)
    first = list(itertools.islice(stream, 1))
    return itertools.chain(first, stream)


def json_track(
    vehicle_id: str, kind: TrackKind, stretch: Stretch, chunks: Iterable[Chunk], limit: int
) -> Iterator[bytes]:
    """`points` in order of time, at most so many; `next` is from when on the rest is, or null."""
    head = {
        "vehicle_id": vehicle_id,
        "kind": kind,
        "from": rfc3339(stretch.from_ns),
        "to": rfc3339(stretch.to_ns),
    }
    yield msgspec.json.encode(head)[:-1] + b',"points":['
    left, follows, next_us = limit, False, None
    for chunk in chunks:
        told = chunk.taken(slice(left))
        left -= len(told)
        if len(told):
            yield (b"," if follows else b"") + msgspec.json.encode(points_of(told))[1:-1]
            follows = True
        if len(told) < len(chunk):
            next_us = int(chunk.times_us[len(told)])
            break
    tail = None if next_us is None else f"{rfc3339(next_us * US)[:-1]}{next_us % 1000:03d}Z"
    yield b'],"next":' + msgspec.json.encode(tail) + b"}"


def csv_track(kind: TrackKind, chunks: Iterable[Chunk]) -> Iterator[bytes]:
    """A header with the names of the points' fields, then a row a point; unknown is empty."""
    names = POINTS[kind].__struct_fields__
    yield (",".join(names) + "\n").encode()
    for chunk in chunks:
        columns = [times_of(chunk), *(map(_cell, shown(chunk, name)) for name in names[1:])]
        lines = map(",".join, zip(*columns, strict=True))
        yield ("\n".join(lines) + "\n").encode()


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    text = str(value)
    return '"' + text.replace('"', '""') + '"' if any(mark in text for mark in ',"\n\r') else text


def gpx_track(vehicle_id: str, kind: TrackKind, chunks: Iterable[Chunk]) -> Iterator[bytes]:
    """A GPX 1.1 track, a segment between silences."""
    yield (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<gpx version="1.1" creator="Wayline" xmlns="http://www.topografix.com/GPX/1/1">\n'
        f"<trk><name>{escape(vehicle_id)}</name><type>{kind}</type>\n"
    ).encode()
    is_open = False
    for part, continues in _parts(chunks):
        if not continues:
            yield b"</trkseg>\n<trkseg>\n" if is_open else b"<trkseg>\n"
        is_open = True
        yield "".join(_gpx_points(part)).encode()
    yield (b"</trkseg>\n" if is_open else b"") + b"</trk>\n</gpx>\n"


def _gpx_points(chunk: Chunk) -> Iterator[str]:
    alts = shown(chunk, "alt_m") if _has(chunk, "alt_m") else [None] * len(chunk)
    rows = zip(shown(chunk, "lat_deg"), shown(chunk, "lon_deg"), alts, times_of(chunk), strict=True)
    for lat_deg, lon_deg, alt_m, t in rows:
        ele = "" if alt_m is None else f"<ele>{alt_m}</ele>"
        yield f'<trkpt lat="{lat_deg:.7f}" lon="{lon_deg:.7f}">{ele}<time>{t}</time></trkpt>\n'


def geojson_track(
    vehicle_id: str, kind: TrackKind, stretch: Stretch, reread: Reread
) -> Iterator[bytes]:
    """A MultiLineString, a line between silences, cut where it crosses the 180th meridian.

    `coordTimes` of its properties has the instants in the shape of its coordinates. `reread`
    reads the track anew each time.
    """
    yield (
        b'{"type":"FeatureCollection","features":[{"type":"Feature",'
        b'"geometry":{"type":"MultiLineString","coordinates":['
    )
    yield from _lines(reread(), _coordinates)
    head = {
        "vehicle_id": vehicle_id,
        "kind": kind,
        "from": rfc3339(stretch.from_ns),
        "to": rfc3339(stretch.to_ns),
    }
    yield b']},"properties":' + msgspec.json.encode(head)[:-1] + b',"coordTimes":['
    yield from _lines(reread(), times_of)
    yield b"]}}]}"


def _coordinates(chunk: Chunk) -> Sequence[Sequence[float]]:
    lons, lats = shown(chunk, "lon_deg"), shown(chunk, "lat_deg")
    if not _has(chunk, "alt_m"):
        return list(zip(lons, lats, strict=True))
    alts = shown(chunk, "alt_m")
    return [
        (lon, lat) if alt is None else (lon, lat, alt)
        for lon, lat, alt in zip(lons, lats, alts, strict=True)
    ]


def _lines(chunks: Iterable[Chunk], told: Callable[[Chunk], Sequence[object]]) -> Iterator[bytes]:
    """Lists of what is told of each row, a list a line; a line of one place has it twice."""
    count, last = 0, b""
    for part, continues in _parts(chunks):
        items = msgspec.json.encode(told(part))[1:-1]
        if continues:
            yield b"," + items
            count += len(part)
            continue
        if count:
            yield (b"," + last if count == 1 else b"") + b"],"
        yield b"[" + items
        count, last = len(part), items
    if count:
        yield (b"," + last if count == 1 else b"") + b"]"


def _parts(chunks: Iterable[Chunk]) -> Iterator[tuple[Chunk, bool]]:
    """Rows of known place in parts without a break, and whether each goes on from the last."""
    before: tuple[int, int] | None = None
    half = 180 * 10**7
    for chunk in chunks:
        known = places_of(chunk)
        if not len(known):
            continue
        times, lons = known.times_us, known.column("lon_deg")
        is_broken = (np.diff(times) > BREAK_US) | (np.abs(np.diff(lons)) > half)
        cuts = [0, *(np.flatnonzero(is_broken) + 1).tolist(), len(known)]
        for first, last in pairwise(cuts):
            here = int(times[first]), int(lons[first])
            continues = (
                before is not None
                and here[0] - before[0] <= BREAK_US
                and abs(here[1] - before[1]) <= half
            )
            yield known.taken(slice(first, last)), continues and first == 0
            before = int(times[last - 1]), int(lons[last - 1])


def _has(chunk: Chunk, name: str) -> bool:
    return any(column.name == name for column in chunk.layout.columns)


def stepped(chunks: Iterable[Chunk], step_s: float) -> Iterator[Chunk]:
    """The rows of a track, one in so many seconds."""
    steps = Steps(step_s)
    for chunk in chunks:
        taken = steps.taken(chunk)
        if len(taken):
            yield taken
