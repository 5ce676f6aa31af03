"""Pure: what every vehicle has taught of travel and dwell times, and what to expect by it.

Travel is the logarithm of time taken over time planned, a leg's by half hour and class of day. Each
level is held to the one above by as much as it knows less: half hour, class of day, leg, plan. How
the plan's other legs went on earlier runs says how wrong it is; how they have just gone does not: a
run that is slow here is quick there. On top comes what traffic is now: how much slower than usual
a leg was for whoever drove it last, which fades within `CONGESTION_S`.
"""

import math
from collections import defaultdict, deque
from typing import NamedTuple
from zoneinfo import ZoneInfo

from wayline_eta.day_slots import slot_of
from wayline_eta.forgetful import Forgetful
from wayline_eta.legs import Leg
from wayline_eta.records import Taken

DAY_HELD, SLOT_HELD = 3.0, 4.0
"""What the level above is worth to each, in observations."""
PLAN_HELD, TIMETABLE_HELD = 0.3, 1.0
"""What a leg's plan is worth: a timetable has been driven before."""
OTHERS_HELD = 3.0
"""What the plan itself is worth beside all of its legs as they went on earlier runs."""
EARLIER_NS = 2 * 3_600 * 1_000_000_000
"""A run is an earlier one after so long."""
LEG_STD = 0.12
"""Of the logarithm from run to run, before runs have told; worth PRIOR_RUNS."""
PRIOR_RUNS = 4.0
PLAN_STD, TIMETABLE_STD = 0.14, 0.12
"""Of the logarithm of what nobody has driven, from its plan."""
CONGESTION_STD = 0.10
CONGESTION_S = 1_200.0
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


class Congestion(NamedTuple):
    """How much slower than usual a leg is, as a logarithm (a scalar Kalman filter)."""

    t_ns: int = 0
    mean: float = 0.0
    variance: float = CONGESTION_STD**2

    def at(self, t_ns: int) -> "Congestion":
        """Later: it fades, and nobody knows better than before."""
        kept = math.exp(-max(t_ns - self.t_ns, 0) * 1e-9 / CONGESTION_S)
        unknown = (1.0 - kept**2) * CONGESTION_STD**2
        return Congestion(max(t_ns, self.t_ns), kept * self.mean, kept**2 * self.variance + unknown)

    def measured(self, off: float, variance: float) -> "Congestion":
        """After a run that was off from what is usual."""
        gain = self.variance / (self.variance + variance)
        return Congestion(
            self.t_ns, self.mean + gain * (off - self.mean), (1.0 - gain) * self.variance
        )


class Experience:
    """Of all vehicles of a process. `is_timetable` says that plans are a timetable's times."""

    def __init__(self, zone: ZoneInfo, *, is_timetable: bool) -> None:
        self._zone = zone
        self._plan_held = TIMETABLE_HELD if is_timetable else PLAN_HELD
        self._plan_variance = (TIMETABLE_STD if is_timetable else PLAN_STD) ** 2
        self._travel: defaultdict[tuple[object, ...], Forgetful] = defaultdict(Forgetful)
        self._dwell: defaultdict[str, Forgetful] = defaultdict(Forgetful)
        self._dwells: defaultdict[str, Forgetful] = defaultdict(Forgetful)
        """At all stops of each plan."""
        self._now: dict[str, Congestion] = {}
        self._plans: defaultdict[str, Forgetful] = defaultdict(Forgetful)
        """Of all legs of each plan, on earlier runs."""
        self._young: defaultdict[str, deque[tuple[int, float]]] = defaultdict(deque)
        """What is not long enough ago for that."""

    def learn(self, seen: Taken, *, is_now: bool = True) -> None:
        """Take what a vehicle took; breakdowns teach nothing.

        What is read back from a database says nothing of the traffic now (`is_now`).
        """
        if abs(seen.dwell_s) <= DWELL_MAX_S:
            self._dwell[seen.stop] = self._dwell[seen.stop].with_value(seen.dwell_s)
            if not is_wait(seen.stop):
                self._dwells[seen.plan] = self._dwells[seen.plan].with_value(seen.dwell_s)
        if seen.leg is None or not _is_usual(seen):
            return
        ratio = math.log(seen.travel_s / seen.planned_s)
        if is_now:
            usual, variance = self._usual(seen.leg, seen.plan, seen.t_ns)
            now = self._now.get(seen.leg, Congestion(seen.t_ns)).at(seen.t_ns)
            self._now[seen.leg] = now.measured(ratio - usual, variance)
        day, slot = slot_of(seen.t_ns, self._zone)
        for key in (seen.leg,), (seen.leg, day), (seen.leg, day, slot):
            self._travel[key] = self._travel[key].with_value(ratio)
        self._young[seen.plan].append((seen.t_ns, ratio))

    def plan_off(self, plan: str, t_ns: int) -> float:
        """The logarithm of what is taken over what is planned, of a leg that nobody has driven."""
        young = self._young[plan]
        while young and young[0][0] <= t_ns - EARLIER_NS:
            self._plans[plan] = self._plans[plan].with_value(young.popleft()[1])
        return self._plans[plan].blended(0.0, OTHERS_HELD)

    def travel(self, leg: Leg, plan: str, t_ns: int, ahead_s: float = 0.0) -> Expected:
        """Of a leg that is begun `ahead_s` from an instant."""
        begun_ns = t_ns + round(ahead_s * 1e9)
        usual, variance = self._usual(leg.key, plan, begun_ns)
        if (now := self._now.get(leg.key)) is not None:
            faded = now.at(begun_ns)
            usual, variance = usual + faded.mean, variance + faded.variance
        # of a leg that was driven the mean is above the median; a plan tells means
        skewed = 0.5 * self._known(leg.key).variance(0.0, PRIOR_RUNS)
        mean_s = leg.planned_s * math.exp(usual + skewed)
        return Expected(mean_s, mean_s**2 * math.expm1(variance))

    def dwell(self, stop: str, plan: str, planned_s: float) -> Expected:
        """At a stop; where vehicles wait for their time, of those that are late."""
        known = self._dwell.get(stop, Forgetful())
        prior = max(DWELL_STD_S, 0.5 * planned_s) ** 2
        if known.weight > 0.0:
            planned_s = self._dwells[plan].blended(planned_s, DWELL_RUNS)
        mean_s = known.blended(planned_s, DWELL_RUNS)
        unsure = prior * DWELL_RUNS / (known.weight + DWELL_RUNS)
        return Expected(mean_s, known.variance(prior, DWELL_RUNS) + 0.25 * unsure)

    def late(self, wait: str) -> Expected:
        """How long after its time a vehicle leaves where it waits for it; negative: before it."""
        known = self._dwell.get(wait, Forgetful())
        variance = known.variance(LATE_STD_S**2, LATE_RUNS)
        return Expected(known.blended(0.0, LATE_RUNS), variance)

    def is_driven(self, leg: str) -> bool:
        """Whether anybody has taught of a leg."""
        return self._known(leg).weight > 0.0

    def dwells_seen(self, stop: str) -> float:
        """How many dwells at a stop have taught, those of long ago for less."""
        return self._dwell[stop].weight if stop in self._dwell else 0.0

    def _usual(self, leg: str, plan: str, t_ns: int) -> tuple[float, float]:
        """The logarithm of taken over planned, and its variance for one run."""
        day, slot = slot_of(t_ns, self._zone)
        of_leg, of_slot = self._known(leg), self._known(leg, day, slot)
        mean = of_leg.blended(self.plan_off(plan, t_ns), self._plan_held)
        mean = self._known(leg, day).blended(mean, DAY_HELD)
        mean = of_slot.blended(mean, SLOT_HELD)
        unsure = self._plan_variance * self._plan_held / (of_leg.weight + self._plan_held)
        spread = of_slot if of_slot.weight > PRIOR_RUNS else of_leg
        return mean, spread.variance(LEG_STD**2, PRIOR_RUNS) + unsure

    def _known(self, *key: object) -> Forgetful:
        return self._travel.get(key, Forgetful())


def is_wait(stop: str) -> bool:
    """Whether a key is of how late vehicles leave (`legs`), not of how long they stand."""
    return stop.endswith("|waits")


def _is_usual(seen: Taken) -> bool:
    return seen.planned_s / RATIO_MAX < seen.travel_s < seen.planned_s * RATIO_MAX
