"""Pure: steps of the clock that all sensors share.

A clock that is set leaves a gap in every sensor's times at once, or takes all of them back. Where
the vehicle is then is as uncertain as the way that it drives in such a time.
"""

from wayline.grid import LONGEST_GAP_NS
from wayline.messages import Gyro, Message, Odometer

FORWARD_NS = 1_500_000_000
"""A silent bus leaves the seconds between fixes; more than that is a step of the clock."""
BACK_NS = 1_000_000_000
"""Further back than a measurement may be late is a step of the clock."""
OF_VEHICLE = (Gyro, Odometer)
"""The vehicle's own sensors, which come in order and often."""


class ClockSteps:
    """Watches the times of one vehicle's messages."""

    def __init__(self) -> None:
        self.newest_ns = 0
        self._vehicle_ns: int | None = None

    def step_s(self, message: Message) -> float | None:
        """How far the clock has stepped just before a message; None where it has not."""
        t_ns, newest_ns, vehicle_ns = message.t_ns, self.newest_ns, self._vehicle_ns
        ahead_ns = t_ns - newest_ns
        if ahead_ns > 0:
            self.newest_ns = t_ns
        is_of_vehicle = type(message) in OF_VEHICLE
        if is_of_vehicle:
            self._vehicle_ns = t_ns
        if vehicle_ns is None or 0 <= ahead_ns <= FORWARD_NS:
            return None
        if FORWARD_NS < ahead_ns <= LONGEST_GAP_NS and newest_ns - vehicle_ns <= BACK_NS:
            return ahead_ns * 1e-9
        back_ns = vehicle_ns - t_ns
        if is_of_vehicle and back_ns > BACK_NS:
            return -back_ns * 1e-9
        return None
