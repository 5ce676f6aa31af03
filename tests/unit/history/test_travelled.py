"""How long a trip is: as the wheels say by the scale that fixes tell, or as fixes alone do."""

import random

import pytest

from builders import at, fix
from unit.history.driven import LAT_DEG, LON_DEG, METRES_PER_DEGREE, kept_of, pose
from wayline.messages import GpsFix, Message, Trip

SPEED_MPS = 10.0
LASTS_S = 1_000
LENGTH_M = SPEED_MPS * LASTS_S


def fixes(every_s: int = 1, seed: int = 1) -> list[GpsFix]:
    """Of a receiver with a Doppler's speed, off by two metres here and there."""
    chance = random.Random(seed)
    return [
        fix(
            float(second),
            LAT_DEG + 2.0 * chance.gauss() / 111_320.0,
            LON_DEG + (SPEED_MPS * second + 2.0 * chance.gauss()) / METRES_PER_DEGREE,
            speed_mps=abs(SPEED_MPS + 0.1 * chance.gauss()),
            course_deg=90.0,
            satellites=9,
            hdop=1.0,
        )
        for second in range(0, LASTS_S + 1, every_s)
    ]


def trip_of(scale: float, mode: str, told: list[GpsFix]) -> Trip:
    """The trip of a vehicle whose own distance is off by a scale."""
    poses = [
        pose(
            float(second), SPEED_MPS * second, SPEED_MPS, distance_m=scale * second * 10, mode=mode
        )
        for second in range(LASTS_S + 1)
    ]
    both: list[Message] = sorted([*told, *poses], key=lambda message: message.t_ns)
    (trip,) = kept_of(both).trips
    return trip


def test_wheels_that_read_high_are_measured_by_fixes() -> None:
    trip = trip_of(1.05, "fused", fixes())
    assert trip.distance_m == pytest.approx(LENGTH_M, rel=0.005)
    assert abs(trip.distance_m - LENGTH_M) < 3.0 * trip.distance_std_m < 0.03 * LENGTH_M


def test_without_wheels_the_fixes_speeds_tell() -> None:
    trip = trip_of(1.05, "gps", fixes())
    assert trip.distance_m == pytest.approx(LENGTH_M, rel=0.005)


def test_without_fixes_the_wheels_are_believed_to_two_percent() -> None:
    trip = trip_of(1.0, "fused", [])
    assert trip.distance_m == pytest.approx(LENGTH_M, rel=0.001)
    assert trip.distance_std_m > 0.005 * LENGTH_M


def test_with_neither_fusions_own_distance_stands() -> None:
    assert trip_of(1.0, "gps", []).distance_m == pytest.approx(LENGTH_M, rel=0.001)


def _poses() -> list[Message]:
    return [pose(float(s), SPEED_MPS * s, SPEED_MPS, mode="gps") for s in range(LASTS_S + 1)]


def test_fixes_that_overtake_poses_change_nothing() -> None:
    told, poses = fixes(), _poses()
    early = sorted([*told, *poses], key=lambda m: m.t_ns - isinstance(m, GpsFix) * 3_000_000_000)
    late = sorted([*told, *poses], key=lambda m: m.t_ns + isinstance(m, GpsFix) * 3_000_000_000)
    (one,), (other,) = kept_of(early).trips, kept_of(late).trips
    assert one == other
    assert one.ended_ns == at(LASTS_S)
