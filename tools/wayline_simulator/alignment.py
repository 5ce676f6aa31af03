"""Pure: the horizontal alignment of a road: tangents, clothoids and arcs."""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import fresnel

from wayline_simulator.course import STEP_M, Floats

CLOTHOID_SHARE = 0.4
"""Length of a clothoid over its radius: A / R = 0.63, in the middle of the rule R/3 <= A <= R that
the German guides RAS-L and RAL give for the parameter A = sqrt(R L)."""
LEAST_ARC_SHARE = 0.2
"""Of a bend's turn; a bend that is only clothoids would wrench the steering wheel."""


class Element(NamedTuple):
    """A stretch on which curvature changes linearly; positive turns right."""

    length_m: float
    from_per_m: float
    to_per_m: float


class Bend(NamedTuple):
    """A turn by clothoid, arc and clothoid; everything but the angle scales with the radius."""

    turn_rad: float
    """Positive to the right."""
    radius_m: float

    @property
    def clothoid_m(self) -> float:
        """Length of each clothoid."""
        return self.radius_m * _clothoid_share(self.turn_rad)

    @property
    def tangent_m(self) -> float:
        """From where the two straights cross to where the bend begins.

        Negative for a turn of more than half a circle, which begins past the crossing.
        """
        return self.radius_m * tangent_share(self.turn_rad)

    def elements(self) -> tuple[Element, Element, Element]:
        """The elements into the arc, of the arc and out of the arc."""
        curvature = math.copysign(1.0 / self.radius_m, self.turn_rad)
        arc_m = self.radius_m * abs(self.turn_rad) - self.clothoid_m
        return (
            Element(self.clothoid_m, 0.0, curvature),
            Element(arc_m, curvature, curvature),
            Element(self.clothoid_m, curvature, 0.0),
        )


def straight(length_m: float) -> Element:
    """A tangent."""
    return Element(length_m, 0.0, 0.0)


def tangent_share(turn_rad: float) -> float:
    """The length of a bend's tangents over its radius: (1 + p) tan(turn / 2) + q.

    p and q are the clothoid's shift and the abscissa of the shifted arc's begin, as in any book on
    route surveying.
    """
    half_rad = _clothoid_share(turn_rad) / 2.0
    scale = math.sqrt(2.0 * math.pi * half_rad)
    sine, cosine = fresnel(math.sqrt(2.0 * half_rad / math.pi))
    shift = scale * sine - (1.0 - math.cos(half_rad))
    begin = scale * cosine - math.sin(half_rad)
    return float((1.0 + shift) * math.tan(abs(turn_rad) / 2.0) + begin)


def _clothoid_share(turn_rad: float) -> float:
    return min(CLOTHOID_SHARE, (1.0 - LEAST_ARC_SHARE) * abs(turn_rad))


def length_of(elements: Iterable[Element]) -> float:
    """Together."""
    return sum(element.length_m for element in elements)


def sample(elements: Sequence[Element]) -> Floats:
    """Curvature every STEP_M from the first element's begin to the last one's end.

    The road is stretched, by less than half a step, to a whole number of steps; every angle stays.
    """
    ends_m = np.cumsum([element.length_m for element in elements])
    steps = max(1, round(float(ends_m[-1]) / STEP_M))
    stretch = steps * STEP_M / float(ends_m[-1])
    places_m = np.arange(steps + 1) * (STEP_M / stretch)
    at = np.clip(np.searchsorted(ends_m, places_m, side="right"), 0, len(elements) - 1)
    table = np.array(elements, dtype=np.float64)
    share = 1.0 - (ends_m[at] - places_m) / table[at, 0]
    curvature = (table[at, 1] + share * (table[at, 2] - table[at, 1])) / stretch
    return np.asarray(curvature, dtype=np.float64)


def round_corners(vertices_m: Floats, radii_m: Sequence[float]) -> list[Element]:
    """A closed polygon, shape (n, 2) east and north, with a bend at every vertex.

    It begins half way along the leg from the last vertex to the first. A radius that does not fit
    its legs is reduced.
    """
    legs_m, turns_rad = legs_and_turns(vertices_m)
    bends = [
        Bend(turn, min(radius, _room_m(legs_m, at) / tangent_share(turn)))
        for at, (turn, radius) in enumerate(zip(turns_rad.tolist(), radii_m, strict=True))
    ]
    elements = [straight(legs_m[-1] / 2.0 - bends[0].tangent_m)]
    for at, bend in enumerate(bends):
        whole_m = legs_m[at]
        after_m = whole_m / 2.0 if at == len(bends) - 1 else whole_m - bends[at + 1].tangent_m
        elements += [*bend.elements(), straight(after_m - bend.tangent_m)]
    return elements


def legs_and_turns(vertices_m: Floats) -> tuple[list[float], NDArray[np.float64]]:
    """Of a closed polygon: the leg that leaves every vertex, and the turn made at it."""
    leaving = np.roll(vertices_m, -1, axis=0) - vertices_m
    headings_rad = np.arctan2(leaving[:, 0], leaving[:, 1])
    turns_rad = headings_rad - np.roll(headings_rad, 1)
    turns_rad = (turns_rad + math.pi) % (2.0 * math.pi) - math.pi
    return np.hypot(leaving[:, 0], leaving[:, 1]).tolist(), turns_rad


def _room_m(legs_m: Sequence[float], at: int) -> float:
    """The longest tangent at a vertex that leaves its neighbours theirs."""
    return 0.48 * min(legs_m[at - 1], legs_m[at])
