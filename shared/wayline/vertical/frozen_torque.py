"""Pure: a torque that is told again and again, as by a unit that has lost its engine."""

from wayline.messages import Torque

LONGEST_M = 500.0
"""No engine pulls so evenly over so long a way that not one step of its torque changes."""
FROZEN = "the torque does not change, however far the vehicle drives"
"""Why it is not used then."""


class FrozenTorque:
    """Compares one vehicle's torques with the distance that it has driven meanwhile."""

    def __init__(self) -> None:
        self._torque_nm: float | None = None
        self._since_m = 0.0

    def is_frozen(self, torque: Torque, driven_m: float) -> bool:
        """Whether a message repeats a torque that is long over; one without a torque does not.

        `driven_m` is the distance so far. What was told over the first LONGEST_M was believed.
        """
        if torque.engine_torque_nm is None:
            return False
        if torque.engine_torque_nm != self._torque_nm:
            self._torque_nm, self._since_m = torque.engine_torque_nm, driven_m
        return driven_m - self._since_m > LONGEST_M
