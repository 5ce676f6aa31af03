"""Pure: what a course is laid with along a line of points on the ellipsoid."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from pyproj import Proj

from wayline.errors import InputError
from wayline.line import Line
from wayline.stops import Stop
from wayline_simulator.closing import Start
from wayline_simulator.course import STEP_M, Floats
from wayline_simulator.plane_curve import (
    LEAST_RADIUS_M,
    Curve,
    TooTightError,
    blurred,
    smooth_curve,
)

LEAST_LENGTH_M = 50.0
ALTITUDE_SMOOTH_M = 25.0
"""Std of the Gaussian over altitudes: grade then changes over the length of a vertical curve."""


class LinePoints(NamedTuple):
    """What a file says about a line, shape (n,) each; `speeds_mps` belong to legs, (n - 1,)."""

    lats_deg: Floats
    lons_deg: Floats
    alts_m: Floats | None
    speeds_mps: Floats | None


class LineFile(NamedTuple):
    """What a file tells of a road."""

    points: LinePoints
    stops: tuple[Stop, ...]
    loop: bool


@dataclass(frozen=True, slots=True)
class SmoothLine:
    """Samples every STEP_M of a line that can be driven, shape (n,) each."""

    start: Start
    curvature_per_m: Floats
    grade: Floats | None
    source_m: Floats
    """Where along the file's line (wayline.line.Line) each sample is from; only grows."""


def smooth_line(where: str, points: LinePoints, *, loop: bool) -> SmoothLine:
    """The line of a file, drivable. Raises InputError, naming `where`, where it is not to be had.

    A loop whose last point is not its first goes straight back to it.
    """
    points = _closed(points) if loop else points
    along_m = Line(points.lats_deg, points.lons_deg).distances_m
    if along_m[-1] < LEAST_LENGTH_M:
        what = f"a line of {along_m[-1]:.0f} m"
        raise InputError(where, what, f"give one of {LEAST_LENGTH_M:g} m or more")
    plane = Proj(
        proj="tmerc", ellps="WGS84", lat_0=np.mean(points.lats_deg), lon_0=np.mean(points.lons_deg)
    )
    east_m, north_m = plane(points.lons_deg, points.lats_deg)
    try:
        curve = smooth_curve(np.asarray(east_m), np.asarray(north_m), along_m, loop=loop)
    except TooTightError as error:
        lon_deg, lat_deg = plane(error.east_m, error.north_m, inverse=True)
        what = f"turns back on itself near latitude {lat_deg:.5f}, longitude {lon_deg:.5f}"
        raise InputError(where, what, f"draw a bend of {LEAST_RADIUS_M:g} m there") from None
    alts_m = None
    if points.alts_m is not None:
        alts_m = _altitudes(curve, along_m, points.alts_m, loop=loop)
    return _sampled(plane, curve, alts_m)


def _closed(points: LinePoints) -> LinePoints:
    """The points of a loop, the last in the first's place; what altitude differs is spread."""
    lats_deg, lons_deg, alts_m = points.lats_deg, points.lons_deg, points.alts_m
    if lats_deg[0] != lats_deg[-1] or lons_deg[0] != lons_deg[-1]:
        lats_deg, lons_deg = np.append(lats_deg, lats_deg[0]), np.append(lons_deg, lons_deg[0])
        alts_m = None if alts_m is None else np.append(alts_m, alts_m[0])
    if alts_m is not None:
        along_m = Line(lats_deg, lons_deg).distances_m
        alts_m = alts_m - (alts_m[-1] - alts_m[0]) * along_m / along_m[-1]
    return LinePoints(lats_deg, lons_deg, alts_m, points.speeds_mps)


def _altitudes(curve: Curve, along_m: Floats, alts_m: Floats, *, loop: bool) -> Floats:
    """At the samples of the curve, smooth."""
    period_m = float(along_m[-1]) if loop else None
    places = (along_m[:-1], alts_m[:-1]) if loop else (along_m, alts_m)
    rough_m = np.interp(curve.places_m, *places, period=period_m)
    step_m = float(np.mean(np.hypot(np.diff(curve.east_m), np.diff(curve.north_m))))
    return blurred(rough_m, ALTITUDE_SMOOTH_M / step_m)


def _sampled(plane: Proj, curve: Curve, alts_m: Floats | None) -> SmoothLine:
    """Every STEP_M of true distance, as a course wants it: turn and climb for every metre."""
    lons_deg, lats_deg = plane(curve.east_m, curve.north_m, inverse=True)
    true_m = Line(lats_deg, lons_deg).distances_m
    first_m, last_m = true_m[curve.within][[0, -1]]
    # the line is stretched by less than half a step to a whole number of steps
    at_m = np.linspace(first_m, last_m, round((last_m - first_m) / STEP_M) + 1)
    headings_rad, turned_rad = _headings_rad(plane, curve, lons_deg, lats_deg)
    heights_m = None if alts_m is None else np.interp(at_m, true_m, alts_m)
    start = Start(
        float(np.interp(first_m, true_m, lats_deg)),
        float(np.interp(first_m, true_m, lons_deg)),
        math.degrees(np.interp(first_m, true_m, headings_rad)),
        0.0 if heights_m is None else float(heights_m[0]),
    )
    return SmoothLine(
        start=start,
        # differences over two steps, so that their trapezoidal sum is the turn again
        curvature_per_m=np.gradient(np.interp(at_m, true_m, turned_rad), STEP_M),
        grade=None if heights_m is None else np.gradient(heights_m, STEP_M),
        source_m=np.interp(at_m, true_m, curve.places_m),
    )


def _headings_rad(
    plane: Proj, curve: Curve, lons_deg: Floats, lats_deg: Floats
) -> tuple[Floats, Floats]:
    """True headings, and what of their change is the road's own turning.

    The projection is conformal: a true heading is the plane's plus the meridians' convergence. Of
    a straight line the azimuth changes by d(lon) sin(lat), which is not a turn.
    """
    grid_rad = np.unwrap(np.arctan2(np.gradient(curve.east_m), np.gradient(curve.north_m)))
    factors = plane.get_factors(lons_deg, lats_deg)
    headings_rad = grid_rad + np.radians(factors.meridian_convergence)
    middle = np.sin(np.radians((lats_deg[:-1] + lats_deg[1:]) / 2.0))
    swept_rad = np.concatenate(([0.0], np.cumsum(np.radians(np.diff(lons_deg)) * middle)))
    return headings_rad, headings_rad - swept_rad
