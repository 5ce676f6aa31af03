"""Pure: where roads cross at different heights: a motorway's ramps, and a figure of eight."""

import math
from typing import NamedTuple

import numpy as np

from wayline_simulator.alignment import (
    Bend,
    Element,
    length_of,
    round_corners,
    sample,
    straight,
)
from wayline_simulator.country_road import KMH, MAIN, MOTORWAY, furnish_country_road, winding
from wayline_simulator.course import STEP_M, Floats, Halt, Surroundings
from wayline_simulator.road_plan import RoadPlan, bare_plan
from wayline_simulator.vertical_alignment import Relief, join_grades, rolling_grade

HEADROOM_M = 6.5
"""Between two roads: 4.7 m of clearance, as European guides ask for, and the bridge's deck."""
LOOP_RADIUS_M = 50.0
"""Of a clover leaf's ramp: 40 km/h by AASHTO (43 m at 8 % superelevation)."""
RAMP_RELIEF = Relief(0.06, 0.0, 100.0, 300.0, 400.0, 600.0, 10.0)
"""K at 40 km/h: 4 and 9 m/%; slightly tighter in the sag, where ramps are lit."""
STREET_M = 300.0
STREET_MPS = 50.0 * KMH
RAMP_LIGHT_S = 60.0
EIGHT_GRADE = 0.03
EIGHT_SHAPE = (1.0, 0.55)
"""Half of the figure's width and height."""


class Ramp(NamedTuple):
    """A stretch whose bends and heights belong together."""

    elements: list[Element]
    changes_m: list[float]
    grades: list[float]
    """One more than changes."""


def motorway(length_m: float, random: np.random.Generator) -> RoadPlan:
    """From a street over the motorway, down a loop onto it and along, and off to a light."""
    entry, leaving = _on_ramp(), _off_ramp()
    between_m = length_m - length_of(entry.elements) - length_of(leaving.elements)
    parts = [
        sample(entry.elements),
        sample(winding(MOTORWAY, max(between_m, 2000.0), random)),
        sample(leaving.elements),
    ]
    # a part's last sample is the next one's first
    grades = [
        _grade(entry, len(parts[0]))[:-1],
        rolling_grade(len(parts[1]), MOTORWAY.relief, random)[:-1],
        _grade(leaving, len(parts[2])),
    ]
    curvature = np.concatenate((parts[0][:-1], parts[1][:-1], parts[2]))
    plan = bare_plan(curvature, np.concatenate(grades), STREET_MPS)
    furnish_country_road(plan, MOTORWAY, random)
    _build_ramps(plan, entry, leaving)
    return plan


def figure_of_eight(length_m: float, random: np.random.Generator) -> RoadPlan:
    """A main road in a loop that crosses itself on a bridge, the first pass above."""
    wide, high = EIGHT_SHAPE
    shape = np.array([[-wide, -high], [wide, high], [wide, -high], [-wide, high]])
    scale = length_m / (4.0 * high + 4.0 * math.hypot(wide, high))
    for _ in range(4):
        elements = round_corners(shape * scale, [150.0] * 4)
        scale *= length_m / length_of(elements)
    curvature = sample(elements)
    whole_m = (len(curvature) - 1) * STEP_M
    grade = _grade(_eight_heights(elements, whole_m), len(curvature))
    plan = bare_plan(curvature, grade, MAIN.limits_mps[0], loop=True)
    furnish_country_road(plan, MAIN._replace(village_spacing_m=None, bridge_spacing_m=1e9), random)
    plan.surroundings[plan.within(0.75 * whole_m - 8.0, 16.0)] = Surroundings.BRIDGE
    return plan


def _eight_heights(elements: list[Element], whole_m: float) -> Ramp:
    """High a quarter on, where the road crosses itself, and low three quarters on."""
    climb_m = 0.5 * (HEADROOM_M + 1.0) / EIGHT_GRADE
    first_m, last_m, middle_m = 0.05 * whole_m, 0.95 * whole_m, 0.5 * whole_m
    return Ramp(
        elements,
        [
            first_m,
            first_m + climb_m,
            middle_m - climb_m,
            middle_m + climb_m,
            last_m - climb_m,
            last_m,
        ],
        [0.0, EIGHT_GRADE, 0.0, -EIGHT_GRADE, 0.0, EIGHT_GRADE, 0.0],
    )


def _on_ramp() -> Ramp:
    """Over the motorway and three quarters round to the right, to pass below one's own bridge."""
    loop = Bend(1.5 * math.pi, LOOP_RADIUS_M)
    lead_m = -loop.tangent_m
    elements = [straight(STREET_M + lead_m), *loop.elements(), straight(lead_m + 400.0)]
    down_m = STREET_M + 40.0
    level_m = STREET_M + 2.0 * lead_m + length_of(loop.elements()) - 40.0
    return Ramp(elements, [down_m, level_m], [0.0, -HEADROOM_M / (level_m - down_m), 0.0])


def _off_ramp() -> Ramp:
    """Off to the right, up to a light, and a sharp turn onto a street."""
    elements = [
        straight(300.0),
        *Bend(math.radians(20.0), 300.0).elements(),
        straight(120.0),
        *Bend(math.radians(40.0), 90.0).elements(),
        straight(60.0),
        *Bend(math.radians(60.0), 15.0).elements(),
        straight(STREET_M),
    ]
    end_m = length_of(elements) - STREET_M - 40.0
    return Ramp(elements, [end_m - 260.0, end_m], [0.0, HEADROOM_M / 260.0, 0.0])


def _build_ramps(plan: RoadPlan, entry: Ramp, leaving: Ramp) -> None:
    """Limits, the light and the bridge; no other bridge stands on a ramp."""
    joined_m = length_of(entry.elements) - 400.0
    left_m = plan.length_m - length_of(leaving.elements) + 300.0
    for start_m, length_m, limit_mps in (
        (0.0, STREET_M, STREET_MPS),
        (STREET_M, joined_m - STREET_M, 40.0 * KMH),
        (left_m, 200.0, 80.0 * KMH),
        (left_m + 200.0, plan.length_m - left_m, STREET_MPS),
    ):
        place = plan.within(start_m, length_m)
        plan.limits_mps[place] = limit_mps
        plan.surroundings[place] = Surroundings.OPEN
    plan.limits_mps[-1], plan.surroundings[-1] = STREET_MPS, Surroundings.OPEN
    plan.surroundings[plan.within(joined_m - 7.0, 14.0)] = Surroundings.BRIDGE
    plan.halts.append(Halt(plan.length_m - STREET_M - 45.0, "light", RAMP_LIGHT_S))


def _grade(ramp: Ramp, count: int) -> Floats:
    return join_grades(count, np.array(ramp.changes_m), np.array(ramp.grades), RAMP_RELIEF)
