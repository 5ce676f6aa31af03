"""Pure: what every vehicle has taught of travel and dwell times, and what to expect by it.

Travel is the logarithm of time taken over time planned, a leg's by half hour and class of day. Each
level is held to the one above by as much as it knows less: half hour, class of day, leg, plan. How
the plan's other legs went on earlier runs says how wrong it is; how they have just gone does not: a
run that is slow here is quick there. On top comes what traffic is now: how much slower than usual
a leg was for whoever drove it last, which fades within twenty minutes (`congestion.py`).
"""

import math
from collections import defaultdict, deque
from typing import NamedTuple
from zoneinfo import ZoneInfo

from wayline_eta.congestion import Congestion
from wayline_eta.day_slots import slot_of
from wayline_eta.forgetful import Forgetful
from wayline_eta.legs import Leg
from wayline_eta.records import Known, Taken

MODEL = 1
"""Of `teachings`; what another one has left in a database is learned anew from its rows."""
DAY_HELD, SLOT_HELD = 3.0, 4.0
"""What the level above is worth to each, in observations."""
PLAN_HELD, TIMETABLE_HELD = 0.3, 1.0
"""What a leg's plan is worth: a timetable has been driven before."""
OTHERS_HELD = 3.0
"""What the plan itself is worth beside all of its legs as they went on earlier runs."""
EARLIER_NS = 2 * 3_600 * 1_000_000_000
"""A run is an earlier one after so long."""
LEG_STD, LIGHTS_STD_S = 0.12, 10.0
"""From run to run before runs have told: of the logarithm, and what lights and queues add."""
PRIOR_RUNS = 4.0
"""What that is worth."""
PLAN_STD, TIMETABLE_STD = 0.14, 0.12
"""Of the logarithm of what nobody has driven, from its plan."""
PLAN_RUN_STD, TIMETABLE_RUN_STD = 0.3, 0.12
"""Of what all legs of a plan have in common: it may be wrong as a whole."""
SHOWN_LEGS = 2.0
"""Legs that show as much of that as is known before any has."""
RATIO_MAX = 20.0
"""A leg that took so many times its plan is a breakdown or a detour, and so is its inverse."""
DWELL_MAX_S = 1_200.0
DWELL_STD_S = 6.0
DWELL_RUNS = 1.0
"""A planned dwell is worth so many that were seen, and so is what all stops of a plan have."""
LATE_STD_S = 15.0
"""Of how long after its time a vehicle leaves that waits for it; 0 is worth LATE_RUNS."""
LATE_RUNS = 1.0


class Expected(NamedTuple):
    """The mean of a time, and its variance."""

    seconds: float
    variance_s2: float


class Experience:
    """Of all vehicles of a process. `is_timetable` says that plans are a timetable's times."""

    def __init__(self, zone: ZoneInfo, *, is_timetable: bool) -> None:
        self._zone = zone
        self._plan_held = TIMETABLE_HELD if is_timetable else PLAN_HELD
        self._plan_variance = (TIMETABLE_STD if is_timetable else PLAN_STD) ** 2
        self._run_variance = (TIMETABLE_RUN_STD if is_timetable else PLAN_RUN_STD) ** 2
        self._all: defaultdict[str, Forgetful] = defaultdict(Forgetful)
        """By the keys of `teachings`."""
        self._now: dict[str, Congestion] = {}
        self._young: defaultdict[str, deque[tuple[int, float]]] = defaultdict(deque)
        """Of each plan's key what is not long enough ago for an earlier run."""

    def learn(self, seen: Taken, *, is_now: bool = True) -> None:
        """Take what a vehicle took; disruptions teach nothing.

        What is read back from a database says nothing of the traffic now (`is_now`).
        """
        if is_now and seen.leg is not None and _is_usual(seen):
            ratio = math.log(seen.travel_s / seen.planned_s)
            usual, variance = self._usual(seen.leg, seen.planned_s, seen.plan, seen.t_ns)
            now = self._now.get(seen.leg, Congestion(seen.t_ns)).at(seen.t_ns)
            self._now[seen.leg] = now.measured(ratio - usual, variance)
        for key, value in teachings(seen, self._zone):
            if key == _plan_key(seen.plan):
                self._young[key].append((seen.t_ns, value))
            else:
                self._all[key] = self._all[key].with_value(value)

    def recall(self, known: Known) -> None:
        """Take what a database knows of one quantity in place of what was known of it here."""
        self._all[known.key] = Forgetful(known.weight, known.mean, known.square)
        self._young.pop(known.key, None)

    def plan_off(self, plan: str, t_ns: int) -> float:
        """The logarithm of what is taken over what is planned, of a leg that nobody has driven."""
        key = _plan_key(plan)
        young = self._young[key]
        while young and young[0][0] <= t_ns - EARLIER_NS:
            self._all[key] = self._all[key].with_value(young.popleft()[1])
        return self._known(key).blended(0.0, OTHERS_HELD)

    def plan_std(self, plan: str, t_ns: int) -> float:
        """Of the logarithm of what legs that nobody has driven take, of what they have in common.

        The legs of now show how wrong the plan is; what is told does not go by them, so it is as
        wrong as they are.
        """
        off = self.plan_off(plan, t_ns)
        shown = [value - off for _, value in self._young[_plan_key(plan)]]
        known = self._known(_plan_key(plan)).weight + len(shown)
        left = self._run_variance * SHOWN_LEGS / (SHOWN_LEGS + known)
        return math.hypot(math.sqrt(left), sum(shown) / (SHOWN_LEGS + len(shown)))

    def travel(self, leg: Leg, plan: str, t_ns: int, ahead_s: float = 0.0) -> Expected:
        """Of a leg that is begun `ahead_s` from an instant."""
        begun_ns = t_ns + round(ahead_s * 1e9)
        usual, variance = self._usual(leg.key, leg.planned_s, plan, begun_ns)
        if (now := self._now.get(leg.key)) is not None:
            faded = now.at(begun_ns)
            usual, variance = usual + faded.mean, variance + faded.variance
        # of a leg that was driven the mean is above the median; a plan tells means
        skewed = 0.5 * self._known(_leg_key(leg.key)).variance(0.0, PRIOR_RUNS)
        mean_s = leg.planned_s * math.exp(usual + skewed)
        return Expected(mean_s, mean_s**2 * math.expm1(variance))

    def dwell(self, stop: str, plan: str, planned_s: float) -> Expected:
        """At a stop; where vehicles wait for their time, of those that are late."""
        known = self._known(_dwell_key(stop))
        prior = max(DWELL_STD_S, 0.5 * planned_s) ** 2
        if known.weight > 0.0:
            planned_s = self._known(_dwells_key(plan)).blended(planned_s, DWELL_RUNS)
        mean_s = known.blended(planned_s, DWELL_RUNS)
        unsure = prior * DWELL_RUNS / (known.weight + DWELL_RUNS)
        return Expected(mean_s, known.variance(prior, DWELL_RUNS) + 0.25 * unsure)

    def late(self, wait: str) -> Expected:
        """How long after its time a vehicle leaves where it waits for it; negative: before it."""
        known = self._known(_dwell_key(wait))
        variance = known.variance(LATE_STD_S**2, LATE_RUNS)
        return Expected(known.blended(0.0, LATE_RUNS), variance)

    def is_driven(self, leg: str) -> bool:
        """Whether anybody has taught of a leg."""
        return self._known(_leg_key(leg)).weight > 0.0

    def dwells_seen(self, stop: str) -> float:
        """How many dwells at a stop have taught, those of long ago for less."""
        return self._known(_dwell_key(stop)).weight

    def _usual(self, leg: str, planned_s: float, plan: str, t_ns: int) -> tuple[float, float]:
        """The logarithm of taken over planned, and its variance for one run."""
        day, slot = slot_of(t_ns, self._zone)
        of_leg, of_slot = self._known(_leg_key(leg)), self._known(_leg_key(leg, day, slot))
        mean = of_leg.blended(self.plan_off(plan, t_ns), self._plan_held)
        mean = self._known(_leg_key(leg, day)).blended(mean, DAY_HELD)
        mean = of_slot.blended(mean, SLOT_HELD)
        unsure = self._plan_variance * self._plan_held / (of_leg.weight + self._plan_held)
        spread = of_slot if of_slot.weight > PRIOR_RUNS else of_leg
        prior = LEG_STD**2 + (LIGHTS_STD_S / planned_s) ** 2
        return mean, spread.variance(prior, PRIOR_RUNS) + unsure

    def _known(self, key: str) -> Forgetful:
        return self._all.get(key, Forgetful())


def teachings(seen: Taken, zone: ZoneInfo) -> list[tuple[str, float]]:
    """What a row teaches: values under the keys of what they are of; disruptions teach nothing."""
    taught: list[tuple[str, float]] = []
    if seen.disruption is not None:
        return taught
    if abs(seen.dwell_s) <= DWELL_MAX_S:
        taught.append((_dwell_key(seen.stop), seen.dwell_s))
        if not is_wait(seen.stop):
            taught.append((_dwells_key(seen.plan), seen.dwell_s))
    if seen.leg is not None and _is_usual(seen):
        ratio, (day, slot) = math.log(seen.travel_s / seen.planned_s), slot_of(seen.t_ns, zone)
        keys = _leg_key(seen.leg), _leg_key(seen.leg, day), _leg_key(seen.leg, day, slot)
        taught += [(key, ratio) for key in (*keys, _plan_key(seen.plan))]
    return taught


def _leg_key(leg: str, *of: object) -> str:
    """Of travel on a leg, on all days, on a class of days, in a half hour of such."""
    return "\t".join(("leg", leg, *map(str, of)))


def _plan_key(plan: str) -> str:
    """Of travel on all legs of a plan."""
    return f"plan\t{plan}"


def _dwell_key(stop: str) -> str:
    """Of dwells at a stop, or of how late vehicles leave it."""
    return f"dwell\t{stop}"


def _dwells_key(plan: str) -> str:
    """Of dwells at all stops of a plan."""
    return f"dwells\t{plan}"


def is_wait(stop: str) -> bool:
    """Whether a key is of how late vehicles leave (`legs`), not of how long they stand."""
    return stop.endswith("|waits")


def _is_usual(seen: Taken) -> bool:
    return (
        seen.disruption is None
        and seen.planned_s / RATIO_MAX < seen.travel_s < seen.planned_s * RATIO_MAX
    )
