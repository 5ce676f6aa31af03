"""Pure: what is known of one vehicle, each message with the instant when it was received."""

from typing import Generic, TypeVar

import msgspec

from wayline.messages import Arrivals, GpsFix, Message, Pose, Progress, stale_after_s

M = TypeVar("M", bound=Message)


class Heard(msgspec.Struct, Generic[M], frozen=True):
    """A message, who sent it, and when it was received by the reader's own clock.

    Ages come from that clock, not from `t_ns`: a recording that is played now is as fresh as
    what a vehicle sends now.
    """

    message: M
    source: str
    heard_ns: int

    def age_s(self, now_ns: int) -> float:
        """Since it was received."""
        return max(now_ns - self.heard_ns, 0) * 1e-9


class Known(msgspec.Struct, frozen=True, kw_only=True):
    """The newest message of each kind; poses and fixes only those with a position."""

    pose: Heard[Pose] | None = None
    fix: Heard[GpsFix] | None = None
    progress: Heard[Progress] | None = None
    arrivals: Heard[Arrivals] | None = None

    def with_message(self, message: Message, source: str, heard_ns: int) -> "Known":
        """What is known once a message has been received; others change nothing."""
        match message:
            case Pose() if message.lat_deg is not None and message.mode != "lost":
                return msgspec.structs.replace(self, pose=Heard(message, source, heard_ns))
            case GpsFix(valid=True):
                return msgspec.structs.replace(self, fix=Heard(message, source, heard_ns))
            case Progress():
                return msgspec.structs.replace(self, progress=Heard(message, source, heard_ns))
            case Arrivals():
                return msgspec.structs.replace(self, arrivals=Heard(message, source, heard_ns))
        return self

    def position(self, now_ns: int) -> Heard[Pose] | Heard[GpsFix] | None:
        """The pose; a fix where fusion is silent and the fix is the newer one."""
        pose, fix = self.pose, self.fix
        if pose is None or fix is None:
            return pose or fix
        silent = pose.age_s(now_ns) > stale_after_s(Pose)
        return fix if silent and fix.heard_ns > pose.heard_ns else pose

    def arrivals_age_s(self, now_ns: int) -> float:
        """Of what the arrivals rest on: their position, or they themselves if they are older.

        Infinite without arrivals.
        """
        if self.arrivals is None:
            return float("inf")
        rests_on = self.pose or self.fix
        position_age_s = rests_on.age_s(now_ns) if rests_on else 0.0
        return max(self.arrivals.age_s(now_ns), position_age_s)
