"""Pure: what all vehicles of a process have learned, and what it says of one route."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple
from zoneinfo import ZoneInfo

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.route import Route
from wayline.timetable.model import Timetable
from wayline_eta.breakdowns import Breakdowns
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.experience import Expected, Experience
from wayline_eta.legs import Legs
from wayline_eta.ranges import Ranges
from wayline_eta.records import Came, Known, Learned, Scored, ScoredDay

Floats = NDArray[np.float64]
TakeScores = Callable[[Scored | ScoredDay], None]

RUN_STD = 0.08
"""Of the logarithm of a whole run's time, beside its legs' own."""


class Lessons:
    """Travel and dwell times, and how forecasts came. `is_timetable` says whose times plans are.

    How good predictions were teaches nothing here; `scored` is told of it.
    """

    def __init__(self, zone: ZoneInfo, *, is_timetable: bool, scored: TakeScores) -> None:
        self.zone = zone
        """Of the days that are driven alike."""
        self.experience = Experience(zone, is_timetable=is_timetable)
        self.breakdowns = Breakdowns()
        self._ranges: dict[str, Ranges] = {}
        self.scored = scored
        self.taught = 0
        """How often somebody has taught: as long as it is the same, so is what they know."""

    def ranges_of(self, plan: str) -> Ranges:
        """Of the forecasts on one plan's legs."""
        return self._ranges.setdefault(plan, Ranges())

    def learn(self, learned: Learned) -> None:
        """Take what a vehicle has just taught."""
        self.taught += 1
        self.experience.learn(learned.taken)
        for came in learned.came:
            self.ranges_of(came.plan).learn(came.span, came.off)

    def remember(self, kept: msgspec.Struct) -> None:
        """Take what a database has kept; it says nothing of the traffic now."""
        self.taught += 1
        if isinstance(kept, Known):
            self.experience.recall(kept)
        elif isinstance(kept, Came):
            self.ranges_of(kept.plan).learn(kept.span, kept.off)
        elif isinstance(kept, ScoredDay):
            self.scored(kept)


class Expectations(NamedTuple):
    """What is expected on one route from an instant on; one number a stop, shape (stops,)."""

    legs: Legs
    planned_s: Floats
    """Of the leg to each stop; 0 to the first of an open route."""
    travel_s: Floats
    travel_s2: Floats
    """Its variance."""
    run_std: Floats
    """Of the logarithm of a run's time, of what its legs have in common."""
    dwell_s: Floats
    dwell_s2: Floats
    late_s: Floats
    """How long after its time a vehicle leaves where it waits for it; negative: before it."""
    late_s2: Floats
    first_factor: float
    """What the way to the first stop takes over what is planned: nobody has measured it."""
    dwells_seen: Floats
    """How many were, those of long ago for less."""
    is_driven: NDArray[np.bool_]
    """Whether anybody has driven the leg to it."""
    early_scales: Floats
    """Of a range's half widths, one a span of minutes ahead, planned and learned (`ranges`)."""
    late_scales: Floats


def expectations(lessons: Lessons, legs: Legs, plan: str, t_ns: int) -> Expectations:
    """What has been learned of a route's legs, for a vehicle that is on it now.

    A leg that is begun later is expected as it will be then.
    """
    experience, stops = lessons.experience, legs.route.stops
    known = [legs.to(at) for at in range(len(stops))]
    travels, dwells, lates, ahead_s = [], [], [], 0.0
    for at, leg in enumerate(known):
        expected = Expected(0.0, 0.0)
        if leg is not None:
            expected = experience.travel(leg, plan, t_ns, ahead_s)
        travels.append(expected)
        dwells.append(experience.dwell(legs.keys[at], plan, float(legs.dwells_s[at])))
        lates.append(experience.late(legs.waits(at)))
        ahead_s += expected.seconds + dwells[-1].seconds
    scales = lessons.ranges_of(plan).scales()
    travel_s, travel_s2 = np.array(travels, dtype=np.float64).reshape(-1, 2).T
    late_s, late_s2 = np.array(lates, dtype=np.float64).reshape(-1, 2).T
    dwell_s, dwell_s2 = np.array(dwells, dtype=np.float64).reshape(-1, 2).T
    is_driven = np.array(
        [leg is not None and experience.is_driven(leg.key) for leg in known], dtype=np.bool_
    )
    plan_std = math.hypot(RUN_STD, experience.plan_std(plan, t_ns))
    return Expectations(
        legs=legs,
        planned_s=np.array([0.0 if leg is None else leg.planned_s for leg in known]),
        travel_s=travel_s,
        travel_s2=travel_s2,
        run_std=np.where(is_driven, RUN_STD, plan_std),
        dwell_s=dwell_s,
        dwell_s2=dwell_s2,
        late_s=late_s,
        late_s2=late_s2,
        first_factor=math.exp(experience.plan_off(plan, t_ns)),
        dwells_seen=np.array([experience.dwells_seen(key) for key in legs.keys]),
        is_driven=is_driven,
        early_scales=np.array([scale.early for scale in scales]),
        late_scales=np.array([scale.late for scale in scales]),
    )


def as_planned(route: Route, motion: ExpectedMotion | None = None) -> Expectations:
    """By the plan alone, as when nobody has driven yet; `motion` as in `Legs`."""
    legs = Legs(route, route.route_id, motion)
    return expectations(lessons_by(()), legs, route.route_id, 0)


def lessons_by(timetables: Sequence[Timetable], scored: TakeScores = lambda _: None) -> Lessons:
    """Empty ones: of days as the first timetable has them; of routes, of UTC's."""
    zone = ZoneInfo(timetables[0].timezone) if timetables else ZoneInfo("UTC")
    return Lessons(zone, is_timetable=bool(timetables), scored=scored)
