"""The chi-square gate, and the alarm where it cannot fire."""

import math

import numpy as np
import pytest
from scipy.stats import chi2

from builders import at, fix, gyro, odometer, only, run_core
from unit.fusion.drives import ORIGIN, Sensors, circle, messages_of, truth_of
from wayline.likelihood import Floats, Measurement, nis_of, threshold, weighed
from wayline.messages import FusionStatus, Message, Verdict
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.filter.gate import Outcome, Policy, try_measurement

ALARM = "no measurement could be rejected"


def measured(sensor: str, y: list[float], std: float) -> Measurement:
    size = len(y)
    return Measurement(sensor, np.array(y), np.zeros((size, 10)), np.eye(size) * std**2)


class Scales:
    """Something to be measured that knows one covariance, and notes what corrects it."""

    def __init__(self, variance: float = 0.0) -> None:
        self.filter, self.variance = self, variance
        self.verdicts: list[Verdict] = []
        self.corrections: list[Measurement] = []

    def expected(self, measurement: Measurement) -> Floats:
        return self.variance * np.eye(len(measurement.y))

    def correct(self, measurement: Measurement) -> None:
        self.corrections.append(measurement)


def tried(measurement: Measurement, policy: Policy) -> tuple[Outcome, Scales]:
    scales = Scales(1.0)
    return try_measurement(scales, measurement, at(0), policy), scales


def judged(sensor: str, std: float, size: int = 1) -> Verdict:
    """Of a measurement just where it is expected, with an innovation of this std."""
    scales = Scales()
    try_measurement(scales, measured(sensor, [0.0] * size, std), at(0), Policy(0.9999))
    (verdict,) = scales.verdicts
    return verdict


def test_a_likely_measurement_corrects_and_is_told() -> None:
    outcome, scales = tried(measured("odometer", [2.0], 1.0), Policy(0.99))
    (verdict,) = scales.verdicts
    assert (outcome.is_accepted, verdict.accepted, verdict.reason) == (True, True, None)
    assert outcome.nis == verdict.nis == pytest.approx(2.0)
    assert len(scales.corrections) == 1


def test_an_unlikely_measurement_corrects_nothing_and_its_reason_is_told() -> None:
    policy = Policy(0.99, tells_accepted=False, reason="a tow truck")
    outcome, scales = tried(measured("odometer", [9.0], 1.0), policy)
    (verdict,) = scales.verdicts
    assert (outcome.is_accepted, verdict.accepted, verdict.reason) == (False, False, "a tow truck")
    assert verdict.nis > verdict.threshold
    assert not scales.corrections


def test_before_it_is_rejected_an_unlikely_measurement_gets_a_second_look() -> None:
    """What was doubted at it counts in the second judgement, but not in what is learned."""
    scales = Scales(1.0)

    def doubt(_: Measurement) -> bool:
        scales.variance = 100.0
        return True

    policy = Policy(0.99, second_look=doubt)
    outcome = try_measurement(scales, measured("odometer", [9.0], 1.0), at(0), policy)
    assert outcome.is_accepted
    assert outcome.nis == pytest.approx(81.0 / 101.0)
    assert outcome.expected == pytest.approx(1.0)


def test_what_is_less_likely_than_a_bound_counts_as_if_at_it() -> None:
    """So far off as it is, its innovation is worth no more than one at the bound (Huber)."""
    expected = np.eye(1)
    far, near = measured("gps_altitude", [12.0], 1.0), measured("gps_altitude", [1.0], 1.0)
    bound = threshold(1, 0.95)
    assert nis_of(weighed(far, expected, 0.95), expected) == pytest.approx(bound)
    assert weighed(near, expected, 0.95) is near


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
