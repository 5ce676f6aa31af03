"""Pure: what all vehicles of a process have learned, and what it says of one route."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol
from zoneinfo import ZoneInfo

import msgspec
import numpy as np

from wayline.route import Route
from wayline.timetable.model import Timetable
from wayline_eta.experience import Expected, Experience
from wayline_eta.legs import SHORTEST_S, Leg, Legs
from wayline_eta.ranges import Ranges
from wayline_eta.records import Came, Learned, Taken
from wayline_eta.stands import Stand, goes_on

KNOWN_RUNS = 2.0
"""Dwells that were seen at a stop, before they count for a vehicle that stands there."""


class Standing(Protocol):
    """What is known of a vehicle, as `Forecasting` needs it."""

    @property
    def stand(self) -> Stand:
        """How long it will stand by the plan."""
        ...


class Lessons:
    """Travel and dwell times, and how forecasts came. `is_timetable` says whose times plans are."""

    def __init__(self, zone: ZoneInfo, *, is_timetable: bool) -> None:
        self.experience = Experience(zone, is_timetable=is_timetable)
        self._ranges: dict[str, Ranges] = {}

    def ranges_of(self, plan: str) -> Ranges:
        """Of the forecasts on one plan's legs."""
        return self._ranges.setdefault(plan, Ranges())

    def learn(self, learned: Learned) -> None:
        """Take what a vehicle has just taught."""
        self.experience.learn(learned.taken)
        for came in learned.came:
            self.ranges_of(came.plan).learn(came.span, came.off)

    def remember(self, kept: msgspec.Struct) -> None:
        """Take what a database has kept; it says nothing of the traffic now."""
        if isinstance(kept, Taken):
            self.experience.learn(kept, is_now=False)
        elif isinstance(kept, Came):
            self.ranges_of(kept.plan).learn(kept.span, kept.off)


class Forecasting(NamedTuple):
    """By what the arrivals of one vehicle on one route are predicted."""

    legs: Legs
    plan: str
    """Whose times the legs' are: a route, or a line of a timetable."""
    experience: Experience
    ranges: Ranges
    stands: tuple[int, float] | None = None
    """The stop at which the vehicle stands, and for how long, in seconds."""

    def travel(self, stop: int, t_ns: int, ahead_s: float) -> Expected:
        """Of the whole leg to a stop, begun so long after an instant."""
        leg = self.legs.to(stop)
        if leg is None:
            return Expected(0.0, 0.0)
        return self.experience.travel(leg, self.plan, t_ns, ahead_s)

    def is_driven(self, stop: int) -> bool:
        """Whether anybody has driven the leg to a stop."""
        leg = self.legs.to(stop)
        return leg is not None and self.experience.is_driven(leg.key)

    def rest(self, stop: int, here_m: float, stop_m: float, t_ns: int) -> Expected:
        """Of the leg under way to a stop, by the share of its planned time still to go."""
        ends_s = self.legs.route.time_at(np.array([max(here_m, 0.0), stop_m]))
        planned_s = max(float(ends_s[1] - ends_s[0]), 0.0)
        leg = self.legs.to(stop) or Leg("", max(planned_s, SHORTEST_S))
        whole = self.experience.travel(leg, self.plan, t_ns)
        share = min(planned_s / leg.planned_s, 1.0)
        return Expected(whole.seconds * share, whole.variance_s2 * share)

    def stand(self, outlook: Standing) -> Stand:
        """How long the vehicle will still stand, by what others have stood at its stop."""
        if self.stands is None:
            return outlook.stand
        stop, stood_s = self.stands
        dwell_s = self.experience.known_dwell_s(self.legs.keys[stop], KNOWN_RUNS)
        if dwell_s is None:
            return outlook.stand
        return goes_on(max(stood_s - dwell_s, 0.0)).at_least(max(dwell_s - stood_s, 0.0))


def as_planned(route: Route) -> Forecasting:
    """By the plan alone, as when nobody has driven yet."""
    experience = Experience(ZoneInfo("UTC"), is_timetable=False)
    return Forecasting(Legs(route, route.route_id), route.route_id, experience, Ranges())


def lessons_by(timetables: Sequence[Timetable]) -> Lessons:
    """Empty ones: of days as the first timetable has them; of routes, of UTC's."""
    zone = ZoneInfo(timetables[0].timezone) if timetables else ZoneInfo("UTC")
    return Lessons(zone, is_timetable=bool(timetables))
