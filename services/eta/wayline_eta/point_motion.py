"""Pure: how the points of the along filter go on: from stand to stand, each at its own pace."""

import numpy as np
from numpy.typing import NDArray

from wayline_eta.draws import POINTS, Draws
from wayline_eta.expected_motion import ExpectedMotion
from wayline_eta.points import BETWEEN, Leg, Points, made_leg
from wayline_eta.stands import TAIL

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.intp]

LEG_STD = 0.2
"""Of the logarithm of one leg's pace about the vehicle's own: from standstill to standstill."""
RATE_MIN, RATE_MAX = 0.2, 4.0
"""Of the planned speeds; no leg is driven slower or faster."""
SKIPPED = 0.15
"""So many stops that may be are passed without a stand, at most SKIPPED_MAX in a row."""
SKIPPED_MAX = 2
HELD_UP = 0.1
"""On the way to so many stops there is a stand before, at a light or in a queue."""
HELD_UP_S = 20.0
"""A stand between stops lasts at least about so long."""
CLEAR_M = 30.0
"""A stand between stops is farther from both, and from where a leg begins."""
DWELL_STD_S = 5.0
"""Of one dwell about the usual one."""
TERMINAL_S = 60.0
"""Where an open route begins vehicles wait, whether or not that is their time."""
FOR_GOOD_S = 1e6
"""Where an open route ends they stay."""
QUEUE_TAIL = 2.0
"""Exponent of how long lights and queues last: they are over sooner than what holds a bus up."""
OVERDUE_SHARE = 0.3
"""At a stop, where a dwell is over: so much of such a stand."""
HELD_UP_AFTER_S = 60.0
"""What has outlasted a dwell or a light by so long is neither any more."""


class PointMotion:
    """By the plan of one route; seconds count from `begun_ns`."""

    def __init__(self, motion: ExpectedMotion, begun_ns: int, draws: Draws) -> None:
        self.motion, self._begun_ns, self._draws = motion, begun_ns, draws

    def gone_on(self, points: Points, at_s: float) -> Points:
        """As they are at an instant: those whose stands are over are on their next leg."""
        while np.any(over := points.leaves_s <= at_s):
            rates = self._rates(points, points.leg.ends_m)
            points = self._going(
                points, over, points.leg.ends_m, points.leaves_s, rates, rolling=False
            )
        return points

    def rolling(
        self,
        points: Points,
        which: Flags,
        at_s: float,
        places_m: Floats,
        rates: Floats | None = None,
    ) -> Points:
        """Some points under way at places; without their rates at their own paces."""
        rates = self._rates(points, places_m) if rates is None else rates
        return self._going(points, which, places_m, np.full(POINTS, at_s), rates, rolling=True)

    def standing(
        self,
        points: Points,
        which: Flags,
        at_s: float,
        stop: tuple[float, int] | None,
        place_m: float,
    ) -> Points:
        """Some points in the middle of a stand, at a stop where one is near."""
        at_m = stop[0] if stop else place_m
        if stop:
            stands_s = np.maximum(self.motion.dwells_s[stop[1]] + points.extras_s, 2.0)
        else:
            stands_s = self._held_s()
        if stop and stop[0] <= self.motion.start_m:
            stands_s = np.maximum(stands_s, TERMINAL_S)
        stood_s = stands_s * self._draws.even()
        (planned_s,) = self.motion.driven_s(np.array([at_m]))
        leg = points.leg._replace(
            begins_m=np.where(which, at_m, points.leg.begins_m),
            ends_m=np.where(which, at_m, points.leg.ends_m),
            comes_s=np.where(which, at_s - stood_s, points.leg.comes_s),
            begun_s=np.where(which, planned_s, points.leg.begun_s),
            ended_s=np.where(which, planned_s, points.leg.ended_s),
        )
        return points._replace(
            leg=leg,
            leaves_s=np.where(which, at_s - stood_s + stands_s, points.leaves_s),
            stops=np.where(which, stop[1] if stop else BETWEEN, points.stops),
        )

    def still_stands_s(self, points: Points, at_s: float) -> Floats:
        """The rest of a dwell, given how long it has lasted; what outlasts it is a stand."""
        at_stop = points.stops != BETWEEN
        stood_s = points.stood_s(at_s)
        usual_s = np.where(at_stop, self._dwells_s(points.stops, points.extras_s), 0.0)
        dwells_s = usual_s + DWELL_STD_S * self._draws.normal()
        overdue_s = -self._until_s(points.stops, np.full(POINTS, at_s))
        over_s = np.maximum(np.minimum(stood_s - usual_s, overdue_s) - DWELL_STD_S, 0.0)
        at_start = at_stop & (points.leg.ends_m <= self.motion.start_m) & np.isinf(overdue_s)
        least_s = np.where(at_start, TERMINAL_S, HELD_UP_S)
        held_up = over_s > HELD_UP_AFTER_S
        exponents = np.where(held_up, -1.0 / TAIL, -1.0 / QUEUE_TAIL)
        tail_s = (least_s + over_s) * (self._draws.even() ** exponents - 1.0)
        tail_s = np.where(at_stop & ~at_start & ~held_up, OVERDUE_SHARE, 1.0) * tail_s
        rest_s = dwells_s - stood_s
        stands_s = np.where(at_stop & (rest_s > 0.0), rest_s, tail_s)
        stands_s = np.maximum(stands_s, self._waits_s(points.stops, np.full(POINTS, at_s)))
        ended = points.left_s(at_s) > FOR_GOOD_S / 2.0
        return np.where(ended, FOR_GOOD_S, stands_s)

    def _going(
        self,
        points: Points,
        which: Flags,
        begins_m: Floats,
        set_out_s: Floats,
        rates: Floats,
        *,
        rolling: bool,
    ) -> Points:
        """Some points on a leg to a standstill that is drawn for it."""
        ends_m, stops = self._standstills(begins_m)
        rates = np.clip(rates, RATE_MIN, RATE_MAX)
        leg = made_leg(self.motion, begins_m, ends_m, set_out_s, rates, rolling=rolling)
        stands_s = self._stands_s(points, stops, leg)
        return points._replace(
            leg=Leg(*(np.where(which, new, old) for new, old in zip(leg, points.leg, strict=True))),
            leaves_s=np.where(which, leg.comes_s + stands_s, points.leaves_s),
            stops=np.where(which, stops, points.stops),
        )

    def _rates(self, points: Points, from_m: Floats) -> Floats:
        """Of legs that begin at places, each with a pace of its own about the vehicle's."""
        _, stops = self.motion.next_stops(from_m)
        leg_paces = np.exp(LEG_STD * self._draws.normal())
        return np.asarray(points.paces * leg_paces * self.motion.hurries[stops])

    def _standstills(self, from_m: Floats) -> tuple[Floats, Indices]:
        """Where vehicles will stand next, and at which stop."""
        motion = self.motion
        places_m, stops = motion.next_stops(from_m)
        skipped = np.full(POINTS, True)
        for _ in range(SKIPPED_MAX if len(motion.stops_m) else 0):
            later_m, later = motion.next_stops(places_m)
            skipped &= (self._draws.even() < SKIPPED) & motion.may_be_skipped[stops]
            skipped &= np.isfinite(later_m)
            places_m, stops = np.where(skipped, later_m, places_m), np.where(skipped, later, stops)
        beyond = ~np.isfinite(places_m)
        places_m = np.where(beyond, motion.beyond_m(from_m), places_m)
        before_m = from_m + self._draws.even() * (places_m - from_m)
        held = (self._draws.even() < HELD_UP) & (before_m > from_m + CLEAR_M)
        held &= before_m < places_m - CLEAR_M
        return np.where(held, before_m, places_m), np.where(held | beyond, BETWEEN, stops)

    def _stands_s(self, points: Points, stops: Indices, leg: Leg) -> Floats:
        """How long vehicles will stand where they come to."""
        held_s = self._held_s()
        dwells_s = self._dwells_s(stops, points.extras_s) + DWELL_STD_S * self._draws.normal()
        stands_s = np.where(stops == BETWEEN, held_s, np.maximum(dwells_s, 1.0))
        stands_s = np.maximum(stands_s, self._waits_s(stops, leg.comes_s))
        ended = leg.ends_m >= min(self.motion.end_m, self.motion.last_m) - 0.1
        return np.where(ended, FOR_GOOD_S, stands_s)

    def _held_s(self) -> Floats:
        """How long stands between stops last, those just begun."""
        return HELD_UP_S * self._draws.even() ** (-1.0 / QUEUE_TAIL)

    def _waits_s(self, stops: Indices, at_s: Floats) -> Floats:
        """Until the vehicle may leave stops, of those that it has come to at instants."""
        return np.where(stops == BETWEEN, 0.0, np.maximum(self._until_s(stops, at_s), 0.0))

    def _until_s(self, stops: Indices, at_s: Floats) -> Floats:
        """To when the vehicle may leave stops, from instants; -inf where it always may."""
        if not len(self.motion.leaves_ns):
            return np.full(len(stops), -np.inf)
        return np.asarray((self.motion.leaves_ns[stops] - self._begun_ns) * 1e-9 - at_s)

    def _dwells_s(self, stops: Indices, extras_s: Floats) -> Floats:
        if not len(self.motion.dwells_s):
            return np.zeros(len(stops))
        return np.maximum(self.motion.dwells_s[stops] + extras_s, 0.0)
