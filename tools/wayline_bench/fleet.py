"""`bench fleet`: what fleets cost a server's processes, beside bare Zenoh, and what is heard.

A router, eta, slope-map and a dashboard with a page open serve every vehicle. Each fleet is played
to them by sessions of 25 vehicles, and then to bare listeners that say as much.
"""

from collections.abc import Sequence

from wayline_bench.fleet_figures import Load
from wayline_bench.fleet_rows import Bars, fleet_rows, silent_rows
from wayline_bench.fleet_system import fall_silent, live, live_bare
from wayline_bench.rounds import Say
from wayline_bench.row import Row

ROUNDS = 4
ROUND_S = 3.0
FLEETS = ((50, 1.0), (200, 1.0), (500, 1.0), (1000, 1.0), (50, 10.0))
"""Vehicles, and how often each tells its pose (Hz)."""
BARS = {(500, 1.0): Bars(router=2.0, missed=0.001, uncounted=0.0)}
SILENT = 750
SPEAK_S = 5.0


def bench(say: Say, vehicles: Sequence[int] = ()) -> list[Row]:
    """Every row; with `vehicles` those of such fleets at 1 Hz alone."""
    fleets = [(count, 1.0) for count in vehicles] or FLEETS
    rows = [row for fleet in fleets for row in _fleet_rows(fleet, say)]
    return rows if vehicles else [*rows, *_silent_rows(say)]


def _fleet_rows(fleet: tuple[int, float], say: Say) -> list[Row]:
    count, pose_hz = fleet
    load = Load(count, pose_hz, ROUNDS, ROUND_S)
    say(f"{count} vehicles at {pose_hz:g} Hz")
    lived = live(load)
    say(f"{count} vehicles at {pose_hz:g} Hz, bare")
    return fleet_rows(load, lived, live_bare(load, lived), BARS.get(fleet, Bars()))


def _silent_rows(say: Say) -> list[Row]:
    say(f"{SILENT} vehicles that fall silent")
    before, after = fall_silent(Load(SILENT, 1.0, 1, SPEAK_S), say)
    return silent_rows(SILENT, before, after)
