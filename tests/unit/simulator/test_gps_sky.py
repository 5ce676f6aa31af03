import numpy as np
import pytest

from unit.simulator.gps_journeys import LAT_DEG, LON_DEG, START_S, drive
from wayline_simulator.constellation import heavens
from wayline_simulator.course import Surroundings
from wayline_simulator.gps_sky import View, latched, view_of

DAY_S = START_S + np.arange(0.0, 86_400.0, 300.0)


def seen(surroundings: Surroundings, heading_deg: float = 30.0) -> View:
    journey = drive(8.0, 900.0, surroundings, heading_deg=heading_deg)
    truth = journey.at(np.arange(900.0))
    return view_of(
        truth,
        START_S,
        systems=("gps", "glonass"),
        mask_deg=5.0,
        pdop_max=25.0,
        random=np.random.default_rng(1),
    )


def test_a_day_of_gps_has_eight_to_twelve_satellites_above_five_degrees() -> None:
    """As the GPS performance standard promises at mid latitudes of a full constellation."""
    sky = heavens(DAY_S, np.full(288, LAT_DEG), np.full(288, LON_DEG), ("gps",))
    above = np.sum(sky.elevations_rad > np.radians(5.0), axis=1)
    assert above.min() >= 7
    assert above.max() <= 13
    assert 8.5 < above.mean() < 11.0


def test_satellites_come_back_after_a_sidereal_day() -> None:
    """GPS orbits twice while the earth turns once: the sky repeats 4 minutes earlier a day.

    The nominal radius gives a day that is 1 s off; 4 minutes would turn the sky by a degree.
    """
    times_s = np.array([START_S, START_S + 86_164.0905])
    sky = heavens(times_s, np.full(2, LAT_DEG), np.full(2, LON_DEG), ("gps",))
    assert np.degrees(np.ptp(sky.elevations_rad, axis=0)).max() < 0.2


def test_no_gps_satellite_is_low_in_the_north() -> None:
    """At 48 degrees an inclination of 55 leaves a hole around the pole."""
    sky = heavens(DAY_S, np.full(288, LAT_DEG), np.full(288, LON_DEG), ("gps",))
    north = np.cos(sky.azimuths_rad) > np.cos(np.radians(20.0))
    low = (sky.elevations_rad > np.radians(10.0)) & (sky.elevations_rad < np.radians(25.0))
    assert not np.any(north & low)


def test_dilutions_are_those_of_the_satellites_in_use() -> None:
    """PDOP squared is HDOP squared and VDOP squared; an open sky is below 1 horizontally."""
    view = seen(Surroundings.OPEN)
    assert view.pdop == pytest.approx(np.hypot(view.hdop, view.vdop))
    assert np.all(view.hdop < 1.0)
    assert np.all(view.vdop > view.hdop)
    assert not np.any(view.used & (view.elevations_deg < 5.0))


def test_every_kind_of_place_hides_more_than_the_one_before() -> None:
    """Houses hide more than trees, and high houses more than low ones."""
    kinds = (Surroundings.OPEN, Surroundings.TREES, Surroundings.CANYON)
    used = [seen(kind).used.sum(axis=1).mean() for kind in kinds]
    assert used[0] > used[1] + 2.0 > used[2] + 4.0
    assert seen(Surroundings.STREET).hdop.mean() > seen(Surroundings.TREES).hdop.mean()


def test_houses_leave_the_sky_along_the_street() -> None:
    """Of satellites at 12 to 30 degrees those ahead and behind are used, those aside are not."""
    view = seen(Surroundings.STREET, heading_deg=40.0)
    aside = np.abs(np.sin(np.radians(view.azimuths_deg - 40.0)))
    middling = (view.elevations_deg > 12.0) & (view.elevations_deg < 30.0)
    along = view.used[middling & (aside < 0.3)].mean()
    across = view.used[middling & (aside > 0.8)].mean()
    assert along > 0.7
    assert across < 0.3


def test_nothing_is_heard_in_a_tunnel() -> None:
    """No satellite, no fix."""
    view = seen(Surroundings.TUNNEL)
    assert not view.used.any()
    assert np.all(view.mode == 1)
    assert not view.strengths_dbhz.any()


def test_a_satellite_stays_in_use_until_it_is_clearly_lost() -> None:
    """Between the two thresholds it is what it was."""
    strengths = np.array([[28.0], [32.0], [28.0], [24.0], [28.0], [32.0]])
    used = latched(strengths > 30.0, strengths < 25.0)
    assert used[:, 0].tolist() == [False, True, True, False, False, True]
