"""A load that changes on the way: where the vehicle stands, and what it weighs then."""

import numpy as np
import pytest

from unit.simulator.courses import CALM, STEADY, hills, laid
from wayline_simulator.driving import drive
from wayline_simulator.journey import Motion
from wayline_simulator.loads import LoadChange, masses_kg, with_loads
from wayline_simulator.traffic import Standstill
from wayline_simulator.vehicle import TRUCK, rigid_mass_kg

EMPTY = LoadChange(distance_m=2_000.0, mass_kg=16_000.0, wait_s=300.0)


def driven(*loads: LoadChange) -> Motion:
    course = laid(hills(4_000.0))
    return drive(course, TRUCK, STEADY, CALM, np.random.default_rng(4), loads=loads)


def test_the_vehicle_stands_where_its_load_changes() -> None:
    motion = driven(EMPTY)
    standing = (motion.path_m == EMPTY.distance_m) & (motion.speeds_mps == 0.0)
    assert np.count_nonzero(standing) * 0.05 == pytest.approx(EMPTY.wait_s, abs=1.0)


def test_forces_and_motion_fit_the_mass_on_either_side() -> None:
    """Newton's second law without the brakes, gears in: force minus resistance is m (a + g s)."""
    motion = driven(EMPTY)
    course = laid(hills(4_000.0))
    slope = np.interp(motion.path_m, course.distances_m, course.grade)
    gained_mps2 = np.gradient(motion.speeds_mps, 0.05)
    turn = motion.gear_ratio * TRUCK.gearbox.final_drive_ratio / TRUCK.wheel_radius_m
    turning_n = TRUCK.engine.inertia_kgm2 * turn**2 * gained_mps2
    wheels_n = (rigid_mass_kg(TRUCK) - TRUCK.mass_kg) * gained_mps2
    net_n = motion.drive_force_n - motion.resistance_n - turning_n - wheels_n
    told = ~motion.brake & ~motion.clutch & (motion.speeds_mps > 5.0) & (np.abs(slope) > 0.02)
    weighed_kg = net_n / (gained_mps2 + 9.81 * slope / np.hypot(1.0, slope))
    before, after = motion.path_m < 1_900.0, motion.path_m > 2_100.0
    assert np.median(weighed_kg[told & before]) == pytest.approx(TRUCK.mass_kg, rel=0.01)
    assert np.median(weighed_kg[told & after]) == pytest.approx(EMPTY.mass_kg, rel=0.01)


def test_the_mass_changes_after_the_stand_in_whatever_order_loads_are_given() -> None:
    full = LoadChange(distance_m=3_000.0, mass_kg=38_000.0)
    path_m = np.array([1_999.0, 2_000.0, 2_001.0, 3_001.0])
    found = masses_kg(path_m, 26_000.0, [full, EMPTY])
    assert found.tolist() == [26_000.0, 26_000.0, 16_000.0, 38_000.0]


def test_a_change_of_load_goes_before_another_stop_at_its_place() -> None:
    stops = [Standstill(2_000.4, 5.0), Standstill(4_000.0, 10.0, parked=True)]
    found = with_loads(stops, [EMPTY])
    assert found == [Standstill(2_000.0, 300.0, parked=True), stops[1]]
