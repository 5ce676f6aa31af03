"""Reads the lines of a GPX file: tracks, with the speeds at which they were driven, and routes."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from wayline.gpx import GpxLine, GpxPoint, read_gpx
from wayline.line import Line
from wayline_cli.imported_line import ImportedLine

SLOWEST_MPS, FASTEST_MPS = 1.0, 40.0
"""Recorded times are whole seconds and vehicles stand: what they imply is kept within this."""


def lines_of_gpx(path: Path) -> list[ImportedLine]:
    """Tracks and routes. A track whose points all have later and later times has their speeds.

    Raises InputError.
    """
    return [_line(line) for line in read_gpx(path)]


def _line(line: GpxLine) -> ImportedLine:
    vertices = [(point.lat_deg, point.lon_deg) for point in line.points]
    return ImportedLine("", line.name, vertices, _speeds_mps(line.points))


def _speeds_mps(points: Sequence[GpxPoint]) -> list[float] | None:
    times = [point.time for point in points if point.time is not None]
    steps_s = [(after - before).total_seconds() for before, after in pairwise(times)]
    if len(times) < len(points) or not steps_s or min(steps_s) <= 0.0:
        return None
    lats_deg, lons_deg = (np.array([point[at] for point in points]) for at in (0, 1))
    speeds_mps = Line(lats_deg, lons_deg).legs_m / np.array(steps_s)
    return [float(speed) for speed in speeds_mps.clip(SLOWEST_MPS, FASTEST_MPS)]
