from dataclasses import replace

import numpy as np
import pytest

from unit.evaluation.drives import eastwards
from wayline_evaluation.estimates import Floats
from wayline_evaluation.slope import Grades, average_std, profiles_of, slope_report
from wayline_evaluation.thesis_filter import (
    CRUISE_MPS,
    LAGS_S,
    SENSORS,
    Sensor,
    thesis_slopes_pct,
)

SECONDS = 600


def hill(sensor: Sensor) -> tuple[Floats, dict[Sensor, Floats]]:
    """A slope that grows by 0.01 % every second, and one sensor that tells it without an error."""
    slopes_pct = 0.01 * np.arange(SECONDS, dtype=np.float64)
    climbs_m = CRUISE_MPS * np.sin(np.arctan(slopes_pct / 100.0))
    alts_m: Floats = np.concatenate(([0.0], np.cumsum(climbs_m)[:-1]))
    measurements: dict[Sensor, Floats] = {kind: np.full(SECONDS, np.nan) for kind in SENSORS}
    measurements[sensor] = slopes_pct / 100.0 if sensor == "torque" else alts_m
    return slopes_pct, measurements


@pytest.mark.parametrize("sensor", SENSORS)
def test_the_filter_lags_as_the_paper_had_to_shift(sensor: Sensor) -> None:
    """On a ramp of slope the estimate is behind by the lag that Q was chosen for, within 1 s."""
    slopes_pct, measurements = hill(sensor)
    estimated_pct = thesis_slopes_pct(measurements, np.full(SECONDS, CRUISE_MPS), sensor)
    lag_s = (slopes_pct[-100:] - estimated_pct[-100:]) / 0.01
    assert lag_s == pytest.approx(LAGS_S[sensor], abs=1.0)


def test_a_sensor_that_is_shut_out_changes_nothing() -> None:
    """R times 1e10 (eq. 5.16): a barometer gone mad leaves the GPS's slope as it was."""
    _, measurements = hill("gps")
    speeds_mps = np.full(SECONDS, CRUISE_MPS)
    alone_pct = thesis_slopes_pct(measurements, speeds_mps, "gps")
    measurements["barometer"] = measurements["gps"] + 500.0
    assert thesis_slopes_pct(measurements, speeds_mps, "gps") == pytest.approx(alone_pct, abs=1e-3)


def test_the_slope_holds_while_the_torque_sensor_says_nothing() -> None:
    """While wheel brakes are applied (figure 5.2)."""
    _, measurements = hill("torque")
    measurements["torque"][300:330] = np.nan
    slopes_pct = thesis_slopes_pct(measurements, np.full(SECONDS, CRUISE_MPS), "torque")
    assert slopes_pct[300:330] == pytest.approx(slopes_pct[299])


def test_the_spread_is_the_mean_of_the_stds_between_runs() -> None:
    """Eq. 5.14 with n - 1, averaged over the points."""
    grades_pct = np.array([[1.0, 0.0], [3.0, 0.0]])
    assert average_std(grades_pct) == pytest.approx((np.sqrt(2.0) + 0.0) / 2.0)
    assert average_std(grades_pct[:1]) is None


def test_a_shift_is_taken_out_before_comparing() -> None:
    """A grade that comes 10 s late is the truth's, 10 s ago."""
    truth = eastwards()
    true_pct = np.sin((truth.times_s - truth.times_s[0]) / 10.0)
    hilly = replace(truth, grades_pct=true_pct)
    late = {"gps": Grades(truth.times_s + 10.0, true_pct, 10.0)}
    report = slope_report(["a"], profiles_of([hilly], [late]), {"gps": 10.0})
    found = report.ways["gps"].grade_pct
    assert found is not None
    assert found.max < 1e-6
