"""Pure: positions of fixes: corrected with, rejected, or started from."""

import math

import msgspec
import numpy as np

from wayline.messages import Verdict
from wayline_fusion.evidence.lockout import patience_s, rejected
from wayline_fusion.filter import measurements
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import alarmed, judge, nis_of, threshold
from wayline_fusion.filter.measurements import Measurement
from wayline_fusion.filter.states import Floats
from wayline_fusion.intake.events import Fix

POSITION_FACTOR_MIN = 0.05
"""Of the claimed white variance; a receiver that smooths shows none."""
SLOW_FACTOR_POWER = 0.4
"""Of the white variance's factor, on the slow std: nearly as many decibels."""
LIKELY_PROBABILITY = 0.95
"""Reflections in ordinary streets move fixes by metres at once, then not at all for a while: those
less likely than this count for less."""
SAME_ERROR_RATIO = 0.7
"""Of two claimed stds; a satellite more or less changes them by less."""
RELOCK_DOUBT_SHARE = 0.5
"""Positions that have won against dead reckoning may still be the reflections."""


def place(
    estimate: Estimate, fix: Fix, east_m: float, north_m: float, doubt_m: float = 0.0
) -> None:
    """Set the position to a fix; `doubt_m` is what it may share with those that follow."""
    estimate.filter.place(east_m, north_m, fix.position_std_m, doubt_m)
    estimate.remember(placed_ns=fix.t_ns, accepted_fix_ns=fix.t_ns, lockout=None)


def take_position(estimate: Estimate, fix: Fix, east_m: float, north_m: float) -> None:
    """Correct with a position; where dead reckoning is not possible yet, start from it."""
    memory = estimate.memory
    if not memory.heading_known:
        place(estimate, fix, east_m, north_m)
        return
    slow_std_m = estimate.filter.slow_std_m(fix.position_std_m)
    claimed_m2 = fix.position_std_m**2 - slow_std_m**2
    # where white noise is more than claimed, what is slow is too
    slow_std_m *= max(memory.position_noise.factor, 1.0) ** SLOW_FACTOR_POWER
    _renew_fixes_error(estimate, slow_std_m)
    white_m2 = memory.position_noise.factor * claimed_m2
    white_std_m = math.sqrt(max(white_m2, claimed_m2))
    measurement = measurements.position(estimate.filter.x, east_m, north_m, slow_std_m, white_std_m)
    expected = estimate.filter.expected(measurement)
    nis = nis_of(measurement, expected)
    verdict = _position_verdict(estimate, fix.t_ns, nis)
    if verdict.accepted:
        measurement = _weighed(measurement, expected, white_m2)
        verdict = msgspec.structs.replace(verdict, nis=nis_of(measurement, expected))
    estimate.verdicts.append(alarmed(verdict, measurement, expected))
    if not verdict.accepted:
        _locked_out(estimate, fix, (east_m, north_m), measurement, nis)
        return
    estimate.correct(measurement)
    square = 0.5 * float(measurement.y @ measurement.y)
    noise = memory.position_noise.learned(
        square, 0.5 * float(np.trace(expected)), claimed_m2, POSITION_FACTOR_MIN
    )
    estimate.remember(accepted_fix_ns=fix.t_ns, lockout=None, position_noise=noise)


def _weighed(measurement: Measurement, expected: Floats, white_m2: float) -> Measurement:
    """With the noise that was learned; unlikely with that, it counts for as much less."""
    noise_m2 = white_m2 * np.eye(2)
    likely = measurement._replace(R=noise_m2)
    excess = nis_of(likely, expected) / threshold(2, LIKELY_PROBABILITY)
    if excess <= 1.0:
        return likely
    # with this noise its NIS is the threshold
    return measurement._replace(R=noise_m2 + (excess - 1.0) * (expected + noise_m2))


def _renew_fixes_error(estimate: Estimate, slow_std_m: float) -> None:
    """Other satellites, or a receiver that has settled, make another error."""
    known_m = estimate.memory.slow_std_m or slow_std_m
    kept = min(slow_std_m, known_m) / max(slow_std_m, known_m)
    if kept < SAME_ERROR_RATIO:
        estimate.filter.renew_fixes_error(kept)
    if kept < SAME_ERROR_RATIO or estimate.memory.slow_std_m is None:
        estimate.remember(slow_std_m=slow_std_m)


def _unaided_s(estimate: Estimate, t_ns: int) -> float:
    """How long no position has been accepted."""
    return (t_ns - (estimate.memory.accepted_fix_ns or t_ns)) * 1e-9


def _position_verdict(estimate: Estimate, t_ns: int, nis: float) -> Verdict:
    """After a long outage a position that is none too likely waits until others confirm it."""
    tuning, lockout = estimate.tuning, estimate.memory.lockout
    doubt_s = _unaided_s(estimate, t_ns) if lockout is None else lockout.unaided_s
    if doubt_s > tuning.relock_outage_s:
        return judge("gps_position", t_ns, nis, 2, tuning.reacquire_probability)
    return judge("gps_position", t_ns, nis, 2, tuning.gate_probability)


def _locked_out(
    estimate: Estimate,
    fix: Fix,
    place_m: tuple[float, float],
    measurement: Measurement,
    nis: float,
) -> None:
    """Remember a rejected position; believe it when others have agreed for long enough."""
    memory, tuning = estimate.memory, estimate.tuning
    off_m = (float(measurement.y[0]), float(measurement.y[1]))
    unaided_s = _unaided_s(estimate, fix.t_ns)
    lockout = rejected(memory.lockout, fix.t_ns, off_m, fix.position_std_m, unaided_s)
    is_likely = nis <= threshold(2, tuning.gate_probability)
    supported_s = ((memory.accepted_fix_ns or 0) - (memory.placed_ns or 0)) * 1e-9
    if lockout.agreed_s < patience_s(lockout, supported_s, tuning, is_likely=is_likely):
        estimate.remember(lockout=lockout)
    elif is_likely:
        estimate.correct(measurement)
        estimate.remember(accepted_fix_ns=fix.t_ns, lockout=None)
    else:
        place(estimate, fix, *place_m, doubt_m=RELOCK_DOUBT_SHARE * lockout.off_m)
