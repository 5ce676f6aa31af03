"""Pure: how the demo's car moves: a lap of town streets with bends, stops and a hill.

The lap begins and ends at rest in the same place, so that it can be driven over and over.
Frame: metres east and north of ORIGIN; headings clockwise from north.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.geo import LocalPlane, wrap_pi

Floats = NDArray[np.float64]

ORIGIN = LocalPlane(39.9052, -75.3400)
"""Swarthmore, Pennsylvania, a kilometre east of the demo's shuttle."""
CORNERS_M = (
    (0.0, 0.0),
    (-80.0, 200.0),
    (50.0, 290.0),
    (100.0, 460.0),
    (340.0, 410.0),
    (290.0, 200.0),
    (420.0, 100.0),
    (350.0, -50.0),
)
"""East and north of the streets' corners, in the order of driving."""
BEND_RADIUS_M = 28.0
STEP_M = 0.5
"""How finely the speed is planned."""
STOPS_M = (480.0, 1240.0)
"""Where the car stops on its way, in metres from the start."""
DWELL_S = 8.0
SPEED_MAX_MPS = 13.9
ACCELERATION_MPS2 = 1.3
BRAKING_MPS2 = 1.8
LATERAL_MPS2 = 2.2
BASE_ALT_M = 58.0
STEEPEST_PCT = 5.0
CLIMB_M = (130.0, 530.0)
"""Where the climb begins and ends; the descent is its mirror image."""
DESCENT_M = (880.0, 1280.0)


class Lap(NamedTuple):
    """Pieces of one curvature each, straight streets and bends in turn; arrays of shape (pieces,).

    The lap begins in the middle of the street that ends at the first corner.
    """

    starts_m: Floats
    east_m: Floats
    north_m: Floats
    heading_rad: Floats
    curvature_per_m: Floats
    """Positive where the street turns right."""
    length_m: float

    def pieces_at(self, distances_m: Floats) -> NDArray[np.intp]:
        """Which piece holds each distance."""
        return np.searchsorted(self.starts_m, distances_m, side="right") - 1


class Timetable(NamedTuple):
    """When the car passes points of the lap; a stop stands in it twice. Shape (points,)."""

    times_s: Floats
    distances_m: Floats
    speeds_mps: Floats


class Motion(NamedTuple):
    """The car at instants, each array of shape (instants,)."""

    times_s: Floats
    distances_m: Floats
    lats_deg: Floats
    lons_deg: Floats
    alts_m: Floats
    headings_deg: Floats
    yaw_rates_degps: Floats
    speeds_mps: Floats
    grades_pct: Floats


def drive_lap(rate_hz: float) -> Motion:
    """One lap from standstill to standstill, sampled from 0 s on."""
    lap = lay_out_lap()
    timetable = plan_lap(lap)
    count = math.floor(float(timetable.times_s[-1]) * rate_hz) + 1
    return _sample(lap, timetable, np.arange(count) / rate_hz)


def lay_out_lap() -> Lap:
    """The streets with a bend of one radius around every corner."""
    corners = [complex(east_m, north_m) for east_m, north_m in CORNERS_M]
    here = (corners[-1] + corners[0]) / 2.0
    start_m, rows = 0.0, []
    for corner, following in zip(corners, [*corners[1:], corners[0]], strict=True):
        heading_rad = _heading_rad(corner - here)
        turn_rad = wrap_pi(_heading_rad(following - corner) - heading_rad)
        cut_m = BEND_RADIUS_M * math.tan(abs(turn_rad) / 2.0)
        bend = corner - cut_m * _direction(heading_rad)
        rows.append((start_m, here.real, here.imag, heading_rad, 0.0))
        start_m += abs(bend - here)
        curvature_per_m = math.copysign(1.0 / BEND_RADIUS_M, turn_rad)
        rows.append((start_m, bend.real, bend.imag, heading_rad, curvature_per_m))
        start_m += BEND_RADIUS_M * abs(turn_rad)
        here = corner + cut_m * _direction(heading_rad + turn_rad)
    first = rows[0]
    rows.append((start_m, here.real, here.imag, first[3], 0.0))
    start_m += abs(complex(first[1], first[2]) - here)
    starts_m, east_m, north_m, heading_rad, curvature_per_m = np.array(rows).T
    return Lap(starts_m, east_m, north_m, heading_rad, curvature_per_m, start_m)


def _heading_rad(step: complex) -> float:
    return math.atan2(step.real, step.imag)


def _direction(heading_rad: float) -> complex:
    return complex(math.sin(heading_rad), math.cos(heading_rad))


def places_at(lap: Lap, distances_m: Floats) -> tuple[Floats, Floats, Floats]:
    """East and north in metres and heading in degrees at distances along the lap."""
    piece = lap.pieces_at(distances_m)
    gone_m = distances_m - lap.starts_m[piece]
    half_turn_rad = lap.curvature_per_m[piece] * gone_m / 2.0
    # from the start of a bend the chord points half the turn to the side
    chord_m = gone_m * np.sinc(half_turn_rad / math.pi)
    bearing_rad = lap.heading_rad[piece] + half_turn_rad
    return (
        lap.east_m[piece] + chord_m * np.sin(bearing_rad),
        lap.north_m[piece] + chord_m * np.cos(bearing_rad),
        np.degrees(bearing_rad + half_turn_rad) % 360.0,
    )


def plan_lap(lap: Lap) -> Timetable:
    """Speed as bends, stops and the car's powers allow, with a dwell at every stop and at the end.

    Between two points the acceleration is constant.
    """
    distances_m = np.linspace(0.0, lap.length_m, round(lap.length_m / STEP_M) + 1)
    stops = [round(stop_m / lap.length_m * (len(distances_m) - 1)) for stop_m in STOPS_M]
    stops = [*stops, len(distances_m) - 1]
    squares = _squared_speeds(lap, distances_m, stops)
    speeds_mps = np.sqrt(squares)
    steps_s = 2.0 * np.diff(distances_m) / (speeds_mps[:-1] + speeds_mps[1:])
    times_s = np.concatenate(([0.0], np.cumsum(steps_s)))
    waited_s = np.zeros_like(times_s)
    for stop in stops:
        waited_s[stop + 1 :] += DWELL_S
    times_s += waited_s
    after = np.array(stops) + 1
    return Timetable(
        np.insert(times_s, after, times_s[stops] + DWELL_S),
        np.insert(distances_m, after, distances_m[stops]),
        np.insert(speeds_mps, after, 0.0),
    )


def _squared_speeds(lap: Lap, distances_m: Floats, stops: list[int]) -> Floats:
    """Squared speeds: what the street allows, then forwards by power and backwards by brakes."""
    curvature = np.abs(lap.curvature_per_m[lap.pieces_at(distances_m)])
    squares = np.minimum(SPEED_MAX_MPS**2, LATERAL_MPS2 / np.maximum(curvature, 1e-9))
    squares[[0, *stops]] = 0.0
    step_m = float(distances_m[1])
    for here in range(1, len(squares)):
        reached = squares[here - 1] + 2.0 * ACCELERATION_MPS2 * step_m
        squares[here] = min(squares[here], reached)
    for here in range(len(squares) - 2, -1, -1):
        reached = squares[here + 1] + 2.0 * BRAKING_MPS2 * step_m
        squares[here] = min(squares[here], reached)
    return squares


def _sample(lap: Lap, timetable: Timetable, times_s: Floats) -> Motion:
    leg = np.searchsorted(timetable.times_s, times_s, side="right") - 1
    leg = np.clip(leg, 0, len(timetable.times_s) - 2)
    since_s = times_s - timetable.times_s[leg]
    gained = np.diff(timetable.speeds_mps)[leg] / np.diff(timetable.times_s)[leg]
    speeds_mps = timetable.speeds_mps[leg] + gained * since_s
    distances_m = (
        timetable.distances_m[leg] + since_s * (timetable.speeds_mps[leg] + speeds_mps) / 2
    )
    # rounding must not carry the last instant over the end
    distances_m = np.minimum(distances_m, lap.length_m)
    east_m, north_m, headings_deg = places_at(lap, distances_m)
    places = [ORIGIN.to_geodetic(*place) for place in zip(east_m, north_m, strict=True)]
    lats_deg, lons_deg = np.array(places).T
    yaw_rates = lap.curvature_per_m[lap.pieces_at(distances_m)] * speeds_mps
    return Motion(
        times_s,
        distances_m,
        lats_deg,
        lons_deg,
        BASE_ALT_M + _climbed_m(distances_m, CLIMB_M) - _climbed_m(distances_m, DESCENT_M),
        headings_deg,
        np.degrees(yaw_rates),
        speeds_mps,
        _grade_pct(distances_m, CLIMB_M) - _grade_pct(distances_m, DESCENT_M),
    )


def _grade_pct(distances_m: Floats, stretch_m: tuple[float, float]) -> Floats:
    """A raised cosine: level, ever steeper up to STEEPEST_PCT in the middle, level again."""
    phase = _phase(distances_m, stretch_m)
    return STEEPEST_PCT * (1.0 - np.cos(2.0 * math.pi * phase)) / 2.0


def _climbed_m(distances_m: Floats, stretch_m: tuple[float, float]) -> Floats:
    """The integral of `_grade_pct`."""
    phase, length_m = _phase(distances_m, stretch_m), stretch_m[1] - stretch_m[0]
    risen = phase - np.sin(2.0 * math.pi * phase) / (2.0 * math.pi)
    return STEEPEST_PCT / 100.0 * length_m * risen / 2.0


def _phase(distances_m: Floats, stretch_m: tuple[float, float]) -> Floats:
    return np.clip((distances_m - stretch_m[0]) / (stretch_m[1] - stretch_m[0]), 0.0, 1.0)
