"""What each sensor alone says of the slope."""

from collections.abc import Callable

import pytest

from wayline.messages import SensorSlope
from wayline.vertical.propulsion import Push
from wayline_fusion.evidence.slopes_told import SlopesTold
from wayline_fusion.filter.vertical import Progress, TorqueErrors
from wayline_fusion.intake.events import Event, GpsAltitude, Pressure, ReportedSlope

SPEED_MPS = 10.0
ROUGH_M = 0.5
"""Readings of altimeters are off by so much, up and down in turn."""


def altitude(second: int, slope: float) -> Event:
    alt_m = slope * SPEED_MPS * second + ROUGH_M * (-1) ** second
    return GpsAltitude(second * 10**9, alt_m, 3.0, "gps-ingest")


def pressure(second: int, slope: float) -> Event:
    return Pressure(second * 10**9, slope * SPEED_MPS * second + 40.0, 0.5)


def reported(second: int, slope: float) -> Event:
    return ReportedSlope(second * 10**9, 1.0, slope)


def push(second: int, slope: float, mass: float = 1.0) -> Event:
    return Push(
        t_ns=second * 10**9,
        middle_ns=second * 10**9,
        length_s=1.0,
        share=mass * (slope + 0.007),
        level=0.007,
        sampling_std=0.0,
        speed_std_mps=0.0,
        goes_on=True,
        behind_m=0.0,
        is_braked=False,
    )


def driven(
    sensor: Callable[[int, float], Event], slope: float, seconds: range, told: SlopesTold
) -> None:
    for second in seconds:
        progress = Progress(second * 10**9, SPEED_MPS * second, SPEED_MPS)
        told.take(sensor(second, slope), progress)


def said(told: SlopesTold, mass: float = 1.0) -> dict[str, SensorSlope]:
    return {each.sensor: each for each in told.told(TorqueErrors(0.0, 0.001, mass, 0.01))}


@pytest.mark.parametrize("sensor", [altitude, pressure, reported, push])
def test_each_sensor_tells_the_slope_of_the_last_200_m(
    sensor: Callable[[int, float], Event],
) -> None:
    told = SlopesTold()
    driven(sensor, 0.0, range(60), told)
    # the hill begins where the flat road's readings have just been forgotten
    driven(lambda second, slope: sensor(second - 60, slope), 0.03, range(60, 90), told)
    (slope,) = said(told).values()
    assert slope.slope_pct == pytest.approx(3.0, abs=0.15)
    assert slope.slope_std_pct < 0.3


def test_rough_readings_are_told_as_less_sure() -> None:
    told = SlopesTold()
    driven(altitude, 0.03, range(21), told)
    driven(pressure, 0.03, range(21), told)
    assert said(told)["gps_altitude"].slope_std_pct > 0.1
    assert said(told)["barometer"].slope_std_pct == pytest.approx(0.0, abs=1e-9)


def test_torque_tells_by_the_mass_that_fusion_has_found() -> None:
    told = SlopesTold()
    driven(lambda second, slope: push(second, slope, mass=1.5), 0.03, range(21), told)
    assert said(told, mass=1.5)["torque"].slope_pct == pytest.approx(3.0)
    assert said(told)["torque"].slope_pct > 4.0
    assert list(told.told(None)) == []


def test_who_has_told_nothing_of_the_last_stretch_is_left_out() -> None:
    told = SlopesTold()
    driven(push, 0.03, range(21), told)
    driven(altitude, 0.03, range(21, 25), told)
    assert "torque" in said(told)
    driven(altitude, 0.03, range(25, 28), told)
    assert "torque" not in said(told)


def test_too_short_a_way_tells_nothing() -> None:
    told = SlopesTold()
    driven(altitude, 0.03, range(9), told)
    assert said(told) == {}


def test_altitudes_of_a_stand_tell_no_slope() -> None:
    told = SlopesTold()
    driven(altitude, 0.03, range(21), told)
    before = said(told)
    for second in range(21, 600):
        told.take(altitude(second, 0.5), Progress(second * 10**9, 200.0, 0.0))
    assert said(told) == before


def test_in_reverse_it_begins_anew() -> None:
    told = SlopesTold()
    driven(altitude, 0.03, range(21), told)
    told.take(altitude(21, 0.03), Progress(21 * 10**9, 210.0, -2.0))
    assert said(told) == {}
