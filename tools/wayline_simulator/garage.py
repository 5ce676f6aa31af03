"""Pure: into a parking garage, down its spiral, backwards into a bay, and out again."""

import math
from typing import NamedTuple

import numpy as np

from wayline_simulator.alignment import Bend, Element, sample, straight
from wayline_simulator.country_road import KMH
from wayline_simulator.course import STEP_M, Floats, Halt, Surroundings
from wayline_simulator.road_plan import RoadPlan
from wayline_simulator.vertical_alignment import Relief, join_grades

STREET_MPS = 50.0 * KMH
RAMP_MPS = 12.0 * KMH
AISLE_MPS = 15.0 * KMH
SPIRAL_MPS = 10.0 * KMH
BAY_MPS = 4.0 * KMH
SPIRAL_RADIUS_M = 8.0
"""Of the vehicle's path; helical ramps of garages are built for 7 to 10 m."""
SPIRAL_TURNS = 3
SPIRAL_GRADE = 0.105
RAMP_GRADE = 0.12
"""German garage bylaws (GarVO) allow 15 %, with flatter ends, and 10 % on a helix outdoors; what
is built lies between."""
RAMP_M = 50.0
AISLE_RADIUS_M = 6.0
BAY_RADIUS_M = 5.5
"""A car at full lock."""
DOOR_M = 20.0
"""Of the ramp that lies under open sky."""
PARKED_S = 45.0
GEAR_S = 2.0
"""To change between forward and reverse."""
JUNCTION_S = 25.0
RELIEF = Relief(0.15, 0.0, 10.0, 50.0, 40.0, 60.0, 20.0)
"""A car of 2.7 m wheelbase does not touch ground on a crest of 40 m; a judgement."""


class Part(NamedTuple):
    """A piece of the way in which one thing is done."""

    elements: list[Element]
    limit_mps: float
    grade: float = 0.0
    under_roof: bool = True
    backwards: bool = False


def garage_road(random: np.random.Generator) -> RoadPlan:
    """A kilometre of street, some eight minutes in the garage, and another kilometre."""
    arriving = [
        Part(_street(random), STREET_MPS, under_roof=False),
        _ramp(-1.0),
        Part([straight(12.0), *_lap(64.0, 30.0), *_lap(64.0, 30.0)], AISLE_MPS),
        _spiral(-1.0),
        Part([straight(10.0), *_lap(68.0, 32.0), *_lap(68.0, 32.0), straight(20.0)], AISLE_MPS),
    ]
    # forward past the bay, back into it with the tail to the right, and forward out of it
    parking = [
        Part([straight(2.0), *_corner(-1.0), straight(5.0)], BAY_MPS, backwards=True),
        Part([straight(5.0), *_corner(1.0)], BAY_MPS),
    ]
    leaving = [
        Part([straight(20.0), *_lap(68.0, 32.0), straight(8.0)], AISLE_MPS),
        _spiral(1.0),
        Part([straight(10.0), *_lap(64.0, 30.0), straight(14.0)], AISLE_MPS),
        _ramp(1.0),
        Part(_street(random), STREET_MPS, under_roof=False),
    ]
    return _join(arriving, parking, leaving)


def _join(arriving: list[Part], parking: list[Part], leaving: list[Part]) -> RoadPlan:
    parts = [*arriving, *parking, *leaving]
    curvatures = [sample(part.elements) for part in parts]
    ends = np.cumsum([len(curvature) - 1 for curvature in curvatures])
    lengths = np.diff(ends, prepend=0)

    def spread(values: list[float]) -> Floats:
        """One value a part at every sample; a boundary's is that of the part that begins."""
        return np.append(np.repeat(values, lengths), values[-1])

    slopes = np.array([part.grade for part in parts])
    surroundings = spread([_roof(part.under_roof) for part in parts]).astype(np.int8)
    _open_doors(surroundings)
    turn, park = (float(ends[len(arriving) + at] * STEP_M) for at in (-1, 0))
    out_m = float(ends[-2]) * STEP_M
    return RoadPlan(
        # a part's last sample is the next one's first
        curvature_per_m=np.concatenate(
            [*(curvature[:-1] for curvature in curvatures[:-1]), curvatures[-1]]
        ),
        grade=join_grades(int(ends[-1]) + 1, ends[:-1] * STEP_M, slopes, RELIEF),
        limits_mps=spread([part.limit_mps for part in parts]),
        surroundings=surroundings,
        halts=[
            Halt(turn, "turn", GEAR_S),
            Halt(park, "park", PARKED_S),
            Halt(out_m + 4.0, "light", JUNCTION_S),
        ],
        backwards=spread([float(part.backwards) for part in parts]).astype(np.bool_),
    )


def _roof(under: bool) -> float:
    return float(Surroundings.GARAGE if under else Surroundings.STREET)


def _open_doors(surroundings: np.typing.NDArray[np.int8]) -> None:
    """The first metres of both ramps lie in the open."""
    inside = np.flatnonzero(surroundings == Surroundings.GARAGE)
    steps = round(DOOR_M / STEP_M)
    surroundings[inside[:steps]] = Surroundings.STREET
    surroundings[inside[-steps:]] = Surroundings.STREET


def _street(random: np.random.Generator) -> list[Element]:
    """About a kilometre with bends, level and straight at both ends."""
    elements = [straight(150.0)]
    for side in (1.0, -1.0, 1.0, -1.0):
        bend = Bend(side * math.radians(random.uniform(20.0, 85.0)), random.uniform(15.0, 60.0))
        elements += [*bend.elements(), straight(random.uniform(150.0, 220.0))]
    return elements


def _ramp(sign: float) -> Part:
    """Down for -1, up for 1."""
    return Part([straight(RAMP_M)], RAMP_MPS, sign * RAMP_GRADE)


def _spiral(sign: float) -> Part:
    turns = Bend(2.0 * math.pi * SPIRAL_TURNS, SPIRAL_RADIUS_M)
    return Part(list(turns.elements()), SPIRAL_MPS, sign * SPIRAL_GRADE)


def _lap(long_m: float, short_m: float) -> list[Element]:
    """Once round the bays of a floor, to the left."""
    elements: list[Element] = []
    for side_m in (long_m, short_m, long_m, short_m):
        corner = Bend(-math.pi / 2.0, AISLE_RADIUS_M)
        elements += [straight(side_m - 2.0 * corner.tangent_m), *corner.elements()]
    return elements


def _corner(side: float) -> tuple[Element, ...]:
    return Bend(side * math.pi / 2.0, BAY_RADIUS_M).elements()
