"""Pure: what a vehicle did at the stops of its route: came, left, passed by, left out; each once.

What happened between two sightings is reckoned: the way between them took as long as it did, and
was driven from stop to stop as planned.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.messages import Disruption, StopEventKind
from wayline.route import Route
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.stop_visits import stands_within_m

Floats = NDArray[np.float64]

SEEN_S = 2.0
"""What happens between sightings no farther apart was seen."""
AT_STOP_M = 10.0
"""A vehicle that stands this near to a stop has arrived (SPEC section 8) ..."""
REPORTED_AT_STOP_M = 25.0
"""... where it is known so well; reports err by more."""
GOES_BACK_M = 100.0
"""A place this far behind the last one is a new trip."""
FASTEST_MPS = 45.0
"""Who comes on faster was put on another place: what lies between was left out."""


class Seen(NamedTuple):
    """A vehicle on its route at one instant."""

    t_ns: int
    total_m: float
    """Over all laps."""
    stands: bool
    reported: bool
    stood_s: float = 0.0
    """Since it came to where it stands, as far as that is known."""
    speed_mps: float = 0.0
    """Where it is seen all the time."""


class Happening(NamedTuple):
    """What a vehicle did at a stop."""

    t_ns: int
    stop: int
    """In the route's stops."""
    lap: int
    kind: StopEventKind
    interpolated: bool
    disruption: Disruption | None = None


class StopLog:
    """Of one vehicle on one route, from its first sighting there."""

    def __init__(self, route: Route, motion: ExpectedMotion) -> None:
        self._route, self._motion = route, motion
        self._order = np.argsort(route.stop_distances_m, kind="stable").tolist()
        self._next = 0
        """The visit that comes next; they are counted on over the laps."""
        self._crossed: list[Happening] = []
        """Of the next visits those whose places it has gone past, by no more than it may err."""
        self._at: int | None = None
        """The visit that lasts."""
        self._last: Seen | None = None
        self._was_off = False

    def off_route(self) -> None:
        """The vehicle has left the route: what it does not come back to in time is left out."""
        self._was_off = True

    def observe(self, seen: Seen) -> list[Happening]:
        """What has happened up to a sighting on the route."""
        last = self._last
        if last is None or seen.total_m < last.total_m - GOES_BACK_M:
            self._begin(seen)
            last = seen
        self._last = seen
        happened = [*self._departure(last, seen), *self._passes(last, seen)]
        happened += self._arrival(last, seen)
        self._was_off = False
        return happened

    def finish(self, t_ns: int) -> list[Happening]:
        """The vehicle has begun another trip: what is left of an open route is left out."""
        if self._route.loop or self._last is None:
            return []
        passed, self._crossed = self._crossed, []
        left = range(self._next + len(passed), len(self._order))
        self._next = len(self._order)
        skipped = [self._happening(t_ns, visit, "skipped", reckoned=True) for visit in left]
        return [*passed, *skipped]

    def _begin(self, seen: Seen) -> None:
        self._at, self._next, self._crossed = None, 0, []
        if not self._order:
            return
        if self._route.loop:
            laps = int(np.floor(seen.total_m / self._route.length_m))
            self._next = max(laps, 0) * len(self._order)
        begins_m = seen.total_m - (_near(seen) if seen.stands else 0.0)
        while self._is_visit(self._next) and self._place_m(self._next) < begins_m:
            self._next += 1

    def _departure(self, last: Seen, seen: Seen) -> list[Happening]:
        if self._at is None:
            return []
        away_m = seen.total_m - self._place_m(self._at)
        if seen.stands and abs(away_m) <= _near(seen):
            return []
        if not seen.reported and abs(away_m) <= _near(seen):
            return []
        visit, self._at = self._at, None
        took_s = self._driving_s(self._place_m(visit), seen.total_m)
        t_ns = max(seen.t_ns - round(took_s * 1e9), last.t_ns)
        return [self._happening(t_ns, visit, "departed", reckoned=_unseen(last, seen))]

    def _passes(self, last: Seen, seen: Seen) -> list[Happening]:
        """What lies behind; who has just gone past may still stand there, or has only erred."""
        self._crossed += self._crossings(last, seen)
        passed: list[Happening] = []
        while self._crossed and self._has_passed(self._next, seen):
            passed.append(self._crossed.pop(0))
            self._next += 1
        return passed

    def _has_passed(self, visit: int, seen: Seen) -> bool:
        past_m, near_m = seen.total_m - self._place_m(visit), _near(seen)
        if seen.stands or seen.reported:
            return past_m > near_m or not seen.stands
        left_m = math.inf if self._route.loop else self._route.length_m - self._place_m(visit)
        return past_m >= min(stands_within_m(near_m, seen.speed_mps), left_m)

    def _crossings(self, last: Seen, seen: Seen) -> list[Happening]:
        """The stops whose places a vehicle has gone past since it was seen last."""
        crossed = []
        visit = self._next + len(self._crossed)
        while self._is_visit(visit) and self._place_m(visit) <= seen.total_m:
            crossed.append(visit)
            visit += 1
        if not crossed:
            return []
        apart_s = max((seen.t_ns - last.t_ns) * 1e-9, 1e-3)
        if self._was_off or seen.total_m - last.total_m > FASTEST_MPS * apart_s + GOES_BACK_M:
            return [self._left_out(seen.t_ns, each) for each in crossed]
        times_ns = self._times_ns(last, seen, crossed)
        reckoned = _unseen(last, seen)
        return [
            self._happening(t_ns, each, "passed", reckoned=reckoned)
            for each, t_ns in zip(crossed, times_ns, strict=True)
        ]

    def _arrival(self, last: Seen, seen: Seen) -> list[Happening]:
        """Bays metres apart are arrived at together; the last one's is the departure."""
        arrived = []
        while seen.stands and self._is_visit(self._next):
            if abs(self._place_m(self._next) - seen.total_m) > _near(seen):
                break
            self._at, self._next = self._next, self._next + 1
            del self._crossed[:1]
            reckoned = _unseen(last, seen) and last.total_m < seen.total_m
            came_ns = seen.t_ns - round(seen.stood_s * 1e9)
            t_ns = min(max(came_ns, last.t_ns), seen.t_ns) if reckoned else seen.t_ns
            arrived.append(self._happening(t_ns, self._at, "arrived", reckoned=reckoned))
        return arrived

    def _times_ns(self, last: Seen, seen: Seen, visits: list[int]) -> list[int]:
        """When stops between two sightings were reached: as planned, in the time that it took."""
        unseen, after_s, at_s, here_m = _unseen(last, seen), [], 0.0, last.total_m
        for visit in visits:
            at_s += self._driving_s(here_m, self._place_m(visit))
            after_s.append(at_s)
            here_m = max(self._place_m(visit), here_m)
            is_left = seen.total_m - self._place_m(visit) > _near(seen)
            at_s += self._dwell_s(visit) if unseen and is_left else 0.0
        whole_s = at_s + self._driving_s(here_m, seen.total_m)
        scale = (seen.t_ns - last.t_ns) * 1e-9 / max(whole_s, 1e-3)
        return [last.t_ns + round(each * scale * 1e9) for each in after_s]

    def _driving_s(self, from_m: float, to_m: float) -> float:
        begins_s, ends_s = self._motion.driven_s(np.array([from_m, max(to_m, from_m)])).tolist()
        return float(ends_s - begins_s)

    def _dwell_s(self, visit: int) -> float:
        place_m = self._place_m(visit)
        stop = self._motion.stop_near(place_m, 0.1, 0.1)
        return float(self._motion.dwells_s[stop[1]]) if stop is not None else 0.0

    def _is_visit(self, visit: int) -> bool:
        return bool(self._order) and (self._route.loop or visit < len(self._order))

    def _place_m(self, visit: int) -> float:
        lap, at = divmod(visit, len(self._order))
        place_m = float(self._route.stop_distances_m[self._order[at]])
        return place_m + lap * self._route.length_m

    def _left_out(self, t_ns: int, visit: int) -> Happening:
        skipped = self._happening(t_ns, visit, "skipped", reckoned=True)
        return skipped._replace(disruption="detour" if self._was_off else None)

    def _happening(
        self, t_ns: int, visit: int, kind: StopEventKind, *, reckoned: bool
    ) -> Happening:
        lap, at = divmod(visit, len(self._order))
        return Happening(t_ns, self._order[at], lap, kind, reckoned)


def _near(seen: Seen) -> float:
    return REPORTED_AT_STOP_M if seen.reported else AT_STOP_M


def _unseen(last: Seen, seen: Seen) -> bool:
    return (seen.t_ns - last.t_ns) * 1e-9 > SEEN_S
