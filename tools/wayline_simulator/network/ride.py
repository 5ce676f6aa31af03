"""Pure: a bus's day: from the yard, the trips of a block with their layovers, back to the yard."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wayline.line import Line
from wayline_simulator.network.motion import Driving, Motion, takes_s
from wayline_simulator.network.schedule import PlannedTrip
from wayline_simulator.network.streets import ORIGIN, NetworkStop, Way
from wayline_simulator.network.traffic import RUN_STD, DayTraffic

YARD_M = 900.0
"""From a terminal, by two streets."""
YARD_MPS = 8.0
READY_S = 240.0
"""A bus is at its first stop so long before its first departure."""
TURN_S = 60.0
"""A late bus leaves so long after its arrival."""
STANDS_S = (20.0, 40.0)
"""At stops and at red lights."""
BOARDS_SHARE, RED_SHARE = 0.8, 0.5
LATE_START_S = 40.0
"""On average, behind the departure of the timetable."""
REST_S = 120.0
"""In the yard, before and after."""


class Visit(NamedTuple):
    """A bus at a stop; times in seconds after midnight."""

    trip_id: str
    stop_id: str
    arrives_s: float
    """It first stands there, or passes."""
    departs_s: float
    stood: bool


class Stage(NamedTuple):
    """A part of a bus's day."""

    begins_s: float
    ends_s: float
    street: Line
    motion: Motion
    trip: PlannedTrip | None
    """None on the way from and to the yard."""
    run_log: float = 0.0
    """Of the logarithm of the times that its driver takes."""


class Ride(NamedTuple):
    """A bus's day, without holes."""

    stages: tuple[Stage, ...]
    visits: tuple[Visit, ...]


def drive_block(
    trips: Sequence[PlannedTrip], traffic: DayTraffic, random: np.random.Generator
) -> Ride:
    """Drive the trips of a block, each with its layover before it."""
    first, last = trips[0], trips[-1]
    out = yard_street(first.way.stops[0])
    arrives_s = first.departs_s - READY_S
    leaves_s = arrives_s - takes_s(out.length_m, YARD_MPS)
    stages = [_deadhead(out, leaves_s - REST_S, leaves_s)]
    stages[0] = stages[0]._replace(ends_s=arrives_s)
    visits: list[Visit] = []
    for trip in trips:
        run_log = float(random.normal(0.0, RUN_STD))
        motion, there = drive_trip(trip, arrives_s, run_log, traffic, random)
        ends_s, street = there[-1].arrives_s, trip.way.street
        stages.append(Stage(arrives_s, ends_s, street, motion, trip, run_log))
        arrives_s = ends_s
        visits += there
    back = yard_street(last.way.stops[-1])
    home = Line(back.lats_deg[::-1], back.lons_deg[::-1])
    stages.append(_deadhead(home, arrives_s, arrives_s + TURN_S))
    return Ride(tuple(stages), tuple(visits))


def _deadhead(street: Line, begins_s: float, leaves_s: float) -> Stage:
    driving = Driving(begins_s)
    driving.stand_until(leaves_s)
    driving.go(street.length_m, YARD_MPS)
    ends_s = driving.time_s + REST_S
    return Stage(begins_s, ends_s, street, driving.motion(), None)


def yard_street(terminal: NetworkStop) -> Line:
    """From a yard to a terminal, round one corner."""
    east_m, north_m = ORIGIN.to_plane(terminal.lat_deg, terminal.lon_deg)
    half_m = YARD_M / 2.0
    places_m = ((east_m + half_m, north_m - half_m), (east_m, north_m - half_m), (east_m, north_m))
    places = np.array([ORIGIN.to_geodetic(*place) for place in places_m])
    return Line(places[:, 0], places[:, 1])


def drive_trip(
    trip: PlannedTrip,
    arrives_s: float,
    run_log: float,
    traffic: DayTraffic,
    random: np.random.Generator,
) -> tuple[Motion, list[Visit]]:
    """From the arrival at the first stop to that at the last; early buses wait at timepoints."""
    way = trip.way
    leaves_s = trip.departs_s + random.exponential(LATE_START_S)
    driving = Driving(arrives_s)
    driving.stand_until(max(leaves_s, arrives_s + TURN_S))
    left_s = {0: driving.time_s}
    for at_m, stop in _standstills(way, random):
        driving.go(at_m, traffic.speed_mps(segment_to(way, at_m), driving.time_s, run_log))
        stands_s = random.uniform(*STANDS_S)
        if stop is not None and stop < len(way.stops) - 1:
            planned_s = trip.departures_s[stop]
            left_s[stop] = max(driving.time_s + stands_s, planned_s or 0)
        driving.stand_until(driving.time_s + stands_s if stop is None else left_s.get(stop, 0.0))
    motion = driving.motion()
    return motion, [_visit(trip, at, motion, left_s) for at in range(len(way.stops))]


def _standstills(way: Way, random: np.random.Generator) -> list[tuple[float, int | None]]:
    """Places with the stop that they are, None for a red light; the last stop is the last."""
    last = len(way.stops) - 1
    served: list[tuple[float, int | None]] = [
        (stop.along_m, at)
        for at, stop in enumerate(way.stops)
        if at and (at == last or stop.is_timepoint or random.random() < BOARDS_SHARE)
    ]
    red = [(at_m, None) for at_m in way.lights_m if random.random() < RED_SHARE]
    return sorted([*served, *red], key=lambda each: each[0])


def segment_to(way: Way, before_m: float) -> tuple[str, str]:
    """The stretch whose end is at or beyond a place."""
    after = next(at for at, stop in enumerate(way.stops) if at and stop.along_m >= before_m)
    return way.stops[after - 1].stop_id, way.stops[after].stop_id


def _visit(trip: PlannedTrip, at: int, motion: Motion, left_s: dict[int, float]) -> Visit:
    stop = trip.way.stops[at]
    arrives_s = motion.times_s[0] if at == 0 else motion.passes_s(stop.along_m)
    departs_s = left_s.get(at, arrives_s)
    stood = at in left_s or at == len(trip.way.stops) - 1
    return Visit(trip.trip_id, stop.stop_id, float(arrives_s), float(departs_s), stood)
