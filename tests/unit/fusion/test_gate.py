"""The chi-square gate, and the alarm where it cannot fire."""

import math

import numpy as np
import pytest
from scipy.stats import chi2

from builders import at, fix, gyro, odometer, only, run_core
from unit.fusion.drives import ORIGIN, Sensors, circle, messages_of, truth_of
from wayline.messages import FusionStatus, Message, Verdict
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.filter.gate import alarmed, judge, nis_of, threshold
from wayline_fusion.filter.measurements import Measurement

ALARM = "no measurement could be rejected"


def measured(sensor: str, y: list[float], std: float) -> Measurement:
    size = len(y)
    return Measurement(sensor, np.array(y), np.zeros((size, 10)), np.eye(size) * std**2)


def judged(sensor: str, std: float, size: int = 1) -> Verdict:
    """Of a measurement just where it is expected, with an innovation of this std."""
    measurement = measured(sensor, [0.0] * size, std)
    expected = np.zeros((size, size))
    verdict = judge(sensor, at(0), nis_of(measurement, expected), size, 0.9999)
    return alarmed(verdict, measurement, expected)


@pytest.mark.parametrize(("dimension", "probability"), [(1, 0.99), (2, 0.9999)])
def test_the_threshold_is_the_quantile_of_chi_square(dimension: int, probability: float) -> None:
    assert threshold(dimension, probability) == pytest.approx(chi2.ppf(probability, dimension))


def test_the_nis_weighs_with_both_covariances() -> None:
    """H P H' and R: 3 and 4 m off, with variances of 1 + 3 and 2 + 2."""
    measurement = Measurement(
        "gps_position", np.array([3.0, 4.0]), np.zeros((2, 10)), np.diag([3.0, 2.0])
    )
    assert nis_of(measurement, np.diag([1.0, 2.0])) == pytest.approx(25.0 / 4.0)


@pytest.mark.parametrize(
    ("sensor", "size", "std", "alarms"),
    [
        ("gps_position", 2, 20.0, False),
        ("gps_position", 2, 400.0, True),
        ("gps_speed", 1, 1.0, False),
        ("gps_speed", 1, 60.0, True),
        ("gps_course", 1, math.radians(30.0), False),
        ("gps_course", 1, math.radians(60.0), True),
        ("standstill", 1, 1e9, False),
    ],
)
def test_an_alarm_sounds_where_no_measurement_could_be_rejected(
    sensor: str, size: int, std: float, alarms: bool
) -> None:
    """A course is at most half a turn off: a gate as wide lets every course through."""
    verdict = judged(sensor, std, size)
    assert verdict.accepted
    assert (verdict.reason or "").startswith(ALARM) is alarms


def told(messages: list[Message]) -> list[Verdict]:
    statuses = only(run_core(FusionCore(Tuning()), messages), FusionStatus)
    return [verdict for status in statuses for verdict in status.verdicts]


def test_a_receiver_that_claims_nothing_is_told_to_be_beyond_control() -> None:
    """A std of 3 km: whatever it says is accepted, and the status says that this means little."""
    messages: list[Message] = [
        message
        for second in range(30)
        for message in (
            gyro(second, 0.0),
            odometer(second, 10.0),
            fix(
                second,
                *ORIGIN.to_geodetic(0.0, 10.0 * second),
                speed_mps=10.0,
                course_deg=0.0,
                h_std_m=3000.0,
            ),
        )
    ]
    positions = [verdict for verdict in told(messages) if verdict.sensor == "gps_position"]
    assert positions
    assert all(v.accepted and (v.reason or "").startswith(ALARM) for v in positions)


def test_no_alarm_sounds_on_an_ordinary_drive() -> None:
    drive = messages_of(circle, truth_of(circle, 60.0), Sensors())
    assert not [verdict for verdict in told(list(drive)) if verdict.reason]
