"""Where a trip is quick and where slow, when its timetable has only the ends."""

import numpy as np
import pytest

from unit.eta.route_drives import Metres, line_of
from wayline.line import Line
from wayline.timetable.plan import make_plan
from wayline.timetable.section_speeds import TOWN_MPS, SectionSpeeds

STRAIGHT: list[Metres] = [(0, float(north_m)) for north_m in range(0, 10_001, 100)]
CORNERED: list[Metres] = [
    *STRAIGHT[:51],
    *((float(east_m), 5_000) for east_m in range(100, 5_001, 100)),
]


def speeds_mps(line: Line, alongs_m: list[float], times_s: list[float]) -> np.ndarray:
    alongs, times = np.array(alongs_m), np.array(times_s)
    return SectionSpeeds(line, alongs).of_plan(make_plan(alongs, times, times))


def took_s(line: Line, speeds: np.ndarray) -> float:
    return float(np.sum(line.legs_m / speeds))


def test_what_a_town_bus_takes_is_driven_evenly() -> None:
    line = line_of(STRAIGHT)
    speeds = speeds_mps(line, [0.0, 4_000.0, line.length_m], [0.0, 800.0, 2_000.0])
    assert speeds[:40] == pytest.approx(5.0, rel=1e-3)
    assert speeds[41:] == pytest.approx(5.0, rel=1e-3)


def test_a_quick_trip_is_slow_near_its_stops_and_keeps_its_time() -> None:
    line = line_of(STRAIGHT)
    speeds = speeds_mps(line, [0.0, line.length_m], [0.0, 600.0])
    assert speeds[[0, 4, -1]] == pytest.approx(TOWN_MPS, rel=0.01)
    assert speeds[50] == pytest.approx(9_000.0 / (600.0 - 1_000.0 / TOWN_MPS), rel=0.01)
    assert took_s(line, speeds) == pytest.approx(600.0, abs=0.1)


def test_a_quick_trip_is_slow_round_corners() -> None:
    line = line_of(CORNERED)
    speeds = speeds_mps(line, [0.0, line.length_m], [0.0, 600.0])
    assert speeds[[49, 50]].max() < 0.6 * speeds[40]
    assert speeds[40] > 1.9 * TOWN_MPS
    assert took_s(line, speeds) == pytest.approx(600.0, abs=0.1)


def test_a_trip_as_quick_as_a_motorway_is_so_all_the_way() -> None:
    line = line_of(STRAIGHT)
    speeds = speeds_mps(line, [0.0, line.length_m], [0.0, 320.0])
    assert speeds == pytest.approx(line.length_m / 320.0, rel=1e-3)
