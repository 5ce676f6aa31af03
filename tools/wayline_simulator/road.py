"""Makes the course that a scenario's `[road]` describes: one lap, the same for every run."""

from pathlib import Path

import numpy as np

from wayline.errors import InputError
from wayline_simulator.closing import Start
from wayline_simulator.country_road import HILLS, MAIN, MOTORWAY, country_loop, open_country_road
from wayline_simulator.course import Course, Surroundings
from wayline_simulator.file_road import plan_along
from wayline_simulator.garage import garage_road
from wayline_simulator.interchange import figure_of_eight, motorway
from wayline_simulator.line_files import read_line
from wayline_simulator.road_model import RoadModel
from wayline_simulator.road_plan import (
    RoadPlan,
    Stretch,
    dig,
    lay_plan,
    place_stops,
    some_tunnels,
)
from wayline_simulator.town import town_loop, town_road

ROAD_STREAM = 1
"""Tells the road's randomness from that of the driver and the sensors of the same seed."""
LENGTHS_M = {
    "motorway": 30_000.0,
    "main": 15_000.0,
    "urban": 6_000.0,
    "hills": 10_000.0,
    "eight": 4_000.0,
}
"""Twenty minutes of driving, or one lap of a loop that is driven often."""
LEAST_LENGTHS_M = {
    "motorway": 6_000.0,
    "main": 3_000.0,
    "urban": 1_500.0,
    "hills": 4_000.0,
    "eight": 1_500.0,
}
"""Lengths that a motorway needs for its ramps and a loop for its bends."""
TUNNELS_M = {"motorway": MOTORWAY.tunnels_m, "urban": (120.0, 450.0)}

GENTLER = ("main", "hills", "urban")
"""Kinds whose relief may be less; a road of any other kind crosses itself and keeps its heights."""


def make_course(road: RoadModel, seed: int, folder: Path = Path()) -> Course:
    """One lap of a road; `path` is relative to `folder`. Raises InputError."""
    _check(road)
    random = np.random.default_rng([seed, ROAD_STREAM])
    start = Start(road.lat_deg, road.lon_deg, road.heading_deg, road.alt_m)
    if road.kind == "file":
        path = folder / (road.path or "")
        line = read_line(path)
        loop = line.loop if road.loop is None else road.loop
        plan, start = plan_along(str(path), line, start, road.limit_mps, random, loop=loop)
    else:
        plan = _plan(road, random)
    plan.grade *= road.relief
    if road.open_sky:
        plan.surroundings[plan.surroundings < Surroundings.BRIDGE] = Surroundings.OPEN
    if road.laps > 1 and not plan.loop:
        raise InputError("road.laps", "the road is no loop", "set road.loop = true or laps = 1")
    _furnish(plan, road, random)
    return lay_plan(plan, start)


def _check(road: RoadModel) -> None:
    if road.kind == "file" and road.path is None:
        raise InputError("road.path", "kind file without a path", "name the file")
    if road.kind == "garage" and road.loop:
        raise InputError("road.loop", "a garage is no loop", "remove it")
    if road.kind == "garage" and road.stops:
        raise InputError("road.stops", "no bus stops in a garage", "remove it")
    if road.kind == "eight" and road.loop is False:
        raise InputError("road.loop", "an eight is a loop", "remove it")
    if road.relief != 1.0 and road.kind not in GENTLER:
        mend = f"remove it, or take {', '.join(GENTLER)}"
        raise InputError("road.relief", f"kind {road.kind} keeps its own", mend)
    least_m = LEAST_LENGTHS_M.get(road.kind, 0.0)
    if road.length_m is not None and road.length_m < least_m:
        what = f"{road.length_m:g} m is too short for kind {road.kind}"
        raise InputError("road.length_m", what, f"give {least_m:g} or more")


def _plan(road: RoadModel, random: np.random.Generator) -> RoadPlan:
    """A road that is made up."""
    if road.kind == "garage":
        return garage_road(random)
    length_m = road.length_m or LENGTHS_M[road.kind]
    if road.kind == "eight":
        return figure_of_eight(length_m, random)
    if road.kind == "urban":
        return (town_loop if road.loop else town_road)(length_m, random)
    if road.kind == "motorway" and not road.loop:
        return motorway(length_m, random)
    design = {"motorway": MOTORWAY, "main": MAIN, "hills": HILLS}[road.kind]
    loop = road.kind == "hills" if road.loop is None else road.loop
    return (country_loop if loop else open_country_road)(design, length_m, random)


def _furnish(plan: RoadPlan, road: RoadModel, random: np.random.Generator) -> None:
    """Stops, canyons and tunnels."""
    place_stops(plan, road.stops, random)
    for canyon in road.canyons:
        _check_stretch("road.canyons", canyon, plan)
        plan.surroundings[plan.within(canyon.start_m, canyon.length_m)] = Surroundings.CANYON
    tunnels = road.tunnels
    if isinstance(tunnels, int):
        lengths_m = TUNNELS_M.get(road.kind, MAIN.tunnels_m)
        tunnels = tuple(some_tunnels(plan.length_m, tunnels, lengths_m, random))
    for tunnel in tunnels:
        _check_stretch("road.tunnels", tunnel, plan)
    dig(plan, tunnels)


def _check_stretch(where: str, stretch: Stretch, plan: RoadPlan) -> None:
    end_m = stretch.start_m + stretch.length_m
    if end_m > plan.length_m:
        what = f"ends at {end_m:.0f} m of a road of {plan.length_m:.0f} m"
        raise InputError(where, what, "shorten it or lengthen the road")
