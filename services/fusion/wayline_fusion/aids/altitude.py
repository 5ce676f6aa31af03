"""Pure: altitudes of fixes: corrected with, rejected, or believed again."""

import msgspec

from wayline.likelihood import Floats, Measurement, weighed
from wayline.vertical.trust import LIKELY_PROBABILITY, AltitudeTrust
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.vertical import VerticalEstimate
from wayline_fusion.intake.events import GpsAltitude


class Altitude:
    """Altitudes of fixes, each receiver with an error of its own.

    Starts: the first one tells the altitude. Goes on: each likely one corrects; beside a barometer
    one that is less likely than 95 % counts for less. Stops: an unlikely one is rejected, the
    altitude is held by barometer and slope. Resets: rejected ones that agree with each other for as
    long as those before had, within bounds, free the altitude, and the barometer's bias with it.
    """

    def __init__(self) -> None:
        self.evidence: tuple[AltitudeTrust, ...] = ()
        """Of each receiver, by its number."""

    def take(self, estimate: VerticalEstimate, fix: GpsAltitude) -> Outcome:
        """Correct with an altitude."""
        kalman, receiver = estimate.filter, estimate.receiver(fix.source)
        trust = self.evidence[receiver] if receiver < len(self.evidence) else AltitudeTrust()
        trust = _renewed(estimate, receiver, trust, fix.std_m)
        measurement = kalman.model.gps_altitude(kalman.x, receiver, fix.alt_m, fix.std_m)
        if not estimate.known:
            estimate.correct(measurement)
            estimate.known = True
            self._trust(receiver, trust.after_set(fix.t_ns))
            return UNUSED
        # without a barometer nothing but the road's own unrest tells noise from a hill
        weigh = _weighed if estimate.pressure_fresh else None
        policy = Policy(estimate.tuning.gate_probability, weigh=weigh)
        outcome = try_measurement(estimate, measurement, fix.t_ns, policy)
        if outcome.is_accepted:
            self._trust(receiver, trust.after_accepted(fix.t_ns))
            return outcome
        off_m = float(outcome.off[0])
        trust = trust.after_rejected(fix.t_ns, off_m, fix.std_m)
        if trust.is_won(estimate.tuning):
            kalman.inflate_altitude(off_m)
            estimate.correct(measurement)
            trust = trust.after_set(fix.t_ns)
            estimate.tell("gps_altitude", fix.t_ns, "another altitude for long; believed")
        self._trust(receiver, trust)
        return outcome

    def _trust(self, receiver: int, trust: AltitudeTrust) -> None:
        self.evidence = (*self.evidence[:receiver], trust, *self.evidence[receiver + 1 :])


def _renewed(
    estimate: VerticalEstimate, receiver: int, trust: AltitudeTrust, std_m: float
) -> AltitudeTrust:
    """With the receiver's slow error as it is now that the receiver claims this std."""
    slow_std_m = estimate.filter.model.slow_std_m(std_m)
    before_m = trust.slow_std_m
    if before_m is None or estimate.filter.project_error(receiver, before_m, slow_std_m):
        return msgspec.structs.replace(trust, slow_std_m=slow_std_m)
    return trust


def _weighed(measurement: Measurement, expected: Floats) -> Measurement:
    return weighed(measurement, expected, LIKELY_PROBABILITY)
