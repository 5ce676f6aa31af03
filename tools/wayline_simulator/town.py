"""Pure: streets of a town: blocks, corners, bent streets, roundabouts and lights."""

import math
from collections.abc import Sequence

import numpy as np

from wayline_simulator.alignment import (
    Bend,
    Element,
    legs_and_turns,
    length_of,
    round_corners,
    sample,
    straight,
)
from wayline_simulator.country_road import KMH
from wayline_simulator.course import Floats, Halt, Surroundings
from wayline_simulator.road_plan import RoadPlan, bare_plan, line_with
from wayline_simulator.vertical_alignment import Relief, rolling_grade

BLOCK_M = (70.0, 260.0)
"""Between the corners that a vehicle turns at; a judgement from town plans."""
CORNER_RADIUS_M = (8.0, 15.0)
"""Of the vehicle's own path round a kerb; 12 m is the least outer radius of a bus (2007/46/EC)."""
BEND_RADIUS_M = (60.0, 200.0)
BEND_DEG = (8.0, 28.0)
ROUNDABOUT_SHARE = 0.12
"""Of the straights that are long enough."""
ROUNDABOUT_RAD = math.radians(40.0)
ROUNDABOUT_RADIUS_M = 15.0
"""Of the path into, round and out of a single-lane roundabout with 30 m of outer diameter."""
LIGHT_M = (180.0, 450.0)
LIGHT_S = 45.0
LIMITS_MPS = (30.0 * KMH, 40.0 * KMH, 50.0 * KMH)
LIMIT_SHARES = (0.25, 0.25, 0.5)
LIMIT_M = (250.0, 900.0)
SCENERY = (
    Surroundings.STREET,
    Surroundings.TREES,
    Surroundings.OPEN,
    Surroundings.CANYON,
)
SCENERY_SHARES = (0.5, 0.2, 0.18, 0.12)
SCENERY_M = (120.0, 500.0)
RELIEF = Relief(0.05, 0.45, 120.0, 350.0, 700.0, 1300.0, 15.0)
"""5 %; AASHTO's K at 50 km/h is 7 and 13 m/%."""


def town_road(length_m: float, random: np.random.Generator) -> RoadPlan:
    """A road through a town from one end to the other."""
    curvature = sample(_with_roundabouts(_blocks(length_m, random), random))
    plan = bare_plan(curvature, rolling_grade(len(curvature), RELIEF, random), LIMITS_MPS[-1])
    _furnish(plan, random)
    return plan


def town_loop(length_m: float, random: np.random.Generator) -> RoadPlan:
    """Round through a town along its grid and back."""
    shape = _skyline(length_m, random)
    legs_m, _ = legs_and_turns(shape)
    scale = length_m / sum(legs_m)
    radii_m = [random.uniform(*CORNER_RADIUS_M) for _ in legs_m]
    for _ in range(4):
        elements = round_corners(shape * scale, radii_m)
        scale *= length_m / length_of(elements)
    # the first and the last straight are one street, in which the loop begins
    inner = _with_roundabouts(elements[1:-1], random)
    curvature = sample([elements[0], *inner, elements[-1]])
    grade = rolling_grade(len(curvature), RELIEF, random, loop=True)
    plan = bare_plan(curvature, grade, LIMITS_MPS[-1], loop=True)
    _furnish(plan, random)
    return plan


def _blocks(length_m: float, random: np.random.Generator) -> list[Element]:
    """Blocks with corners between; never back, so that no street is crossed twice."""
    elements: list[Element] = [straight(random.uniform(*BLOCK_M))]
    across, lean_rad = 0, 0.0
    while length_of(elements) < length_m:
        if across or random.random() < 0.6:
            side = -across or int(random.choice((-1, 1)))
            across += side
            turns_rad = [side * math.pi / 2.0]
            radius_m = random.uniform(*CORNER_RADIUS_M)
        else:
            size_rad = math.radians(random.uniform(*BEND_DEG))
            turns_rad = [-size_rad if lean_rad > 0.0 else size_rad]
            lean_rad += turns_rad[0]
            radius_m = random.uniform(*BEND_RADIUS_M)
        for turn_rad in turns_rad:
            elements += [*Bend(turn_rad, radius_m).elements(), straight(random.uniform(*BLOCK_M))]
    return elements


def _skyline(length_m: float, random: np.random.Generator) -> Floats:
    """A closed polygon of blocks: out along one row of steps and back along another."""
    columns = max(2, round(length_m / 900.0))
    widths_m = random.uniform(120.0, 260.0, columns)
    edges_m = np.concatenate(([0.0], np.cumsum(widths_m)))
    lower_m = -np.cumsum(_steps_m(columns, random))
    upper_m = 450.0 + np.cumsum(_steps_m(columns, random))
    lower_m, upper_m = lower_m - lower_m.max(), upper_m - upper_m.min() + 200.0
    there = [(edge, y) for i, y in enumerate(lower_m) for edge in edges_m[i : i + 2]]
    back = [(edge, y) for i, y in enumerate(upper_m) for edge in edges_m[i : i + 2]]
    shape = np.array([*there, *reversed(back)])
    return shape + random.uniform(-12.0, 12.0, shape.shape)


def _steps_m(columns: int, random: np.random.Generator) -> Floats:
    """Up and down in turn, so that the rows stay near their first height."""
    signs = np.where(np.arange(columns) % 2 == 0, 1.0, -1.0)
    return signs * random.uniform(90.0, 200.0, columns)


def _roundabout() -> list[Element]:
    """Straight through one: right, round to the left, right; it ends in line with its begin."""
    aside = Bend(ROUNDABOUT_RAD, ROUNDABOUT_RADIUS_M).elements()
    around = Bend(-2.0 * ROUNDABOUT_RAD, ROUNDABOUT_RADIUS_M).elements()
    return [*aside, *around, *aside]


def _with_roundabouts(elements: Sequence[Element], random: np.random.Generator) -> list[Element]:
    """Some of the straights with a roundabout in their middle."""
    inside = _roundabout()
    # two bends in line: each pair of tangents is as wide as its chord
    aside = Bend(ROUNDABOUT_RAD, ROUNDABOUT_RADIUS_M)
    around = Bend(-2.0 * ROUNDABOUT_RAD, ROUNDABOUT_RADIUS_M)
    cosine = math.cos(ROUNDABOUT_RAD)
    chord_m = 2.0 * (aside.tangent_m * (1.0 + cosine) + around.tangent_m * cosine)
    built: list[Element] = []
    for element in elements:
        fits = element.from_per_m == element.to_per_m == 0.0 and element.length_m > 2.5 * chord_m
        if fits and random.random() < ROUNDABOUT_SHARE:
            half = straight((element.length_m - chord_m) / 2.0)
            built += [half, *inside, half]
        else:
            built.append(element)
    return built


def _furnish(plan: RoadPlan, random: np.random.Generator) -> None:
    """Limits, houses and lights."""
    place_m = 0.0
    while place_m < plan.length_m:
        part_m = random.uniform(*LIMIT_M)
        plan.limits_mps[plan.within(place_m, part_m)] = random.choice(LIMITS_MPS, p=LIMIT_SHARES)
        place_m += part_m
    plan.limits_mps[-1] = plan.limits_mps[-2]
    line_with(plan, SCENERY, SCENERY_SHARES, SCENERY_M, random)
    place_m = random.uniform(*LIGHT_M)
    while place_m < plan.length_m - LIGHT_M[0] / 2.0:
        plan.halts.append(Halt(place_m, "light", LIGHT_S))
        place_m += random.uniform(*LIGHT_M)
