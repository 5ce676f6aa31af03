"""Pure: where a vehicle stops on this run, and how others slow it down."""

from typing import NamedTuple

import numpy as np

from wayline_simulator.course import STEP_M, Course, Floats, Halt
from wayline_simulator.driver import DriverModel
from wayline_simulator.noise import gauss_markov

TURN_S = 1.5
"""To change between forwards and reverse; judgement."""
MERGE_M = 1.0
"""Stops so near to each other are one."""
SLOWEST_SHARE = 0.35
"""Of the free speed, in dense traffic that still rolls; judgement."""
SLOW_DOWN_STD = 0.35
"""Of the slow-downs at density 1; judgement."""
SLOW_DOWN_LENGTH_M = 500.0
"""Over which traffic changes; judgement."""
SMOOTH_M = 60.0
"""Nobody's speed changes within fewer metres without a reason."""
QUEUES_PER_KM = 0.5
"""At density 1 in a town; judgement, as all of a queue is."""
TOWN_MPS = 50.0 / 3.6
"""On faster roads queues are rarer, with the square of the limit."""
QUEUE_M = (40.0, 300.0)
QUEUE_MPS = (2.0, 6.0)
QUEUE_HALT_EVERY_M = 60.0
QUEUE_HALT_S = (2.0, 12.0)
SHORTEST_S = 1.0


class Standstill(NamedTuple):
    """Where the vehicle will stand on this run."""

    distance_m: float
    wait_s: float
    parked: bool = False
    """No foot on the brake."""


class Queue(NamedTuple):
    """Stop-and-go from one distance to another."""

    start_m: float
    end_m: float
    speed_mps: float


def queues(course: Course, driver: DriverModel, random: np.random.Generator) -> list[Queue]:
    """Where others stand in the way; never where the vehicle manoeuvres."""
    expected = driver.traffic_density * QUEUES_PER_KM * course.length_m / 1000.0
    found = []
    for start_m in np.sort(random.uniform(0.0, course.length_m, random.poisson(expected))):
        end_m = min(start_m + random.uniform(*QUEUE_M), course.length_m)
        speed_mps, chance = random.uniform(*QUEUE_MPS), random.random()
        first, last = int(start_m / STEP_M), int(end_m / STEP_M) + 1
        limits_mps = course.limits_mps[first:last]
        if limits_mps.min() > speed_mps and chance < (TOWN_MPS / limits_mps.max()) ** 2:
            found.append(Queue(float(start_m), float(end_m), speed_mps))
    return found


def flow_share(course: Course, driver: DriverModel, random: np.random.Generator) -> Floats:
    """Share of the permitted speed that driver and traffic make of it, shape (n,)."""
    count = len(course.distances_m)
    own = _wander(count, driver.wander_length_m, random)
    others = _wander(count, SLOW_DOWN_LENGTH_M, random)
    slow_down = SLOW_DOWN_STD * driver.traffic_density * np.maximum(others, 0.0)
    return np.maximum((1.0 + driver.wander_std * own) * (1.0 - slow_down), SLOWEST_SHARE)


def planned_stops(
    course: Course, driver: DriverModel, jams: list[Queue], random: np.random.Generator
) -> list[Standstill]:
    """All stops of this run in order of distance, the course's end last."""
    halts = [stop for halt in course.halts if (stop := _stop(halt, driver, random))]
    turns = [
        Standstill(float(course.distances_m[at]), TURN_S)
        for at in np.flatnonzero(course.backwards[1:-1] != course.backwards[:-2]) + 1
    ]
    jammed = [stop for jam in jams for stop in _queue_stops(jam, random)]
    # where stops are one, a turn's exact place counts: so turns come first
    stops = [Standstill(course.length_m, driver.wait_end_s, parked=True)]
    for stop in (*turns, *halts, *jammed):
        _merge(stops, stop)
    return sorted(stops)


def _merge(stops: list[Standstill], stop: Standstill) -> None:
    if stop.distance_m < MERGE_M:
        return
    for place, other in enumerate(stops):
        if abs(other.distance_m - stop.distance_m) < MERGE_M:
            longer, parked = max(other.wait_s, stop.wait_s), other.parked or stop.parked
            stops[place] = Standstill(other.distance_m, longer, parked)
            return
    stops.append(stop)


def _stop(halt: Halt, driver: DriverModel, random: np.random.Generator) -> Standstill | None:
    """What a halt is on this run; the same count of random numbers whatever comes out."""
    chance, part, spread = random.random(), random.random(), random.standard_normal()
    if halt.kind == "light":
        red = chance < driver.red_probability
        return Standstill(halt.distance_m, max(part * halt.dwell_s, SHORTEST_S)) if red else None
    if halt.kind == "turn":
        return Standstill(halt.distance_m, TURN_S)
    dwell_s = halt.dwell_s * float(np.exp(driver.dwell_spread * spread))
    return Standstill(halt.distance_m, max(dwell_s, SHORTEST_S), parked=halt.kind == "park")


def _queue_stops(queue: Queue, random: np.random.Generator) -> list[Standstill]:
    count = random.poisson((queue.end_m - queue.start_m) / QUEUE_HALT_EVERY_M)
    places_m = random.uniform(queue.start_m, queue.end_m, count)
    return [Standstill(float(place_m), random.uniform(*QUEUE_HALT_S)) for place_m in places_m]


def _wander(count: int, length_m: float, random: np.random.Generator) -> Floats:
    """A smooth process over distance with a standard deviation near 1."""
    rough = gauss_markov(count, STEP_M, 1.0, length_m, random)
    width = min(round(SMOOTH_M / STEP_M), count)
    padded = np.pad(rough, (width, width), mode="edge")
    return np.convolve(padded, np.ones(width) / width, mode="same")[width:-width]
