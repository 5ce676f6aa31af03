"""What each altimeter's readings are worth."""

import numpy as np
import pytest

from wayline.resolution import PRESSURE_UNIT_PA, Resolution
from wayline.tuning import Tuning
from wayline_slope_map.altitudes import barometer_altitudes, gps_altitudes
from wayline_slope_map.track import Altitude, Pressure, Track

SECOND_NS = 1_000_000_000
TUNING = Tuning()


def track(seconds: int = 20) -> Track:
    made = Track()
    for second in range(seconds + 1):
        made.travel(second * SECOND_NS, 10.0 * second)
    return made


@pytest.mark.parametrize(
    ("pressures_pa", "step_pa"),
    [
        ([99_000.0, 100_000.0, 101_000.0, 100_000.0], 1000.0),
        ([98_450.0, 98_500.0, 98_650.0], 50.0),
        ([98_448.3, 98_448.5, 98_646.1], 0.1),
        ([100_000.0, 100_000.0], 100_000.0),
    ],
)
def test_the_step_of_a_barometer_shows_in_its_readings(
    pressures_pa: list[float], step_pa: float
) -> None:
    steps = Resolution(PRESSURE_UNIT_PA)
    for pressure_pa in pressures_pa:
        steps.learn(pressure_pa)
    assert steps.std == pytest.approx(step_pa / 12**0.5)


def test_a_barometer_in_whole_kilopascals_says_nothing_of_the_road() -> None:
    made = track()
    made.pressures += [Pressure(t * SECOND_NS, 99_000.0 + 1000.0 * (t % 3)) for t in range(20)]
    assert len(barometer_altitudes(made, TUNING).alt_m) == 0


def test_equal_readings_together_weigh_like_one() -> None:
    made = track()
    values = [98_450.0] * 9 + [98_500.0]
    made.pressures += [Pressure(t * SECOND_NS, value) for t, value in enumerate(values)]
    std_m = barometer_altitudes(made, TUNING).std_m
    rounding_m = np.sqrt(std_m**2 - TUNING.baro_std_m**2)
    assert rounding_m[0] == pytest.approx(3.0 * rounding_m[-1], rel=1e-3)
    assert rounding_m[-1] == pytest.approx(50.0 * 0.0852 / 12**0.5, rel=0.01)


def test_an_altitude_belongs_to_the_place_of_its_own_instant() -> None:
    made = track()
    made.altitudes += [Altitude(7_500_000_000, 50.0, 4.0), Altitude(2 * SECOND_NS, 40.0, 4.0)]
    measured = gps_altitudes(made, TUNING)
    assert measured.travelled_m.tolist() == [20.0, 75.0]
    assert measured.alt_m.tolist() == [40.0, 50.0]


def test_altitudes_of_another_run_or_that_nobody_trusts_are_left_out() -> None:
    made = track()
    made.altitudes += [
        Altitude(-SECOND_NS, 40.0, 4.0),
        Altitude(21 * SECOND_NS, 40.0, 4.0),
        Altitude(3 * SECOND_NS, 211.6, 87.0),
        Altitude(4 * SECOND_NS, 139.0, 4.0),
    ]
    assert gps_altitudes(made, TUNING).alt_m.tolist() == [139.0]
