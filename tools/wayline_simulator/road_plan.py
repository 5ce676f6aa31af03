"""Pure: a road before it is laid on the ellipsoid, and what stands beside it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from wayline.strict import Strict
from wayline_simulator.closing import Start, close_curvature
from wayline_simulator.course import STEP_M, Course, Floats, Halt, Surroundings, lay_course

BRIDGE_M = (9.0, 28.0)
"""How wide a bridge over the road is: a lane with railings to a dual carriageway."""

DWELL_S = (12.0, 30.0)
"""At a bus stop on average; TCQSM takes 15 s for a quiet stop, 30 s for a typical one."""
STOP_CLEAR_M = 40.0
STOP_NAMES = ("Church", "School", "Station", "Market", "Mill", "Harbour", "Library", "Park")


class Stretch(Strict, frozen=True, kw_only=True):
    """A piece of a road."""

    start_m: Annotated[float, Meta(ge=0.0)]
    length_m: Annotated[float, Meta(gt=0.0)]


@dataclass
class RoadPlan:
    """Samples every STEP_M, shape (n,), that those who furnish the road fill in."""

    curvature_per_m: Floats
    grade: Floats
    limits_mps: Floats
    surroundings: NDArray[np.int8]
    halts: list[Halt] = field(default_factory=list)
    backwards: NDArray[np.bool_] | None = None
    loop: bool = False

    @property
    def length_m(self) -> float:
        """From the first sample to the last."""
        return (len(self.curvature_per_m) - 1) * STEP_M

    def within(self, start_m: float, length_m: float) -> slice:
        """The samples of a stretch."""
        return slice(round(start_m / STEP_M), round((start_m + length_m) / STEP_M))


def bare_plan(
    curvature_per_m: Floats, grade: Floats, limit_mps: float, *, loop: bool = False
) -> RoadPlan:
    """A road under open sky with one limit."""
    count = len(curvature_per_m)
    return RoadPlan(
        curvature_per_m=curvature_per_m,
        grade=grade,
        limits_mps=np.full(count, limit_mps),
        surroundings=np.full(count, Surroundings.OPEN, dtype=np.int8),
        loop=loop,
    )


def lay_plan(plan: RoadPlan, start: Start) -> Course:
    """The course of a plan; a loop is closed."""
    curvature = plan.curvature_per_m
    return lay_course(
        **start._asdict(),
        curvature_per_m=close_curvature(curvature, start) if plan.loop else curvature,
        grade=plan.grade,
        limits_mps=plan.limits_mps,
        surroundings=plan.surroundings,
        backwards=plan.backwards,
        halts=plan.halts,
        loop=plan.loop,
    )


def line_with(
    plan: RoadPlan,
    kinds: Sequence[Surroundings],
    shares: Sequence[float],
    lengths_m: tuple[float, float],
    random: np.random.Generator,
) -> None:
    """Put stretches of surroundings along the whole road, each kind by its share."""
    place_m = 0.0
    while place_m < plan.length_m:
        length_m = random.uniform(*lengths_m)
        plan.surroundings[plan.within(place_m, length_m)] = random.choice(kinds, p=shares)
        place_m += length_m
    plan.surroundings[-1] = plan.surroundings[-2]


def cross_bridges(plan: RoadPlan, spacing_m: float, random: np.random.Generator) -> None:
    """Lead other roads over this one, so far apart on average."""
    places_m = random.uniform(200.0, plan.length_m - 200.0, round(plan.length_m / spacing_m))
    for place_m in places_m:
        plan.surroundings[plan.within(place_m, random.uniform(*BRIDGE_M))] = Surroundings.BRIDGE


def dig(plan: RoadPlan, tunnels: Iterable[Stretch]) -> None:
    """Lead the road through tunnels, in which nobody has to wait."""
    for tunnel in tunnels:
        plan.surroundings[plan.within(tunnel.start_m, tunnel.length_m)] = Surroundings.TUNNEL
        end_m = tunnel.start_m + tunnel.length_m
        plan.halts = [
            halt
            for halt in plan.halts
            if halt.kind != "light" or not tunnel.start_m <= halt.distance_m <= end_m
        ]


def some_tunnels(
    length_m: float, count: int, lengths_m: tuple[float, float], random: np.random.Generator
) -> list[Stretch]:
    """Tunnels one in each equal part of the road, none within a tenth of such a part's ends."""
    part_m = length_m / max(count, 1)
    tunnels = []
    for number in range(count):
        tunnel_m = min(random.uniform(*lengths_m), 0.6 * part_m)
        start_m = number * part_m + random.uniform(0.1 * part_m, 0.9 * part_m - tunnel_m)
        tunnels.append(Stretch(start_m=start_m, length_m=tunnel_m))
    return tunnels


def place_stops(plan: RoadPlan, count: int, random: np.random.Generator) -> None:
    """Bus stops about evenly along the road; a light that one would stand in goes."""
    part_m = plan.length_m / max(count, 1)
    for number in range(count):
        place_m = round((number + random.uniform(0.35, 0.65)) * part_m / STEP_M) * STEP_M
        name = f"{STOP_NAMES[number % len(STOP_NAMES)]} {number + 1}"
        plan.halts = [
            halt
            for halt in plan.halts
            if halt.kind != "light" or abs(halt.distance_m - place_m) > STOP_CLEAR_M
        ]
        plan.halts.append(Halt(place_m, "stop", random.uniform(*DWELL_S), name))
