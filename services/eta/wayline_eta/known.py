"""Pure: what is known of one vehicle, each message with the receipt that tells its age."""

from typing import Generic, TypeVar

import msgspec

from wayline.messages import Arrivals, GpsFix, Message, Pose, Progress, StopEvent, stale_after_s
from wayline.view import Receipt

M = TypeVar("M", bound=Message)


class Heard(msgspec.Struct, Generic[M], frozen=True):
    """A message, who sent it, and its receipt; `now_ns` is of the receipt's clock."""

    message: M
    source: str
    receipt: Receipt

    def age_s(self, now_ns: int) -> float:
        """Of what it tells, by the older of the vehicle's clock and the host's."""
        return self.receipt.age_s(now_ns)

    def since_s(self, now_ns: int) -> float:
        """Since it came."""
        return max(now_ns - self.receipt.at_ns, 0) * 1e-9


class Known(msgspec.Struct, frozen=True, kw_only=True):
    """The newest message of each kind; poses and fixes only those with a position."""

    pose: Heard[Pose] | None = None
    fix: Heard[GpsFix] | None = None
    progress: Heard[Progress] | None = None
    arrivals: Heard[Arrivals] | None = None
    stop_events: tuple[StopEvent, ...] = ()
    """Of the trip under way, the stops that were left out and the last one that something
    happened at."""

    def with_message(self, message: Message, source: str, receipt: Receipt) -> "Known":
        """What is known once a message has been received; others change nothing."""
        match message:
            case Pose() if message.lat_deg is not None and message.mode != "lost":
                return msgspec.structs.replace(self, pose=Heard(message, source, receipt))
            case GpsFix(valid=True):
                return msgspec.structs.replace(self, fix=Heard(message, source, receipt))
            case Progress():
                return msgspec.structs.replace(self, progress=Heard(message, source, receipt))
            case Arrivals():
                return msgspec.structs.replace(self, arrivals=Heard(message, source, receipt))
            case StopEvent():
                return msgspec.structs.replace(self, stop_events=self._happened(message))
        return self

    def _happened(self, event: StopEvent) -> tuple[StopEvent, ...]:
        kept = [each for each in self.stop_events if each.trip_id == event.trip_id]
        return (*(each for each in kept if each.kind == "skipped"), event)

    def position(self, now_ns: int) -> Heard[Pose] | Heard[GpsFix] | None:
        """The pose; a fix where fusion is silent and the fix is the newer one."""
        pose, fix = self.pose, self.fix
        if pose is None or fix is None:
            return pose or fix
        silent = pose.age_s(now_ns) > stale_after_s(Pose)
        return fix if silent and fix.age_s(now_ns) < pose.age_s(now_ns) else pose
