"""What a receiver should measure of satellites, held against signals reckoned in inertial space."""

import math

import numpy as np
import pytest

from builders import at
from satellites import APART_S, L1_HZ, LIGHT_MPS, Floats, Sky, ecef, sky_over
from wayline.satellites.doppler import (
    AntennaMotion,
    Orbits,
    antenna_of,
    carried,
    expected,
    orbits_of,
)

LAT_DEG, LON_DEG = 52.0, 13.0
SKY = sky_over(LAT_DEG, LON_DEG)
STEP_DEG = 1e-5


def no_clock(_: float) -> float:
    return 0.0


def driving(east_mps: float, north_mps: float) -> tuple[AntennaMotion, "Driving"]:
    """A straight way from the place, and how it is told."""
    motion = AntennaMotion(
        lat_deg=LAT_DEG,
        lon_deg=LON_DEG,
        height_m=100.0,
        heading_deg=math.degrees(math.atan2(east_mps, north_mps)),
        speed_mps=math.hypot(east_mps, north_mps),
        grade_pct=0.0,
        place_std_m=0.0,
        heading_std_deg=0.0,
        speed_std_mps=0.0,
        grade_std_pct=0.0,
    )
    return motion, Driving(east_mps, north_mps)


class Driving:
    """Where it leads."""

    def __init__(self, east_mps: float, north_mps: float) -> None:
        here_m = ecef(LAT_DEG, LON_DEG, 100.0)
        north = ecef(LAT_DEG + STEP_DEG, LON_DEG, 100.0) - here_m
        east = ecef(LAT_DEG, LON_DEG + STEP_DEG, 100.0) - here_m
        unit_north, unit_east = north / np.linalg.norm(north), east / np.linalg.norm(east)
        self.here_m, self.mps = here_m, east_mps * unit_east + north_mps * unit_north

    def __call__(self, seconds: float) -> Floats:
        return np.asarray(self.here_m + seconds * self.mps)


def orbits_at(sky: Sky, way: Driving, seconds: float) -> Orbits:
    """As an epoch at a time tells them."""
    sent_s = seconds - sky.flights_s(way, seconds)
    motions = (sky.ecef_m(sent_s + APART_S) - sky.ecef_m(sent_s - APART_S)) / (2.0 * APART_S)
    return orbits_of(sky.ecef_m(sent_s), motions, np.full(len(sent_s), at(seconds), dtype=np.int64))


@pytest.mark.parametrize(("east_mps", "north_mps"), [(0.0, 0.0), (30.0, 0.0), (-20.0, 40.0)])
def test_range_rates_are_those_of_signals_past_a_turning_earth(
    east_mps: float, north_mps: float
) -> None:
    """To a centimetre a second, a twentieth of a Hz, and ranges to a metre."""
    motion, way = driving(east_mps, north_mps)
    seen = expected(antenna_of(motion), orbits_at(SKY, way, 0.0), at(0.0))
    rates_mps = -SKY.dopplers_hz(way, no_clock, 0.0) * LIGHT_MPS / L1_HZ
    assert np.abs(seen.rates_mps - rates_mps).max() < 0.01
    assert np.abs(seen.ranges_m - SKY.pseudoranges_m(way, no_clock, 0.0)).max() < 0.1


@pytest.mark.parametrize("minutes", [1.0, 5.0])
def test_satellites_that_are_no_longer_heard_go_on_along_their_orbits(minutes: float) -> None:
    _, way = driving(0.0, 0.0)
    orbits, later_s = orbits_at(SKY, way, 0.0), 60.0 * minutes
    for part in range(1, 7):
        orbits = carried(orbits, at(part / 6.0 * later_s))
    truth = orbits_at(SKY, way, later_s)
    assert np.abs(orbits.velocities_mps - truth.velocities_mps).max() < 0.005
    # in five minutes signals come to travel up to a millisecond longer or shorter: 3 m of orbit
    assert np.linalg.norm(orbits.places_m - truth.places_m, axis=1).max() < 3.0


def test_stds_are_those_of_the_velocity_along_the_line_of_sight() -> None:
    """By varying speed and heading within their stds."""
    motion, way = driving(0.0, 20.0)
    orbits = orbits_at(SKY, way, 0.0)
    unsure = motion._replace(speed_std_mps=0.5, heading_std_deg=3.0)
    claimed = np.sqrt(expected(antenna_of(unsure), orbits, at(0.0)).rate_variances)
    random = np.random.default_rng(1)
    rates = [
        expected(
            antenna_of(
                motion._replace(
                    speed_mps=random.normal(20.0, 0.5), heading_deg=random.normal(0.0, 3.0)
                )
            ),
            orbits,
            at(0.0),
        ).rates_mps
        for _ in range(1500)
    ]
    assert np.std(rates, axis=0) == pytest.approx(claimed, rel=0.1, abs=0.02)


def test_a_place_far_off_sees_a_satellites_motion_from_elsewhere() -> None:
    """Ten kilometres are some tenths of a metre a second, and the std says so."""
    motion, way = driving(0.0, 0.0)
    orbits = orbits_at(SKY, way, 0.0)
    right = expected(antenna_of(motion), orbits, at(0.0))
    beside = expected(antenna_of(motion._replace(lat_deg=LAT_DEG + 0.09)), orbits, at(0.0))
    claimed = expected(antenna_of(motion._replace(place_std_m=10_000.0)), orbits, at(0.0))
    off_mps = np.abs(beside.rates_mps - right.rates_mps)
    assert off_mps.max() > 0.3
    assert (off_mps <= 1.05 * np.sqrt(claimed.rate_variances)).all()
