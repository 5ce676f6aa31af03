"""Pure: air pressures, as altitudes of the standard atmosphere."""

import msgspec

from wayline.agreement import Agreement, lasted_s, rejected
from wayline_fusion.filter.gate import UNUSED, Outcome, Policy, try_measurement
from wayline_fusion.filter.vertical import VerticalEstimate
from wayline_fusion.intake.events import Pressure


class PressureEvidence(msgspec.Struct, frozen=True):
    """What earlier pressures have shown."""

    rejected: Agreement | None = None


class AirPressure:
    """Barometric altitudes.

    Starts: the first one after an altitude of a fix; where no fix is to be asked, it tells the
    altitude itself, as well as the weather allows. Goes on: each likely one corrects. Stops: an
    unlikely one is rejected: a door, a train of air in a tunnel. Resets: rejected for
    `baro_relock_after_s`, the bias is another one.
    """

    def __init__(self) -> None:
        self.evidence = PressureEvidence()

    def take(self, estimate: VerticalEstimate, pressure: Pressure) -> Outcome:
        """Correct with a barometric altitude."""
        tuning, kalman = estimate.tuning, estimate.filter
        if not estimate.known:
            if "gps" in tuning.vertical_sensors:
                return UNUSED
            estimate.correct(kalman.barometer(pressure.alt_m, pressure.std_m))
            estimate.known = True
            return UNUSED
        measurement = kalman.barometer(pressure.alt_m, pressure.std_m)
        streak = self.evidence.rejected
        if lasted_s(streak, pressure.t_ns) >= tuning.baro_relock_after_s:
            kalman.inflate_bias(float(measurement.y[0]))
        policy = Policy(tuning.gate_probability, tells_accepted=False)
        outcome = try_measurement(estimate, measurement, pressure.t_ns, policy)
        streak = None if outcome.is_accepted else rejected(streak, pressure.t_ns)
        self.evidence = PressureEvidence(streak)
        return outcome
