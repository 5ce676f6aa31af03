"""Pure: the engine's push, as a slope."""

import math
from typing import ClassVar

import msgspec

from wayline.agreement import Agreement, lasted_s, rejected
from wayline.noise_scale import NoiseScale
from wayline.vertical.bound import at_most
from wayline.vertical.loading import DOUBT_SLOPE_STD, Loading
from wayline.vertical.model import Pushed
from wayline.vertical.propulsion import Push
from wayline.vertical.trust import NO_SUCH_MASS, TORQUE_FACTOR_MIN, is_believable_mass
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.vertical import VerticalEstimate


class TorqueEvidence(msgspec.Struct, frozen=True):
    """What earlier pushes have shown."""

    noise: NoiseScale = NoiseScale()
    """Of the variance that is configured."""
    rejected: Agreement | None = None
    loading: Loading = Loading()


class TorqueSlope:
    """Slopes by engine torque.

    Starts: once an altitude is known, or at once where no altimeter is to be asked. Goes on: each
    likely one corrects slope, mass and its own bias, and teaches how noisy torque is. Stops: an
    unlikely one is rejected; where the mass comes out as no such vehicle's, none is used. Resets:
    rejected for `torque_relock_after_s`, the mass is another one; after a stand it may be any.
    """

    sensor: ClassVar[str] = "torque"

    def __init__(self) -> None:
        self.evidence = TorqueEvidence()

    def take(self, estimate: VerticalEstimate, push: Push) -> Outcome:
        """Correct with a push."""
        tuning, kalman, noise = estimate.tuning, estimate.filter, self.evidence.noise
        if not estimate.known:
            if {"gps", "barometer"} & set(tuning.vertical_sensors):
                return UNUSED
            estimate.known = True
        self._doubt_mass(estimate, push.t_ns)
        streak, loading = self.evidence.rejected, self.evidence.loading
        white = tuning.torque_std_pct / 100.0 / math.sqrt(push.length_s)
        claimed = math.hypot(white, push.sampling_std)
        std = math.sqrt(noise.factor) * claimed
        kalman.project_window(push.speed_std_mps, goes_on=push.goes_on)
        pushed = Pushed(push.length_s, push.share, push.level, push.behind_m)
        measurement = kalman.model.torque(kalman.x, pushed, std)
        if not is_believable_mass(kalman.mass):
            estimate.tell("torque", push.t_ns, NO_SUCH_MASS)
            return UNUSED
        if push.is_braked and float(measurement.y[0]) <= 0.0:
            return UNUSED
        policy = Policy(tuning.gate_probability, weigh=at_most if push.is_braked else None)
        outcome = try_measurement(estimate, measurement, push.t_ns, policy)
        if push.is_braked:
            return outcome
        square, predicted = float(outcome.off[0]) ** 2, float(outcome.expected[0, 0])
        noise = noise.learned(square, predicted, claimed**2, TORQUE_FACTOR_MIN)
        if outcome.is_accepted:
            estimate.note_torque()
            self.evidence = TorqueEvidence(noise, None, loading)
        else:
            self.evidence = TorqueEvidence(noise, rejected(streak, push.t_ns), loading)
        return outcome

    def _doubt_mass(self, estimate: VerticalEstimate, t_ns: int) -> None:
        """Doubt the mass after a stand, and where torques have been rejected for long."""
        noise, streak, loading = msgspec.structs.astuple(self.evidence)
        if loading.is_doubted(t_ns):
            estimate.filter.inflate_mass(estimate.filter.model.load_std)
            estimate.filter.inflate_slope(DOUBT_SLOPE_STD)
        if lasted_s(streak, t_ns) >= estimate.tuning.torque_relock_after_s:
            estimate.filter.inflate_mass(estimate.tuning.mass_std_share)
            streak = None
        self.evidence = TorqueEvidence(noise, streak, Loading(t_ns))
