"""Pure: what fusion asks of an architecture, and what each can answer.

papers/001 names ways to bring GPS and dead reckoning together, papers/003 filters for GPS alone.
Each takes the same events; the core publishes what it knows and never asks which one it has.
"""

from typing import Any, ClassVar, Protocol

import msgspec

from wayline.messages import Verdict
from wayline_fusion.filter.gyro_track import TakeGyro
from wayline_fusion.filter.vertical import Progress
from wayline_fusion.intake.events import Event


class Motion(msgspec.Struct, frozen=True, kw_only=True):
    """Where the vehicle is and how it moves; None where unknown, stds are one sigma."""

    t_ns: int
    accepted_fix_ns: int | None
    place_deg: tuple[float, float] | None
    """Latitude and longitude."""
    east_std_m: float
    north_std_m: float
    east_north_cov_m2: float
    heading_deg: float | None
    heading_std_deg: float
    speed_mps: float | None
    """Negative in reverse."""
    speed_std_mps: float
    yaw_rate_degps: float | None = None
    is_unconfirmed: bool = False
    """The place is that of before a restart; no fix has told since."""


class SensorErrors(msgspec.Struct, frozen=True, kw_only=True):
    """What is known of the sensors, as `fusion_status` tells it; None where nothing is learned."""

    gyro_bias_degps: float | None = None
    gyro_bias_std_degps: float | None = None
    gyro_scale: float | None = None
    gyro_scale_std: float | None = None
    odometer_scale: float | None = None
    odometer_scale_std: float | None = None
    gps_latency_s: float | None = None
    gps_latency_std_s: float | None = None


class Architecture(Protocol):
    """Estimates one vehicle's motion from events; can be set back, so that late ones fit in."""

    uses_vehicle: ClassVar[bool]
    """Whether gyro and wheels count: without them a pose is one of GPS."""

    @property
    def takes(self) -> frozenset[type[Event]]:
        """The kinds of events that it wants to be given."""
        ...

    @property
    def take_gyro(self) -> TakeGyro:
        """Takes a gyro sample."""
        ...

    def know_gyro_steps(self, rounding_std_radps: float) -> None:
        """Take the std of the gyro's steps, whenever other ones have been seen."""
        ...

    def apply(self, event: Event) -> None:
        """Bring the state forward to an event and take it in."""
        ...

    def snapshot(self) -> Any:
        """Everything that `restore` needs to set the state back to now."""
        ...

    def restore(self, snapshot: Any) -> None:
        """Set the state back."""
        ...

    def take_verdicts(self) -> list[Verdict]:
        """Verdicts since the last call."""
        ...

    @property
    def progress(self) -> Progress:
        """How far the vehicle has come."""
        ...

    def motion(self) -> Motion:
        """Where the vehicle is now."""
        ...

    def sensor_errors(self) -> SensorErrors:
        """What is known of the sensors now."""
        ...
