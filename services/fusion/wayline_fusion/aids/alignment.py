"""Pure: fixes of a receiver without courses, held against the way that gyro and wheels tell."""

import math

import msgspec

from wayline.geo import LocalPlane, wrap_pi
from wayline_fusion.evidence.track_fit import Fit, Seen, Track
from wayline_fusion.filter.estimate import Estimate
from wayline_fusion.filter.gate import UNUSED, Outcome
from wayline_fusion.filter.states import States
from wayline_fusion.intake.events import FixSeen

APART_STDS = 3.0
"""A heading as far from the fit's is wrong."""
SCATTER_MIN = 1.5
"""Times the claimed std; less may be chance, so few of the fixes are wrong each in its own way."""
LYING = 2.5
"""Times the claimed std: from there on the fit is the estimate, until fixes were better once."""
PROVED_TOLD = 2.0
"""Independent fixes that say so."""
NOISE_SEEN_MIN = 8
"""Fixes; of fewer the scatter says little."""


class AlignmentEvidence(msgspec.Struct, frozen=True):
    """What earlier fixes have shown."""

    plane: LocalPlane | None = None
    """In which the track is kept; the vehicle's own moves along with it."""
    track: Track = Track()
    is_proved: bool = False
    """Fixes have once been worth what they claim."""
    bias_radps: float = 0.0
    bias_std_radps: float = 0.0
    """What was known of the gyro before the first fix: a fit is not to be told its own answer."""


class Alignment:
    """The heading, and what the fixes are worth, by the shape of the way.

    Starts: with gyro and a speed beside fixes that tell no courses. Goes on: each fix is laid over
    the reckoned way; a good fit sets a heading that is not known, and what scatters about the way
    more than is claimed makes fixes count for as much less. Stops: courses are believed, or gyro or
    speed are missing. Resets: a heading three stds off the fit's is set to it, with the place.
    """

    def __init__(self) -> None:
        self.evidence = AlignmentEvidence()

    def take(self, estimate: Estimate, fix: FixSeen) -> Outcome:
        """Remember a fix, believed or not, and use what it makes of the fit."""
        if not estimate.way_reckoned(tells_speed=fix.tells_speed):
            self.evidence = AlignmentEvidence()
            estimate.learn(claim_factor=1.0)
            return UNUSED
        plane = self.evidence.plane or LocalPlane(fix.lat_deg, fix.lon_deg)
        reckoned = estimate.reckoned
        seen = Seen(
            fix.t_ns,
            complex(*plane.to_plane(fix.lat_deg, fix.lon_deg)),
            complex(reckoned.east_m, reckoned.north_m),
            reckoned.biased_s,
        )
        before = self.evidence
        track = before.track.with_fix(seen)
        if before.plane is None:
            kalman = estimate.filter
            bias = float(kalman.x[States.GYRO_BIAS]), kalman.std(States.GYRO_BIAS)
            before = AlignmentEvidence(plane, Track(), False, *bias)
        self.evidence = msgspec.structs.replace(before, plane=plane, track=track)
        if track is before.track and self._is_left_alone(estimate):
            return UNUSED
        fit = track.fit(seen, fix.std_m, *self._bias(estimate))
        if fit is None:
            return UNUSED
        if fit.seen >= NOISE_SEEN_MIN:
            self._claim(estimate, fit, fix)
        self._align(estimate, fix, fit, plane)
        return UNUSED

    def _bias(self, estimate: Estimate) -> tuple[float, float]:
        """Of the gyro, with its std, as it is known without the fixes that are to be fitted."""
        if not self._is_left_alone(estimate):
            return self.evidence.bias_radps, self.evidence.bias_std_radps
        kalman = estimate.filter
        return float(kalman.x[States.GYRO_BIAS]), kalman.std(States.GYRO_BIAS)

    def _is_left_alone(self, estimate: Estimate) -> bool:
        """Whether the filter is on its way: it knows its heading, by fixes that are worth it."""
        lies = estimate.learned.claim_factor >= LYING and not self.evidence.is_proved
        return estimate.situation.heading_known and not lies

    def _claim(self, estimate: Estimate, fit: Fit, fix: FixSeen) -> None:
        """Let fixes count for so much less as they scatter."""
        scatter = fit.noise_m / fix.std_m
        factor = scatter if scatter > SCATTER_MIN else 1.0
        estimate.learn(claim_factor=factor)
        if factor < LYING and fit.told >= PROVED_TOLD:
            self.evidence = msgspec.structs.replace(self.evidence, is_proved=True)

    def _align(self, estimate: Estimate, fix: FixSeen, fit: Fit, plane: LocalPlane) -> None:
        """Set place and heading where they are not known, or not what the fit says."""
        kalman, situation = estimate.filter, estimate.situation
        heading_rad = estimate.reckoned.heading_rad + fit.turn_rad
        is_sure = fit.turn_std_rad <= math.radians(estimate.tuning.heading_start_std_deg)
        if self._is_left_alone(estimate):
            off_rad = abs(wrap_pi(heading_rad - float(kalman.x[States.HEADING])))
            expected_rad = math.hypot(kalman.std(States.HEADING), fit.turn_std_rad)
            if off_rad <= APART_STDS * expected_rad or not is_sure:
                return
        if situation.plane is None or (fit.seen < NOISE_SEEN_MIN and not is_sure):
            return
        lat_deg, lon_deg = plane.to_geodetic(fit.place_m.real, fit.place_m.imag)
        place_m = situation.plane.to_plane(lat_deg, lon_deg)
        kalman.reset_position(*place_m, max(fit.noise_m, fix.std_m))
        estimate.know(placed_ns=fix.t_ns, accepted_fix_ns=fix.t_ns)
        if is_sure:
            kalman.reset_reckoning((*place_m, heading_rad, fit.bias_radps), fit.covariance)
            estimate.know(heading_known=True)
