"""Pure: what a vehicle drives along, sampled every half metre.

A course is laid by integrating curvature and grade over horizontal distance, so that its heading,
position and altitude follow from each other exactly. Its line runs on the WGS84 ellipsoid. Heading
and grade are those of the nose and go on unbroken where the vehicle begins to reverse.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Literal, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from wayline.geo import WGS84

Floats = NDArray[np.float64]
Number = TypeVar("Number", bound=np.generic)

STEP_M = 0.5
"""Between the samples of a course; in a bend of 8 m radius the chord is 4 mm off the arc."""
HaltKind = Literal["stop", "light", "turn", "park"]


class Surroundings(IntEnum):
    """What stands between the antenna and the sky."""

    OPEN = 0
    TREES = 1
    STREET = 2
    """Houses of a few floors on both sides."""
    CANYON = 3
    """High buildings on both sides: reflections."""
    BRIDGE = 4
    """Under a bridge: a blink without satellites."""
    TUNNEL = 5
    GARAGE = 6

    @property
    def covered(self) -> bool:
        """Whether no satellite is seen at all."""
        return self >= Surroundings.BRIDGE


class Halt(NamedTuple):
    """A place where a vehicle stands, or may have to."""

    distance_m: float
    kind: HaltKind
    """A `light` may be green; at a `turn` the direction of travel changes."""
    dwell_s: float
    """How long, on average; of a `light` the longest wait."""
    name: str = ""
    """Of a stop."""


@dataclass(frozen=True, slots=True)
class Course:
    """Samples at `distances_m`, STEP_M apart from 0, shape (n,) each."""

    distances_m: Floats
    """Horizontal, along the line."""
    lats_deg: Floats
    lons_deg: Floats
    headings_rad: Floats
    """Of the nose, true, clockwise from north, unwrapped."""
    curvature_per_m: Floats
    """Turn of the nose to the right for every metre gone, forwards or backwards; geodesic, which
    is what a gyro feels."""
    alts_m: Floats
    grade: Floats
    """Tangent of the slope in the direction of the nose."""
    limits_mps: Floats
    """What is allowed there, or what a sensible driver would do in a garage."""
    surroundings: NDArray[np.int8]
    backwards: NDArray[np.bool_]
    """Driven in reverse from this sample to the next."""
    halts: tuple[Halt, ...]
    """In order of distance."""
    loop: bool = False
    """Whether the course ends where it begins."""

    @property
    def length_m(self) -> float:
        """From the first sample to the last."""
        return float(self.distances_m[-1])


def lay_course(
    *,
    lat_deg: float,
    lon_deg: float,
    heading_deg: float,
    alt_m: float,
    curvature_per_m: Floats,
    grade: Floats,
    limits_mps: Floats,
    surroundings: NDArray[np.int8],
    backwards: NDArray[np.bool_] | None = None,
    halts: Sequence[Halt] = (),
    loop: bool = False,
) -> Course:
    """The course that begins at a place and bends and climbs as given, all of shape (n,)."""
    count = len(curvature_per_m)
    reversing = np.zeros(count, dtype=np.bool_) if backwards is None else backwards
    signs = np.where(reversing[:-1], -1.0, 1.0)
    turned_rad = np.radians(heading_deg) + _integral(curvature_per_m, np.ones_like(signs))
    lats_deg, lons_deg, headings_rad = _on_ellipsoid(lat_deg, lon_deg, turned_rad, signs)
    return Course(
        distances_m=np.arange(count, dtype=np.float64) * STEP_M,
        lats_deg=lats_deg,
        lons_deg=lons_deg,
        headings_rad=headings_rad,
        curvature_per_m=np.asarray(curvature_per_m, dtype=np.float64),
        alts_m=alt_m + _integral(grade, signs),
        grade=np.asarray(grade, dtype=np.float64),
        limits_mps=np.asarray(limits_mps, dtype=np.float64),
        surroundings=np.asarray(surroundings, dtype=np.int8),
        backwards=reversing,
        halts=tuple(sorted(halts)),
        loop=loop,
    )


def repeated(course: Course, laps: int) -> Course:
    """A loop driven so many times without a break; halts come again in every lap."""
    if laps == 1:
        return course
    count = len(course.distances_m) - 1
    round_rad = course.headings_rad[-1] - course.headings_rad[0]
    lap = np.repeat(np.arange(laps), count)
    length_m = course.length_m

    def again(values: NDArray[Number]) -> NDArray[Number]:
        return np.append(np.tile(values[:-1], laps), values[-1:])

    return Course(
        distances_m=np.arange(laps * count + 1, dtype=np.float64) * STEP_M,
        lats_deg=again(course.lats_deg),
        lons_deg=again(course.lons_deg),
        headings_rad=again(course.headings_rad) + round_rad * np.append(lap, laps - 1),
        curvature_per_m=again(course.curvature_per_m),
        alts_m=again(course.alts_m),
        grade=again(course.grade),
        limits_mps=again(course.limits_mps),
        surroundings=again(course.surroundings),
        backwards=again(course.backwards),
        halts=tuple(
            halt._replace(distance_m=halt.distance_m + number * length_m)
            for number in range(laps)
            for halt in course.halts
        ),
        loop=True,
    )


def _integral(values: Floats, signs: Floats) -> Floats:
    """Over distance by the trapezoidal rule, 0 at the first sample; `signs` of shape (n - 1,)."""
    return np.concatenate(([0.0], np.cumsum(signs * (values[:-1] + values[1:]) * (STEP_M / 2.0))))


def _on_ellipsoid(
    lat_deg: float, lon_deg: float, turned_rad: Floats, signs: Floats
) -> tuple[Floats, Floats, Floats]:
    """Latitudes, longitudes and true headings of a line that turns as given.

    A straight line's azimuth changes with the meridians, by sin(azimuth) tan(lat) / N a metre; the
    first pass takes the first latitude for all, the second those of the first.
    """
    lats_rad = np.full(len(turned_rad), np.radians(lat_deg))
    headings_rad = turned_rad
    for _ in range(2):
        transverse_m = WGS84.a / np.sqrt(1.0 - WGS84.es * np.sin(lats_rad) ** 2)
        convergence = np.sin(headings_rad) * np.tan(lats_rad) / transverse_m
        headings_rad = turned_rad + _integral(convergence, signs)
        meridian_m = transverse_m**3 * (1.0 - WGS84.es) / WGS84.a**2
        lats_rad = np.radians(lat_deg) + _integral(np.cos(headings_rad) / meridian_m, signs)
    parallel_m = transverse_m * np.cos(lats_rad)
    lons_rad = np.radians(lon_deg) + _integral(np.sin(headings_rad) / parallel_m, signs)
    return np.degrees(lats_rad), np.degrees(lons_rad), headings_rad
