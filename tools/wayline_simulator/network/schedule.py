"""Pure: the timetable of a simulated network: trips in whole minutes, and blocks of them.

Planned as an agency would: with the usual speed of the whole network, some more in rush hours, a
wait at the timepoint halfway. Trips follow each other in a block wherever a bus waits for its next
one, so that blocks change lines at the trunk's end.
"""

import itertools
from collections.abc import Iterator
from typing import NamedTuple

from wayline_simulator.network.model import NetworkModel
from wayline_simulator.network.motion import takes_s
from wayline_simulator.network.streets import Way
from wayline_simulator.network.traffic import USUAL_MPS, rush

FIRST_S = 6 * 3600
RUSH_SHARE = 0.6
"""Of a rush hour's delay that the timetable knows of."""
DWELL_S, LIGHT_S = 24.0, 15.0
"""On average at a stop (some are passed) and at a light (some are green)."""
PADDED = 1.02
HALFWAY_WAIT_S = 60
LAYOVER_S = 180
"""At least, between two trips of a block."""
SERVICES = ("weekday", "weekend")
HEADWAYS = (1, 2)
"""Multiples of the headway on such days."""


class PlannedTrip(NamedTuple):
    """A trip of the timetable; times in seconds after midnight."""

    trip_id: str
    service_id: str
    block_id: str
    way: Way
    arrivals_s: tuple[int | None, ...]
    """One a stop; None where the timetable gives no time, as at most."""
    departures_s: tuple[int | None, ...]

    @property
    def departs_s(self) -> int:
        """From the first stop."""
        return self.departures_s[0] or 0

    @property
    def ends_s(self) -> int:
        """At the last stop."""
        return self.arrivals_s[-1] or 0


def make_schedule(model: NetworkModel, ways: tuple[Way, ...]) -> tuple[PlannedTrip, ...]:
    """The trips of both kinds of day, each kind in order of departure."""
    return tuple(
        trip
        for service_id, multiple in zip(SERVICES, HEADWAYS, strict=True)
        for trip in _in_blocks(list(_trips(model, ways, service_id, multiple)))
    )


def _trips(
    model: NetworkModel, ways: tuple[Way, ...], service_id: str, multiple: int
) -> Iterator[PlannedTrip]:
    headway_s = multiple * model.headway_min * 60
    for place, way in enumerate(ways):
        # lines take turns on the trunk
        first_s = FIRST_S + (place // 2) * (headway_s // 120) * 60
        for departs_s in range(first_s, FIRST_S + round(model.hours * 3600.0), headway_s):
            yield _trip(way, service_id, departs_s)


def _trip(way: Way, service_id: str, departs_s: int) -> PlannedTrip:
    rushed = 1.0 + (RUSH_SHARE * rush(departs_s) if service_id == SERVICES[0] else 0.0)
    stops, halfway = way.stops, len(way.stops) // 2
    passed_s, waited_s = 0.0, 0
    arrivals_s: list[int | None] = [departs_s]
    departures_s: list[int | None] = [departs_s]
    for before, stop in itertools.pairwise(stops):
        lights = sum(before.along_m < at_m < stop.along_m for at_m in way.lights_m)
        moving_s = takes_s(stop.along_m - before.along_m, USUAL_MPS) * rushed
        passed_s += PADDED * (moving_s + DWELL_S + lights * LIGHT_S)
        time_s = departs_s + waited_s + round(passed_s / 60.0) * 60
        waits_s = HALFWAY_WAIT_S if stop is stops[halfway] else 0
        waited_s += waits_s
        arrivals_s.append(time_s if stop.is_timepoint else None)
        departures_s.append(time_s + waits_s if stop.is_timepoint else None)
    minutes = departs_s // 60
    trip_id = f"{way.way_id}-{minutes // 60:02d}{minutes % 60:02d}-{service_id}"
    return PlannedTrip(trip_id, service_id, "", way, tuple(arrivals_s), tuple(departures_s))


def _in_blocks(trips: list[PlannedTrip]) -> Iterator[PlannedTrip]:
    """Each trip by the bus that has waited longest at its first stop, else by another bus."""
    waiting: list[PlannedTrip] = []
    blocks = 0
    for trip in sorted(trips, key=lambda each: each.departs_s):
        ready = [
            last
            for last in waiting
            if last.way.stops[-1].stop_id == trip.way.stops[0].stop_id
            and last.ends_s + LAYOVER_S <= trip.departs_s
        ]
        if ready:
            before = min(ready, key=lambda last: last.ends_s)
            waiting.remove(before)
            block_id = before.block_id
        else:
            blocks += 1
            block_id = f"{trip.service_id}-{blocks}"
        placed = trip._replace(block_id=block_id)
        waiting.append(placed)
        yield placed
