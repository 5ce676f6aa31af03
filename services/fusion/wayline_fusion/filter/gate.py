"""Pure: the chi-square gate. A measurement too unlikely for its stds is rejected, and said so."""

import math
from functools import cache

import msgspec
import numpy as np
from scipy.special import chdtri

from wayline.messages import Verdict
from wayline_fusion.filter.measurements import Measurement
from wayline_fusion.filter.states import Floats

WIDEST = {
    "gps_position": 1_000.0,
    "gps_speed": 150.0,
    "gps_course": math.pi,
    "standstill_gyro": math.radians(360.0),
}
"""How far off a measurement of each sensor can be (SI); a gate as wide rejects none. Positions
can be further off, but a fix that displaces a vehicle by a kilometre should not pass unsaid."""


@cache
def threshold(dimension: int, probability: float) -> float:
    """Bound of the normalised innovation squared that good measurements pass this often."""
    return float(chdtri(dimension, 1.0 - probability))


def nis_of(measurement: Measurement, expected: Floats) -> float:
    """Normalised innovation squared; `expected` is H P H'."""
    y, noise = measurement.y, measurement.R
    if len(y) == 1:
        return float(y[0]) ** 2 / (float(expected[0, 0]) + float(noise[0, 0]))
    return float(y @ np.linalg.solve(expected + noise, y))


def judge(sensor: str, t_ns: int, nis: float, dimension: int, probability: float) -> Verdict:
    """Accept or reject a measurement by its normalised innovation squared."""
    limit = threshold(dimension, probability)
    accepted = nis <= limit
    reason = None if accepted else "too far from the prediction for its and the filter's stds"
    return Verdict(
        sensor=sensor, t_ns=t_ns, accepted=accepted, nis=nis, threshold=limit, reason=reason
    )


def alarmed(verdict: Verdict, measurement: Measurement, expected: Floats) -> Verdict:
    """The verdict, with a reason also to an accepted one where the gate cannot fire."""
    if not verdict.accepted:
        return verdict
    variance = float((expected + measurement.R).diagonal().max())
    if verdict.threshold * variance < WIDEST.get(verdict.sensor, math.inf) ** 2:
        return verdict
    reason = "no measurement could be rejected: the filter's or the sensor's std is too large"
    return msgspec.structs.replace(verdict, reason=reason)
