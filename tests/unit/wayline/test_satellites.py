"""Satellites seen from a turning earth, and a receiver roughly found among them."""

import math

import numpy as np
import pytest

from wayline.messages import RawSatellite
from wayline.satellites.direction import Horizon
from wayline.satellites.earth import EARTH_RATE_RADPS, SPEED_OF_LIGHT_MPS, Vector, turned
from wayline.satellites.gps_time import WEEK_S, leap_s, unix_ns, week_and_tow_s
from wayline.satellites.place import Ranged, ranged, rough_place_m

OWN_M = Vector(4_177_000.0, 855_000.0, 4_728_000.0)
"""Near Munich."""
RADIUS_M = 26_560_000.0


def above(count: int, system: str = "gps", clock_m: float = 0.0) -> list[Ranged]:
    """Satellites in directions around the zenith, their pseudoranges by what they travelled."""
    random = np.random.default_rng(count)
    found = []
    for _ in range(count):
        ray = np.array(OWN_M) / OWN_M.length + 0.7 * random.standard_normal(3)
        sent_m = Vector(*(RADIUS_M * ray / np.linalg.norm(ray)).tolist())
        flight_s = 0.07
        for _ in range(4):
            flight_s = math.dist(turned(sent_m, flight_s), OWN_M) / SPEED_OF_LIGHT_MPS
        found.append(Ranged(system, sent_m, flight_s * SPEED_OF_LIGHT_MPS + clock_m))
    return found


def test_a_receiver_is_where_its_pseudoranges_meet() -> None:
    found = rough_place_m([*above(5, clock_m=150_000.0), *above(3, "glonass", -20_000.0)])
    assert found is not None
    assert math.dist(found, OWN_M) < 0.1


@pytest.mark.parametrize(
    "satellites",
    [
        [],
        above(3),
        [*above(3), *above(1, "glonass")],
        above(4)[:1] * 6,
        [each._replace(pseudorange_m=2.2e7 + 1e6 * n) for n, each in enumerate(above(6))],
        [each._replace(place_m=Vector(0.0, 0.0, 0.0)) for each in above(5)],
    ],
    ids=["none", "three", "two systems", "one place", "apart", "at the centre"],
)
def test_where_they_do_not_meet_there_is_no_place(satellites: list[Ranged]) -> None:
    assert rough_place_m(satellites) is None


def test_a_satellites_clock_is_taken_in() -> None:
    told = RawSatellite(
        system="gps", prn=1, pseudorange_m=2e7, x_m=1e7, y_m=1e7, z_m=1e7, clock_bias_m=500.0
    )
    assert ranged(told) == Ranged("gps", Vector(1e7, 1e7, 1e7), 2e7 + 500.0)
    assert ranged(RawSatellite(system="gps", prn=1, doppler_hz=1.0)) is None


def test_what_is_turned_and_turned_back_is_where_it_was() -> None:
    place_m = Vector(2.0e7, -1.0e7, 1.5e7)
    there = turned(place_m, 0.075)
    assert turned(there, -0.075) == pytest.approx(place_m, abs=1e-6)
    # the earth turns to the east, so that what stays in space goes west in its frame
    east_m = math.atan2(there.y, there.x) - math.atan2(place_m.y, place_m.x)
    assert east_m == pytest.approx(-EARTH_RATE_RADPS * 0.075)


@pytest.mark.parametrize(
    ("towards", "direction_deg"),
    [((0, 0, 1), (0.0, 0.0)), ((0, 1, 0), (0.0, 90.0)), ((1, 0, 0), (90.0, 0.0))],
)
def test_directions_are_those_of_the_compass(
    towards: tuple[float, float, float], direction_deg: tuple[float, float]
) -> None:
    """At 0 N 0 E: north is the pole's axis, east the second one, up the first."""
    here = Horizon.of(Vector(6_378_137.0, 0.0, 0.0))
    found = here.direction_deg(here.place_m.moved(Vector(*map(float, towards)), 1e7))
    assert found[0] == pytest.approx(direction_deg[0], abs=1e-9)
    assert towards == (1, 0, 0) or found[1] == pytest.approx(direction_deg[1], abs=1e-9)


def test_gps_time_is_ahead_of_utc_by_its_leap_seconds() -> None:
    """2017-01-01 00:00:00 UTC is 18 s, the second before it 17 s behind GPS time."""
    new_year_s = 1_483_228_800
    assert (leap_s(new_year_s - 1), leap_s(new_year_s)) == (17, 18)
    assert unix_ns(1930, 18.0) == new_year_s * 10**9
    assert unix_ns(1930, 16.0) == (new_year_s - 1) * 10**9
    assert week_and_tow_s(new_year_s * 10**9) == (1930, 18.0)


@pytest.mark.parametrize("t_ns", [315_964_800 * 10**9, 1_767_838_482_250_000_000])
def test_weeks_and_seconds_come_back(t_ns: int) -> None:
    week, tow_s = week_and_tow_s(t_ns)
    assert 0.0 <= tow_s < WEEK_S
    assert unix_ns(week, tow_s) == t_ns
