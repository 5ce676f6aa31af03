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
from wayline_fusion.filter.estimate import Estimate, Unseen
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.horizontal import SPEED_UNKNOWN_MPS
from wayline_fusion.filter.states import States
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
OFTEN_S = 5.0
"""Between fixes that come more seldom dead reckoning is the one to doubt, as after an outage."""
OUTAGE_INTERVALS = 3.0
"""A silence is no outage before so many of the source's fixes are missing."""
GUESSED_RATIO = 3.0
"""Of stds: a way that is known so much worse than the fix's white noise says nothing of it."""
DIRECTION_UNSURE_RAD = math.radians(60.0)
"""Of a heading that was wrong for long."""
RELOCK_DOUBT_SHARE = 0.5
"""Positions that have won against dead reckoning may still be the reflections."""
AGREEING_M = 10.0
AGREEING_STDS = 4.0
"""Rejected positions agree when they are displaced alike, to so many metres or stds..."""
AGREEING_SHARE = 0.5
"""...or, where they come seldom and the way between them strays, to this share of how far."""


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

    def __init__(self, unseen: Unseen) -> None:
        self.evidence = PositionEvidence()
        self._unseen = unseen

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
        std_m = estimate.learned.claim_factor * _std_m(estimate, fix)
        slow_std_m = estimate.filter.slow_std_m(std_m)
        claimed_m2 = std_m**2 - slow_std_m**2
        # where white noise is more than claimed, what is slow is too
        slow_std_m *= max(noise.factor, 1.0) ** SLOW_FACTOR_POWER
        self._renew_error(estimate, slow_std_m)
        white_m2 = noise.factor * claimed_m2
        white_std_m = math.sqrt(max(white_m2, claimed_m2))
        measurement = measurements.position(estimate.filter.x, *place_m, slow_std_m, white_std_m)

        # with turns and speed told nothing unseen explains an unlikely position
        look = None if estimate.motion_told else partial(self._unseen, estimate)
        weigh = partial(_weighed, white_m2) if _is_way_known(estimate, measurement) else None
        probability = self._probability(estimate, fix.t_ns)
        policy = Policy(probability, second_look=look, weigh=weigh)
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
        std_m = estimate.learned.claim_factor * fix.std_m
        estimate.filter.reset_position(*place_m, std_m, doubt_m)
        estimate.know(placed_ns=fix.t_ns)
        self._accepted(estimate, fix.t_ns)
        return UNUSED

    def _strayed_m(self, estimate: Estimate) -> float:
        """How much less alike rejected positions may be where the heading may be wrong.

        A wrong one takes the reckoned way elsewhere than the true one.
        """
        agreement = self.evidence.agreement
        if agreement is None or (estimate.courses_told and estimate.gyro.covers(estimate.t_ns)):
            return 0.0
        way_s = (estimate.t_ns - agreement.last_ns) * 1e-9
        return 2.0 * abs(estimate.filter.speed_mps) * way_s

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
        outage_s = max(tuning.relock_outage_s, OUTAGE_INTERVALS * estimate.situation.fix_interval_s)
        is_lost = self._unaided_s(estimate, t_ns) > outage_s
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
        within_m = max(AGREEING_M, AGREEING_STDS * fix.std_m)
        if situation.fix_interval_s > OFTEN_S:
            within_m = max(within_m, AGREEING_SHARE * math.hypot(*off_m))
        alike = partial(are_alike, within_m + self._strayed_m(estimate))
        agreement = rejected(
            self.evidence.agreement, fix.t_ns, off_m, alike, estimate.rejected_forgotten_ns
        )
        self.evidence = msgspec.structs.replace(self.evidence, agreement=agreement)
        is_likely = outcome.nis <= threshold(2, tuning.gate_probability)
        supported_s = ((situation.accepted_fix_ns or 0) - (situation.placed_ns or 0)) * 1e-9
        unaided_s = self._unaided_s(estimate, fix.t_ns)
        wait_s = patience_s(unaided_s, supported_s, tuning, is_likely=is_likely)
        if not estimate.gyro.covers(fix.t_ns):
            wait_s = min(wait_s, tuning.relock_without_gyro_s)
        if situation.fix_interval_s > OFTEN_S:
            wait_s = min(wait_s, tuning.relock_after_outage_s)
        if agreement.agreed_s < wait_s:
            return
        if is_likely:
            estimate.correct(measurement)
            self._accepted(estimate, fix.t_ns)
        else:
            self._place(estimate, fix, place_m, RELOCK_DOUBT_SHARE * agreement.distance)
            if not estimate.courses_told:
                _doubt_direction(estimate)


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


def _doubt_direction(estimate: Estimate) -> None:
    """Positions have won against a heading that came from nothing else."""
    kalman = estimate.filter
    kalman.reset_std(States.HEADING, max(kalman.std(States.HEADING), DIRECTION_UNSURE_RAD))
    if not estimate.wheels_fresh and not estimate.speeds_told:
        kalman.reset_std(States.WHEEL_SPEED, SPEED_UNKNOWN_MPS)


def _std_m(estimate: Estimate, fix: GpsPosition) -> float:
    """Of a fix as it is to count, before its noise was learned.

    A bad fix is all but ignored (papers/003) for dead reckoning's sake, as long as that is any
    better than what the fix's own dilution says of it.
    """
    if fix.is_good or estimate.gyro.covers(fix.t_ns):
        return fix.std_m
    own_std_m = fix.std_m / estimate.tuning.bad_gps_factor
    kalman = estimate.filter
    reckoned_m = math.hypot(kalman.std(States.EAST), kalman.std(States.NORTH))
    return own_std_m if reckoned_m > own_std_m else fix.std_m


def _is_way_known(estimate: Estimate, measurement: Measurement) -> bool:
    """Whether dead reckoning tells more than the fix does; a way without a gyro is guessed."""
    if estimate.gyro.covers(estimate.t_ns):
        return True
    if estimate.speeds_told and not estimate.courses_told:
        # what makes a position unlikely is then a turn
        return False
    predicted_m2 = float(np.trace(estimate.filter.expected(measurement)))
    return predicted_m2 <= GUESSED_RATIO**2 * float(np.trace(measurement.R))


def _weighed(white_m2: float, measurement: Measurement, expected: Floats) -> Measurement:
    """With the noise that was learned; unlikely with that, it counts for as much less."""
    likely = measurement._replace(R=white_m2 * np.eye(2))
    return weighed(likely, expected, LIKELY_PROBABILITY)
