"""Pure: roads between towns, after their design guides: motorways, main roads, hills."""

import math
from typing import NamedTuple

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
from wayline_simulator.course import Floats, Halt, Surroundings
from wayline_simulator.road_plan import RoadPlan, bare_plan, cross_bridges, line_with
from wayline_simulator.vertical_alignment import Relief, rolling_grade

KMH = 1.0 / 3.6
SCENERY = (Surroundings.OPEN, Surroundings.TREES)
SCENERY_M = (150.0, 1200.0)
"""How long fields and woods are; a judgement."""
WANDER_RAD = math.radians(65.0)
"""An open road keeps this near its first heading, so that it never crosses itself."""
FITTINGS = 4
"""Rounds in which a loop is scaled to its length; each leaves a hundredth of the error."""
VILLAGE_LIGHT_S = 40.0


class Design(NamedTuple):
    """What a class of road looks like."""

    limits_mps: tuple[float, ...]
    limit_m: tuple[float, float]
    """How long one limit holds."""
    radii_m: tuple[float, float]
    """The least is AASHTO's v^2 / (g (e + f)) at 6 % superelevation, or what a guide tolerates."""
    tangents_m: tuple[float, float]
    turns_deg: tuple[float, float]
    relief: Relief
    tunnels_m: tuple[float, float]
    bridge_spacing_m: float
    trees: float
    """Share of the road that leads through woods."""
    village_spacing_m: float | None


MOTORWAY = Design(
    limits_mps=(110.0 * KMH, 120.0 * KMH, 130.0 * KMH),
    limit_m=(3000.0, 9000.0),
    # 756 m at 120 km/h with f = 0.09 (AASHTO Green Book)
    radii_m=(800.0, 4000.0),
    tangents_m=(100.0, 1200.0),
    turns_deg=(8.0, 45.0),
    # AASHTO's K at 120 km/h is 95 and 63 m/%; 4 % is a motorway's steepest in rolling terrain
    relief=Relief(0.04, 0.5, 500.0, 1500.0, 9500.0, 6300.0, 35.0),
    tunnels_m=(300.0, 1500.0),
    bridge_spacing_m=2500.0,
    trees=0.35,
    village_spacing_m=None,
)
MAIN = Design(
    limits_mps=(70.0 * KMH, 80.0 * KMH, 90.0 * KMH),
    limit_m=(1200.0, 4000.0),
    # 123 m at 60 km/h with f = 0.17: the bends that a 70 road warns of
    radii_m=(150.0, 800.0),
    tangents_m=(40.0, 500.0),
    turns_deg=(15.0, 70.0),
    # K at 80 km/h is 26 and 30 m/%
    relief=Relief(0.06, 0.5, 250.0, 800.0, 2600.0, 3000.0, 25.0),
    tunnels_m=(150.0, 800.0),
    bridge_spacing_m=6000.0,
    trees=0.5,
    village_spacing_m=5000.0,
)
HILLS = MAIN._replace(
    limits_mps=(70.0 * KMH, 80.0 * KMH),
    # K at 70 km/h is 17 and 23 m/%
    relief=Relief(0.07, 0.8, 350.0, 900.0, 1700.0, 2300.0, 40.0),
    bridge_spacing_m=9000.0,
    village_spacing_m=None,
)


def open_country_road(design: Design, length_m: float, random: np.random.Generator) -> RoadPlan:
    """A road from one place to another."""
    curvature = sample(winding(design, length_m, random))
    plan = bare_plan(
        curvature, rolling_grade(len(curvature), design.relief, random), design.limits_mps[0]
    )
    furnish_country_road(plan, design, random)
    return plan


def country_loop(design: Design, length_m: float, random: np.random.Generator) -> RoadPlan:
    """A road that ends where it begins and does not cross itself."""
    curvature = sample(_ring(design, length_m, random))
    grade = rolling_grade(len(curvature), design.relief, random, loop=True)
    plan = bare_plan(curvature, grade, design.limits_mps[0], loop=True)
    furnish_country_road(plan, design, random)
    return plan


def winding(design: Design, length_m: float, random: np.random.Generator) -> list[Element]:
    """Tangents and bends of at least a length; the last is a tangent."""
    elements: list[Element] = []
    heading_rad = 0.0
    while length_of(elements) < length_m:
        size_rad = min(math.radians(random.uniform(*design.turns_deg)), WANDER_RAD)
        side = math.copysign(1.0, random.uniform(-WANDER_RAD, WANDER_RAD) - heading_rad)
        if abs(heading_rad + side * size_rad) > WANDER_RAD:
            side = -math.copysign(1.0, heading_rad)
        heading_rad += side * size_rad
        bend = Bend(side * size_rad, _log_uniform(design.radii_m, random))
        elements += [straight(random.uniform(*design.tangents_m)), *bend.elements()]
    return [*elements, straight(design.tangents_m[0])]


def furnish_country_road(plan: RoadPlan, design: Design, random: np.random.Generator) -> None:
    """Limits, woods, bridges and villages."""
    place_m = 0.0
    while place_m < plan.length_m:
        part_m = random.uniform(*design.limit_m)
        plan.limits_mps[plan.within(place_m, part_m)] = random.choice(design.limits_mps)
        place_m += part_m
    plan.limits_mps[-1] = plan.limits_mps[-2]
    line_with(plan, SCENERY, (1.0 - design.trees, design.trees), SCENERY_M, random)
    cross_bridges(plan, design.bridge_spacing_m, random)
    if design.village_spacing_m is not None:
        _build_villages(plan, design.village_spacing_m, random)


def _build_villages(plan: RoadPlan, spacing_m: float, random: np.random.Generator) -> None:
    """Half a kilometre or so at 50 km/h between houses, every second one with a light."""
    for number in range(int(plan.length_m / spacing_m)):
        length_m = random.uniform(400.0, 900.0)
        start_m = (number + random.uniform(0.2, 0.7)) * spacing_m
        place = plan.within(start_m, length_m)
        plan.limits_mps[place] = 50.0 * KMH
        plan.surroundings[place] = Surroundings.STREET
        if number % 2 == 0:
            plan.halts.append(Halt(start_m + 0.5 * length_m, "light", VILLAGE_LIGHT_S))


def _ring(design: Design, length_m: float, random: np.random.Generator) -> list[Element]:
    """A star-shaped polygon with bends, scaled to its length."""
    shape = _star(round(length_m / _leg_m(design)), random)
    legs_m, _ = legs_and_turns(shape)
    scale = length_m / sum(legs_m)
    radii_m = [_log_uniform(design.radii_m, random) for _ in legs_m]
    for _ in range(FITTINGS):
        elements = round_corners(shape * scale, radii_m)
        scale *= length_m / length_of(elements)
    return elements


def _leg_m(design: Design) -> float:
    """A leg of a loop: about what a tangent and a bend take on an open road."""
    turn_rad = math.radians(sum(design.turns_deg) / 2.0)
    return sum(design.tangents_m) / 2.0 + 0.7 * sum(design.radii_m) / 2.0 * turn_rad


def _star(corners: int, random: np.random.Generator) -> Floats:
    """A closed polygon around its middle, first vertex after its longest leg, shape (n, 2)."""
    count = max(corners, 6)
    angles_rad = (np.arange(count) + random.uniform(-0.25, 0.25, count)) * (2.0 * math.pi / count)
    waves = np.arange(2, max(3, count // 3 + 1))
    phases_rad = random.uniform(0.0, 2.0 * math.pi, len(waves))
    swing = np.cos(waves * angles_rad[:, None] + phases_rad) / (1.0 + waves)
    distance = 1.0 + 0.45 * swing.sum(axis=1) / max(1.0, float(np.abs(swing.sum(axis=1)).max()))
    shape = np.column_stack((np.sin(angles_rad) * distance, np.cos(angles_rad) * distance))
    legs, _ = legs_and_turns(shape)
    return np.roll(shape, -(int(np.argmax(legs)) + 1), axis=0)


def _log_uniform(span: tuple[float, float], random: np.random.Generator) -> float:
    return math.exp(random.uniform(math.log(span[0]), math.log(span[1])))
