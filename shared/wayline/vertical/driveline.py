"""Pure: whether an engine is joined to the wheels, so that its torque tells of the road."""

from wayline.messages import Torque

UNSETTLED_NS = 600_000_000
"""After brake, clutch, neutral or another gear, torque and acceleration belong together again."""
UNJOINED = "engine and wheels were not joined: neutral, clutch, or between gears"
REVERSED = "driven backwards"
"""Why torque tells nothing then."""
SAME_RATIO = 0.02
"""A gear's ratio as it is reported differs by less from frame to frame."""


class Driveline:
    """Watches what a bus says of brake, clutch and gear; what it never says it does not watch."""

    def __init__(self) -> None:
        self.tells_brake = False
        """Whether the bus has a signal of the brake."""
        self._gear: int | None = None
        self._ratio: float | None = None
        self._disturbed_ns: int | None = None
        self._disturbance = UNJOINED
        self._braked_ns: int | None = None

    def watch(self, torque: Torque) -> None:
        """Take a message."""
        self.tells_brake |= torque.brake is not None
        shifted = self._has_shifted(torque)
        if torque.clutch or shifted or (self._gear is not None and self._gear < 1):
            self.disturb(torque.t_ns, UNJOINED if (self._gear or 0) >= 0 else REVERSED)
        if torque.brake:
            self._braked_ns = max(torque.t_ns, self._braked_ns or torque.t_ns)

    def disturb(self, t_ns: int, why: str = UNJOINED) -> None:
        """Engine and wheels were not joined at an instant, or not as they are forwards."""
        self._disturbed_ns, self._disturbance = max(t_ns, self._disturbed_ns or t_ns), why

    def disturbance(self, t_ns: int) -> str | None:
        """Why torque tells nothing at an instant; None while engine and wheels are joined."""
        return None if self.is_joined(t_ns) else self._disturbance

    def is_joined(self, t_ns: int) -> bool:
        """Whether engine and wheels have been joined for long enough before an instant."""
        return _is_over(self._disturbed_ns, t_ns)

    def is_settled(self, t_ns: int) -> bool:
        """Whether they have been joined for long enough, and nothing else was at the wheels."""
        return self.is_joined(t_ns) and _is_over(self._braked_ns, t_ns)

    def _has_shifted(self, torque: Torque) -> bool:
        gear, ratio = self._gear, self._ratio
        if torque.gear is not None:
            self._gear = torque.gear
        if torque.gear_ratio is not None:
            self._ratio = torque.gear_ratio
        is_other_gear = gear is not None and gear != self._gear
        return is_other_gear or (
            ratio is not None
            and self._ratio is not None
            and abs(self._ratio - ratio) > SAME_RATIO * abs(ratio)
        )


def _is_over(disturbed_ns: int | None, t_ns: int) -> bool:
    return disturbed_ns is None or t_ns - disturbed_ns > UNSETTLED_NS
