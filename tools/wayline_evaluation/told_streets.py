"""Pure: when a simulated bus comes, for who is told all but what chance will still bring.

Told are its place, the speed of every street, the day, the driver, and the congestion of now; not
which lights will be red, which stops served, how long it stands, and how congestion will change.
Nobody who knows less can be better on average: what is left is chance.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_simulator.network.motion import RATE_MPS2
from wayline_simulator.network.ride import (
    BOARDS_SHARE,
    LATE_START_S,
    RED_SHARE,
    STANDS_S,
    TURN_S,
    Stage,
    segment_to,
)
from wayline_simulator.network.schedule import PlannedTrip
from wayline_simulator.network.streets import Way
from wayline_simulator.network.traffic import DayTraffic

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

FUTURES = 200
HERE_M = 0.5
"""Who stands so near to a place stands there."""


class Place(NamedTuple):
    """Where a bus may stand."""

    along_m: float
    stop: int | None
    """None: a light."""
    chance: float


class Now(NamedTuple):
    """A bus at an instant; seconds after midnight."""

    time_s: float
    along_m: float
    stands: bool
    since_s: float
    """When it came to where it stands."""


class ToldStreets:
    """Of one trip of a bus."""

    def __init__(self, stage: Stage, trip: PlannedTrip, traffic: DayTraffic) -> None:
        self._stage, self._trip, self._traffic = stage, trip, traffic
        self._places = _places(trip.way)

    def arrivals_s(self, time_s: float, random: np.random.Generator) -> dict[str, Floats]:
        """When it may come to the stops ahead, by stop: of shape (FUTURES,), after midnight."""
        now = self._now(time_s)
        ahead = [each for each in self._places if each.along_m > now.along_m + HERE_M]
        from_m, leaves_s = np.full(FUTURES, now.along_m), self._leaves_s(now, random)
        rolls = np.full(FUTURES, not now.stands)
        comes_s: dict[int, Floats] = {}
        for place in ahead:
            way_m = place.along_m - from_m
            speeds_mps = self._speeds_mps(place.along_m, time_s, leaves_s, random)
            tops_mps = np.minimum(speeds_mps, np.sqrt(way_m * RATE_MPS2))
            ups_s = np.where(rolls, 0.0, tops_mps / (2.0 * RATE_MPS2))
            passes_s = leaves_s + way_m / tops_mps + ups_s
            stands = random.random(FUTURES) < place.chance
            stops_s = passes_s + tops_mps / (2.0 * RATE_MPS2)
            if place.stop is not None:
                comes_s[place.stop] = np.where(stands, stops_s, passes_s)
            goes_s = stops_s + random.uniform(*STANDS_S, FUTURES)
            goes_s = np.maximum(goes_s, self._planned_s(place.stop))
            from_m = np.where(stands, place.along_m, from_m)
            leaves_s, rolls = np.where(stands, goes_s, leaves_s), rolls & ~stands
        stops = self._trip.way.stops
        return {stops[stop].stop_id: times_s for stop, times_s in comes_s.items()}

    def _now(self, time_s: float) -> Now:
        motion = self._stage.motion
        alongs_m, speeds_mps = motion.at(np.array([time_s]))
        along_m = float(alongs_m[0])
        came = int(np.searchsorted(motion.alongs_m, along_m - 1e-6))
        since_s = float(motion.times_s[min(came, len(motion.times_s) - 1)])
        return Now(time_s, along_m, bool(speeds_mps[0] <= 0.0), since_s)

    def _leaves_s(self, now: Now, random: np.random.Generator) -> Floats:
        """When it leaves where it stands; under way now."""
        if not now.stands:
            return np.full(FUTURES, now.time_s)
        if now.along_m <= HERE_M:
            late_s = random.exponential(LATE_START_S, FUTURES)
            ready_s = now.since_s + TURN_S
            return np.maximum(max(now.time_s, self._trip.departs_s) + late_s, ready_s)
        shortest_s, longest_s = STANDS_S
        stood_s = min(now.time_s - now.since_s, longest_s)
        stands_s = random.uniform(max(shortest_s, stood_s), longest_s, FUTURES)
        here = next((p for p in self._places if abs(p.along_m - now.along_m) <= HERE_M), None)
        planned_s = self._planned_s(None if here is None else here.stop)
        return np.maximum(np.maximum(now.since_s + stands_s, planned_s), now.time_s)

    def _planned_s(self, stop: int | None) -> float:
        """Before when it does not leave a stop."""
        if stop is None or stop == len(self._trip.way.stops) - 1:
            return 0.0
        return float(self._trip.departures_s[stop] or 0)

    def _speeds_mps(
        self, along_m: float, now_s: float, leaves_s: Floats, random: np.random.Generator
    ) -> Floats:
        segment, chance = segment_to(self._trip.way, along_m), random.standard_normal(FUTURES)
        run_log = self._stage.run_log
        return self._traffic.foreseen_mps(segment, now_s, leaves_s, run_log, chance)


def _places(way: Way) -> list[Place]:
    last = len(way.stops) - 1
    served = [
        Place(stop.along_m, at, 1.0 if at == last or stop.is_timepoint else BOARDS_SHARE)
        for at, stop in enumerate(way.stops)
        if at
    ]
    lights = [Place(at_m, None, RED_SHARE) for at_m in way.lights_m]
    return sorted([*served, *lights], key=lambda place: place.along_m)
