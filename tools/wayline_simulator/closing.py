"""Pure: makes a road that nearly ends where it begins do so on the ellipsoid."""

import math
from typing import NamedTuple

import numpy as np

from wayline.geo import metres_per_degree
from wayline_simulator.course import STEP_M, Course, Floats, lay_course

PASSES = 4
"""Passes of Newton's method; the second is already below a millimetre for a gap of metres."""


class Start(NamedTuple):
    """Where a road begins and which way."""

    lat_deg: float
    lon_deg: float
    heading_deg: float
    alt_m: float


class Gap(NamedTuple):
    """How far a road's end is from its beginning."""

    east_m: float
    north_m: float
    turn_rad: float
    """From the nearest whole number of turns."""


def gap_of(course: Course) -> Gap:
    """How well a loop closes in the plane."""
    north_m, east_m = metres_per_degree(float(course.lats_deg[0]))
    turned = float(course.headings_rad[-1] - course.headings_rad[0])
    return Gap(
        float(course.lons_deg[-1] - course.lons_deg[0]) * east_m,
        float(course.lats_deg[-1] - course.lats_deg[0]) * north_m,
        math.remainder(turned, 2.0 * math.pi),
    )


def close_curvature(curvature_per_m: Floats, start: Start) -> Floats:
    """The curvature, bent by a trace, of a road that ends in its beginning's place and heading.

    What is added is smooth, 0 at both ends, and a combination of 1, east and north: a turn at a
    place moves the end by the lever arm between the two, so these three steer it independently.
    """
    count = len(curvature_per_m)
    window = np.sin(np.linspace(0.0, math.pi, count)) ** 2
    first = _laid(curvature_per_m, start)
    shapes = np.stack(
        [window, window * _centred(first.lons_deg), window * _centred(first.lats_deg)]
    )
    shapes /= count * STEP_M
    shares = np.zeros(3)
    for _ in range(PASSES):
        gap = _gap(curvature_per_m + shares @ shapes, start)
        slopes = np.column_stack(
            [
                (_gap(curvature_per_m + (shares + nudge) @ shapes, start) - gap) / nudge.max()
                for nudge in 1e-4 * np.eye(3)
            ]
        )
        shares -= np.linalg.solve(slopes, gap)
    return np.asarray(curvature_per_m + shares @ shapes, dtype=np.float64)


def _laid(curvature_per_m: Floats, start: Start) -> Course:
    level = np.zeros(len(curvature_per_m))
    return lay_course(
        **start._asdict(),
        curvature_per_m=curvature_per_m,
        grade=level,
        limits_mps=level,
        surroundings=level.astype(np.int8),
    )


def _gap(curvature_per_m: Floats, start: Start) -> Floats:
    return np.array(gap_of(_laid(curvature_per_m, start)))


def _centred(values: Floats) -> Floats:
    centred = values - values.mean()
    return np.asarray(centred / np.max(np.abs(centred)), dtype=np.float64)
