"""What a further vehicle costs a slope-map process whose map is large."""

import gc

import psutil

from wayline.tuning import Tuning
from wayline_bench.rounds import Say
from wayline_bench.row import Row, compared
from wayline_bench.slope_map import made_up_map, poses
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads

MAP_M = 10_000_000.0
VEHICLES = 50
DRIVEN_M = 1_000.0
ALLOWED_MB = 1.0


def memory_row(say: Say) -> Row:
    """Of vehicles that have each driven a kilometre of their own road."""
    say("a map for many vehicles")
    roads = KnownRoads(made_up_map(MAP_M))
    gc.collect()
    before_mb = _memory_mb()
    cores = [SlopeMapCore(roads, Tuning(), f"truck-{number}") for number in range(VEHICLES)]
    for number, core in enumerate(cores):
        for pose in poses(number, DRIVEN_M):
            core.handle(pose, "bench")
    each_mb = (_memory_mb() - before_mb) / VEHICLES
    what = f"a further vehicle at {MAP_M / 1e6:,.0f},000 km of map"
    return compared(what, [each_mb], [ALLOWED_MB], "allowed", unit="MB", bar=1.0)


def _memory_mb() -> float:
    return float(psutil.Process().memory_info().rss) / 1e6
