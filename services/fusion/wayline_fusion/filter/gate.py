"""Pure: the one way in which a measurement is tried: likely enough it corrects, else it is told of.

The gate is chi-square's: a measurement too unlikely for its own and the filter's stds is rejected.
What an aid wants otherwise it says in its `Policy`.
"""

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from wayline.likelihood import Floats, Measurement, nis_of, threshold
from wayline.messages import Verdict

WIDEST = {
    "gps_position": 1_000.0,
    "gps_speed": 150.0,
    "gps_course": math.pi,
    "standstill_gyro": math.radians(360.0),
}
"""How far off a measurement of each sensor can be (SI); a gate as wide rejects none. Positions
can be further off, but a fix that displaces a vehicle by a kilometre should not pass unsaid."""
TOO_FAR = "too far from the prediction for its and the filter's stds"
TOO_WIDE = "no measurement could be rejected: the filter's or the sensor's std is too large"

Weigh = Callable[[Measurement, Floats], Measurement]
"""From a measurement and its H P H' to the measurement as it is to count."""


class Policy(NamedTuple):
    """How an aid wants its measurement to be tried."""

    probability: float
    """Good measurements pass the gate this often."""
    second_look: Callable[[Measurement], bool] | None = None
    """Asked before an unlikely one is rejected: whether something was doubted, so that it is to be
    judged again."""
    weigh: Weigh | None = None
    """What a likely one counts for; None: as it is."""
    update: Callable[[Measurement], None] | None = None
    """What a likely one does; None: it corrects."""
    tells_accepted: bool = True
    """Whether a likely one gets a verdict too; an unlikely one always does."""
    reason: str = TOO_FAR
    """Said of an unlikely one."""


class Outcome(NamedTuple):
    """What has become of a measurement."""

    is_accepted: bool
    off: Floats
    """The innovation."""
    expected: Floats
    """Its covariance without the measurement's own noise, H P H', before anything was doubted."""
    nis: float
    threshold: float


UNUSED = Outcome(is_accepted=False, off=np.empty(0), expected=np.empty((0, 0)), nis=0, threshold=0)
"""Of an event that had nothing to be measured by: it set a state, or said nothing."""


class Corrected(Protocol):
    """A filter, as the gate needs it."""

    def expected(self, measurement: Measurement) -> Floats:
        """H P H'."""
        ...


class Estimating(Protocol):
    """What is believed, and where verdicts go."""

    @property
    def filter(self) -> Corrected:
        """Tells what is expected."""
        ...

    @property
    def verdicts(self) -> list[Verdict]:
        """To be told."""
        ...

    def correct(self, measurement: Measurement) -> None:
        """Update the state."""
        ...


def try_measurement(
    estimate: Estimating, measurement: Measurement, t_ns: int, policy: Policy
) -> Outcome:
    """Judge a measurement, tell the verdict, and update the state with a likely one."""
    expected = judged_by = estimate.filter.expected(measurement)
    nis = nis_of(measurement, expected)
    limit = threshold(len(measurement.y), policy.probability)
    if nis > limit and policy.second_look is not None and policy.second_look(measurement):
        judged_by = estimate.filter.expected(measurement)
        nis = nis_of(measurement, judged_by)
    if nis > limit:
        estimate.verdicts.append(
            verdict(measurement.sensor, t_ns, nis, limit, reason=policy.reason, accepted=False)
        )
        return Outcome(False, measurement.y, expected, nis, limit)
    if policy.weigh is not None:
        measurement = policy.weigh(measurement, judged_by)
        nis = nis_of(measurement, judged_by)
    if policy.tells_accepted:
        reason = alarm(measurement, judged_by, limit)
        estimate.verdicts.append(verdict(measurement.sensor, t_ns, nis, limit, reason=reason))
    (policy.update or estimate.correct)(measurement)
    return Outcome(True, measurement.y, expected, nis, limit)


def alarm(measurement: Measurement, expected: Floats, limit: float) -> str | None:
    """What is wrong with a gate that let a measurement pass: it cannot fire."""
    widest = WIDEST.get(measurement.sensor)
    if widest is None:
        return None
    variance = float((expected + measurement.R).diagonal().max())
    return None if limit * variance < widest**2 else TOO_WIDE


def verdict(
    sensor: str,
    t_ns: int,
    nis: float = 0.0,
    limit: float = 0.0,
    *,
    reason: str | None,
    accepted: bool = True,
) -> Verdict:
    """As `fusion_status` tells it."""
    return Verdict(
        sensor=sensor, t_ns=t_ns, accepted=accepted, nis=nis, threshold=limit, reason=reason
    )
