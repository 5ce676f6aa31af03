"""Pure: positions of fixes: corrected with, rejected, or started from."""

import math
from functools import partial

import msgspec
import numpy as np

from wayline.agreement import Agreement, Off, rejected
from wayline.geo import LocalPlane
from wayline.likelihood import Floats, Measurement, threshold, weighed
from wayline.tuning import Tuning
from wayline_fusion.filter import measurements
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.intake.events import GpsPosition

WHITE_FACTOR_MIN = 0.05
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
AGREEING_M = 10.0
AGREEING_STDS = 4.0
"""Rejected positions agree when they are displaced alike, to so many metres or stds."""


class PositionEvidence(msgspec.Struct, frozen=True):
    """What earlier positions have shown."""

    slow_std_m: float | None = None
    """Of the fixes' slow error when that was last renewed."""
    agreement: Agreement | None = None
    """Of those that were rejected, in metres east and north of the prediction."""


class Position:
    """Positions of fixes.

    Starts: the first position, and each one until the heading is known, sets the place. Goes on:
    each likely one corrects; less likely than 95 %, it counts for less. After an outage of more
    than a minute one less likely than 99 % waits. Stops: an unlikely one is rejected. Resets:
    rejected ones that agree with each other for as long as those before had, within bounds, set
    the place anew, in doubt by half of the distance.

    Reflections between high walls are as consistent as a true position, and so is a receiver that
    is fooled for a while. What tells them apart is time: a set of walls lasts a minute or so,
    during which dead reckoning is good to metres; after a long outage it is the one to doubt.
    """

    def __init__(self) -> None:
        self.evidence = PositionEvidence()

    def take(self, estimate: Estimate, fix: GpsPosition) -> Outcome:
        """Correct with a position; where dead reckoning is not possible yet, start from it."""
        plane = estimate.situation.plane
        if plane is None:
            estimate.know(plane=LocalPlane(fix.lat_deg, fix.lon_deg))
            return self._place(estimate, fix, (0.0, 0.0))
        place_m = plane.to_plane(fix.lat_deg, fix.lon_deg)
        if not estimate.situation.heading_known:
            return self._place(estimate, fix, place_m)
        return self._try(estimate, fix, place_m)

    def _try(self, estimate: Estimate, fix: GpsPosition, place_m: tuple[float, float]) -> Outcome:
        noise = estimate.learned.position_noise
        slow_std_m = estimate.filter.slow_std_m(fix.std_m)
        claimed_m2 = fix.std_m**2 - slow_std_m**2
        # where white noise is more than claimed, what is slow is too
        slow_std_m *= max(noise.factor, 1.0) ** SLOW_FACTOR_POWER
        self._renew_error(estimate, slow_std_m)
        white_m2 = noise.factor * claimed_m2
        white_std_m = math.sqrt(max(white_m2, claimed_m2))
        measurement = measurements.position(estimate.filter.x, *place_m, slow_std_m, white_std_m)
        policy = Policy(self._probability(estimate, fix.t_ns), weigh=partial(_weighed, white_m2))
        outcome = try_measurement(estimate, measurement, fix.t_ns, policy)
        if not outcome.is_accepted:
            self._wait(estimate, fix, place_m, measurement, outcome)
            return outcome
        square = 0.5 * float(outcome.off @ outcome.off)
        predicted = 0.5 * float(np.trace(outcome.expected))
        estimate.learn(
            position_noise=noise.learned(square, predicted, claimed_m2, WHITE_FACTOR_MIN)
        )
        self._accepted(estimate, fix.t_ns)
        return outcome

    def _accepted(self, estimate: Estimate, t_ns: int) -> None:
        estimate.know(accepted_fix_ns=t_ns)
        self.evidence = msgspec.structs.replace(self.evidence, agreement=None)

    def _place(
        self,
        estimate: Estimate,
        fix: GpsPosition,
        place_m: tuple[float, float],
        doubt_m: float = 0.0,
    ) -> Outcome:
        """Set the position to a fix; `doubt_m` is what it may share with those that follow."""
        estimate.filter.reset_position(*place_m, fix.std_m, doubt_m)
        estimate.know(placed_ns=fix.t_ns)
        self._accepted(estimate, fix.t_ns)
        return UNUSED

    def _renew_error(self, estimate: Estimate, slow_std_m: float) -> None:
        """Other satellites, or a receiver that has settled, make another error."""
        before_m = self.evidence.slow_std_m
        known_m = before_m or slow_std_m
        kept = min(slow_std_m, known_m) / max(slow_std_m, known_m)
        if kept < SAME_ERROR_RATIO:
            estimate.filter.project_fix_error(kept)
        if kept < SAME_ERROR_RATIO or before_m is None:
            self.evidence = msgspec.structs.replace(self.evidence, slow_std_m=slow_std_m)

    def _unaided_s(self, estimate: Estimate, t_ns: int) -> float:
        """How long dead reckoning had lasted when the first was rejected, or lasts now."""
        agreement, accepted_ns = self.evidence.agreement, estimate.situation.accepted_fix_ns
        until_ns = t_ns if agreement is None else agreement.first_ns
        return (until_ns - (accepted_ns or until_ns)) * 1e-9

    def _probability(self, estimate: Estimate, t_ns: int) -> float:
        """After a long outage a position that is none too likely waits until others confirm it."""
        tuning = estimate.tuning
        is_lost = self._unaided_s(estimate, t_ns) > tuning.relock_outage_s
        return tuning.reacquire_probability if is_lost else tuning.gate_probability

    def _wait(
        self,
        estimate: Estimate,
        fix: GpsPosition,
        place_m: tuple[float, float],
        measurement: Measurement,
        outcome: Outcome,
    ) -> None:
        """Remember a rejected position; believe it when others have agreed for long enough."""
        situation, tuning = estimate.situation, estimate.tuning
        off_m = (float(outcome.off[0]), float(outcome.off[1]))
        alike = partial(are_alike, max(AGREEING_M, AGREEING_STDS * fix.std_m))
        agreement = rejected(self.evidence.agreement, fix.t_ns, off_m, alike)
        self.evidence = msgspec.structs.replace(self.evidence, agreement=agreement)
        is_likely = outcome.nis <= threshold(2, tuning.gate_probability)
        supported_s = ((situation.accepted_fix_ns or 0) - (situation.placed_ns or 0)) * 1e-9
        unaided_s = self._unaided_s(estimate, fix.t_ns)
        if agreement.agreed_s < patience_s(unaided_s, supported_s, tuning, is_likely=is_likely):
            return
        if is_likely:
            estimate.correct(measurement)
            self._accepted(estimate, fix.t_ns)
        else:
            self._place(estimate, fix, place_m, RELOCK_DOUBT_SHARE * agreement.distance)


def patience_s(unaided_s: float, supported_s: float, tuning: Tuning, *, is_likely: bool) -> float:
    """How long positions must agree before they are believed.

    `unaided_s` is how long dead reckoning had lasted when the first was rejected, `supported_s` how
    long the accepted positions before had agreed; `is_likely` says that these pass the gate,
    though not the one after an outage.
    """
    if unaided_s <= tuning.relock_outage_s:
        most_s = tuning.relock_after_s
    else:
        most_s = tuning.relock_at_once_s if is_likely else tuning.relock_after_outage_s
    return max(min(supported_s, most_s), tuning.relock_at_once_s)


def are_alike(within_m: float, before: Off, off: Off) -> bool:
    """Whether two positions are displaced alike."""
    return math.dist(before, off) <= within_m


def _weighed(white_m2: float, measurement: Measurement, expected: Floats) -> Measurement:
    """With the noise that was learned; unlikely with that, it counts for as much less."""
    likely = measurement._replace(R=white_m2 * np.eye(2))
    return weighed(likely, expected, LIKELY_PROBABILITY)
