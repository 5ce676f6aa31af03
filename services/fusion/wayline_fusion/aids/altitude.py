"""Pure: altitudes of fixes: corrected with, rejected, or believed again."""

from wayline.likelihood import Floats, Measurement, weighed
from wayline.vertical.trust import AltitudeTrust
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.vertical import VerticalEstimate
from wayline_fusion.intake.events import GpsAltitude

LIKELY_PROBABILITY = 0.95
"""Those less likely than this count for less: walls move them by metres at once."""


class Altitude:
    """Altitudes of fixes, each receiver with an error of its own.

    Starts: the first one tells the altitude. Goes on: each likely one corrects; less likely than
    95 %, it counts for less. Stops: an unlikely one is rejected, the altitude is held by barometer
    and slope. Resets: rejected ones that agree with each other for as long as those before had,
    within bounds, free the altitude, and the barometer's bias the other way.
    """

    def __init__(self) -> None:
        self.evidence: tuple[AltitudeTrust, ...] = ()
        """Of each receiver, by its number."""

    def take(self, estimate: VerticalEstimate, fix: GpsAltitude) -> Outcome:
        """Correct with an altitude."""
        kalman, receiver = estimate.filter, estimate.receiver(fix.source)
        kalman.project_error(receiver, fix.std_m)
        measurement = kalman.gps_altitude(receiver, fix.alt_m, fix.std_m)
        trust = self.evidence[receiver] if receiver < len(self.evidence) else AltitudeTrust()
        if not estimate.known:
            estimate.correct(measurement)
            estimate.known = True
            self._trust(receiver, trust.after_set(fix.t_ns))
            return UNUSED
        policy = Policy(estimate.tuning.gate_probability, weigh=_weighed)
        outcome = try_measurement(estimate, measurement, fix.t_ns, policy)
        if outcome.is_accepted:
            self._trust(receiver, trust.after_accepted(fix.t_ns))
            return outcome
        trust = trust.after_rejected(fix.t_ns, float(outcome.off[0]), fix.std_m)
        if trust.is_won(estimate.tuning):
            kalman.inflate_altitude(float(outcome.off[0]))
            estimate.correct(measurement)
            trust = trust.after_set(fix.t_ns)
            estimate.tell("gps_altitude", fix.t_ns, "another altitude for long; believed")
        self._trust(receiver, trust)
        return outcome

    def _trust(self, receiver: int, trust: AltitudeTrust) -> None:
        self.evidence = (*self.evidence[:receiver], trust, *self.evidence[receiver + 1 :])


def _weighed(measurement: Measurement, expected: Floats) -> Measurement:
    return weighed(measurement, expected, LIKELY_PROBABILITY)
