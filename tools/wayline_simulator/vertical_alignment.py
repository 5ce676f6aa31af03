"""Pure: the vertical alignment of a road: constant grades joined by parabolas.

On a parabola grade is linear in distance, so a road's grade is piecewise linear throughout.
"""

from typing import NamedTuple

import numpy as np

from wayline_simulator.course import STEP_M, Floats

FIT_SHARE = 0.9
"""Of the shorter neighbour that half of a parabola may take."""
LARGEST_RADIUS = 1.5
"""Vertical curves have up to this many times the least radius; a judgement."""


class Relief(NamedTuple):
    """What the terrain and the design guide make of a road's grades."""

    steepest: float
    """Tangent of the steepest slope."""
    spread: float
    """Std of a grade as a share of the steepest."""
    shortest_m: float
    longest_m: float
    """Between the points where grades change."""
    crest_radius_m: float
    sag_radius_m: float
    """The least: 100 times the guide's K in metres per percent."""
    height_m: float
    """The road turns back to its own level when it is so far above or below."""


def rolling_grade(
    count: int, relief: Relief, random: np.random.Generator, *, loop: bool = False
) -> Floats:
    """Grade of a road through such a terrain, shape (count,), the same at both ends.

    That is level, but for a loop, whose grade integrates to 0.
    """
    stations_m = _stations((count - 1) * STEP_M, relief, random)
    gaps_m = np.diff(stations_m)
    radii = random.uniform(1.0, LARGEST_RADIUS, len(gaps_m) - 1)
    least_m = max(relief.crest_radius_m, relief.sag_radius_m)
    jumps = FIT_SHARE * np.minimum(gaps_m[:-1], gaps_m[1:]) / (radii * least_m)
    grades = _eased(_walk(gaps_m, relief, random), jumps)
    grade = join_grades(count, stations_m[1:-1], grades, relief, radii)
    return close_grade(grade, relief.steepest) if loop else grade


def join_grades(
    count: int, changes_m: Floats, grades: Floats, relief: Relief, radii: Floats | float = 1.0
) -> Floats:
    """Grade of straight slopes that meet at `changes_m`, rounded by parabolas.

    `grades` has one more than changes; `radii` are in terms of the least. A parabola that does not
    fit between its neighbours is shortened.
    """
    jumps = np.diff(grades)
    least_m = np.where(jumps < 0.0, relief.crest_radius_m, relief.sag_radius_m)
    edges_m = np.concatenate(([0.0], changes_m, [(count - 1) * STEP_M]))
    gaps_m = np.diff(edges_m)
    room_m = 0.5 * FIT_SHARE * np.minimum(gaps_m[:-1], gaps_m[1:])
    half_m = np.minimum(0.5 * least_m * radii * np.abs(jumps), room_m)
    knots_m = np.column_stack((changes_m - half_m, changes_m + half_m)).ravel()
    values = np.column_stack((grades[:-1], grades[1:])).ravel()
    places_m = np.arange(count) * STEP_M
    return np.interp(places_m, knots_m, values) if len(knots_m) else np.full(count, grades[0])


def close_grade(grade: Floats, steepest: float) -> Floats:
    """The grade that leads back to its first altitude: without its mean, and not too steep."""
    mean = float(np.mean((grade[:-1] + grade[1:]) / 2.0))
    level = grade - mean
    return level * min(1.0, steepest / max(float(np.max(np.abs(level))), 1e-9))


def _stations(length_m: float, relief: Relief, random: np.random.Generator) -> Floats:
    """Where grades change, from 0 to the length."""
    count = max(2, round(2.0 * length_m / (relief.shortest_m + relief.longest_m)))
    weights = random.uniform(relief.shortest_m, relief.longest_m, count)
    return np.concatenate(([0.0], np.cumsum(weights) * (length_m / weights.sum())))


def _walk(gaps_m: Floats, relief: Relief, random: np.random.Generator) -> Floats:
    """Grades of a random walk of heights that is pulled back; level at both ends."""
    grades = np.zeros(len(gaps_m))
    height_m = 0.0
    for at in range(1, len(gaps_m) - 1):
        pulled = -relief.steepest * height_m / relief.height_m
        wished = random.normal(pulled, relief.spread * relief.steepest)
        grades[at] = min(max(wished, -relief.steepest), relief.steepest)
        height_m += grades[at] * gaps_m[at]
    return grades


def _eased(grades: Floats, jumps: Floats) -> Floats:
    """The grades, flatter where a vertical curve has no room for the jump between two."""
    eased = grades.copy()
    for at in range(1, len(grades)):
        eased[at] = np.clip(eased[at], eased[at - 1] - jumps[at - 1], eased[at - 1] + jumps[at - 1])
    for at in range(len(grades) - 2, -1, -1):
        eased[at] = np.clip(eased[at], eased[at + 1] - jumps[at], eased[at + 1] + jumps[at])
    return eased
