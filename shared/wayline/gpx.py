"""Reads the lines of a GPX file (1.0 and 1.1): tracks as they were recorded, routes as planned."""

import datetime as dt
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree as XmlTree

from wayline.errors import InputError
from wayline.text_file import read_text

DECLARATION = re.compile(r"^\s*<\?xml[^>]*\?>")
"""Names an encoding, which text no longer has."""
MEND = "name a GPX file with a track or a route"


class GpxPoint(NamedTuple):
    """A point of a line; None where the file does not tell."""

    lat_deg: float
    lon_deg: float
    alt_m: float | None
    time: dt.datetime | None


class GpxLine(NamedTuple):
    """A track, its segments joined, or a route."""

    name: str
    points: list[GpxPoint]


def read_gpx(path: Path) -> list[GpxLine]:
    """The tracks and routes that have points, in the order of the file. Raises InputError."""
    text = DECLARATION.sub("", read_text(path))
    try:
        root = XmlTree.fromstring(text)  # noqa: S314  -- the user's own file
        lines = [_line(node) for node in root.iter() if _name(node) in ("trk", "rte")]
    except (XmlTree.ParseError, KeyError, ValueError) as error:
        raise InputError(str(path), f"is not GPX ({error})", MEND) from None
    return [line for line in lines if line.points]


def _line(node: XmlTree.Element) -> GpxLine:
    return GpxLine((node.findtext("{*}name") or "").strip(), list(_points(node)))


def _points(line: XmlTree.Element) -> Iterator[GpxPoint]:
    for node in line.iter():
        if _name(node) in ("trkpt", "rtept"):
            alt = node.findtext("{*}ele")
            yield GpxPoint(
                float(node.attrib["lat"]),
                float(node.attrib["lon"]),
                float(alt) if alt else None,
                _time(node.findtext("{*}time")),
            )


def _time(text: str | None) -> dt.datetime | None:
    try:
        time = dt.datetime.fromisoformat((text or "").strip())
    except ValueError:
        return None
    return time if time.tzinfo else time.replace(tzinfo=dt.UTC)


def _name(node: XmlTree.Element) -> str:
    return str(node.tag).rpartition("}")[2]
