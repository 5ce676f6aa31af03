"""From what python-can gives to a frame, whatever it gives."""

import math
from collections import Counter

import can

from wayline.inputs import Frame

ERROR, REMOTE, MALFORMED = "error frames", "remote frames", "malformed"
BUS_OFF = "bus-off"
BUS_OFF_BIT, PASSIVE_BITS = 0x40, 0x30
"""Of an error frame: CAN_ERR_BUSOFF in its identifier, and the passive states in its byte 1."""
CONTROLLER_BIT = 0x04
"""CAN_ERR_CRTL: byte 1 tells the controller's state."""
HOST_CLOCK_NS = 10_000_000
"""Stamps this close to their receipt are of this machine's own clock, and better than it."""
WINDOW_NS = 5_000_000_000
"""How long the fastest delivery stands for the distance of two clocks: 50 ppm drift 0.3 ms."""


JUMP_NS = 2_000_000_000
"""Frames do not wait so long for their reader; it is the adapter's clock that began anew."""


class FrameReader:
    """Frames of one bus; what is none is counted by its kind."""

    def __init__(self, channel: str) -> None:
        self._channel = channel
        self._clock = AdapterClock()
        self.faults: Counter[str] = Counter()
        self.state: str | None = None
        """What the last error frame said of the controller, until a frame comes."""

    def frame(self, message: object, received_ns: int) -> Frame | None:
        """The frame in a python-can message; None for an error, a remote frame or rubbish."""
        if not isinstance(message, can.Message):
            self.faults[MALFORMED] += 1
            return None
        if message.is_error_frame:
            self.faults[ERROR] += 1
            self.state = controller_state(message) or self.state
            return None
        if message.is_remote_frame:
            self.faults[REMOTE] += 1
            return None
        self.state = None
        return self._checked(message, received_ns)

    def _checked(self, message: can.Message, received_ns: int) -> Frame | None:
        number, extended = message.arbitration_id, bool(message.is_extended_id)
        try:
            data = bytes(message.data)
            known = 0 <= number <= (0x1FFF_FFFF if extended else 0x7FF) and len(data) <= 64
            t_ns = self._clock.t_ns(message.timestamp, received_ns)
        except (TypeError, ValueError):
            known = False
        if not known:
            self.faults[MALFORMED] += 1
            return None
        return Frame(t_ns, self._channel, number, extended, data)


def controller_state(message: can.Message) -> str | None:
    """What an error frame says of the controller (linux/can/error.h), None for a lesser error."""
    if message.arbitration_id & BUS_OFF_BIT:
        return BUS_OFF
    data = message.data
    if message.arbitration_id & CONTROLLER_BIT and len(data) > 1 and data[1] & PASSIVE_BITS:
        return "error passive"
    return None


class AdapterClock:
    """Unix time of frames that an adapter stamps by a clock of its own.

    That clock may count from anywhere and drift. The fastest delivery of the last seconds tells
    how far it is from this machine's.
    """

    def __init__(self) -> None:
        self._began_ns = 0
        self._least_ns: int | None = None
        self._least_before_ns: int | None = None

    def t_ns(self, timestamp_s: float, received_ns: int) -> int:
        """When a frame was on the bus; its receipt where the stamp is no number."""
        if not math.isfinite(timestamp_s):
            return received_ns
        stamp_ns = round(timestamp_s * 1e6) * 1000
        distance_ns = self._distance_ns(received_ns - stamp_ns, received_ns)
        if abs(distance_ns) < HOST_CLOCK_NS:
            return min(stamp_ns, received_ns)
        return stamp_ns + distance_ns

    def _distance_ns(self, delay_ns: int, received_ns: int) -> int:
        if self._least_ns is not None and delay_ns - self._least_ns > JUMP_NS:
            self._least_ns = None
        if self._least_ns is None or not 0 <= received_ns - self._began_ns < WINDOW_NS:
            self._least_before_ns, self._least_ns = self._least_ns, delay_ns
            self._began_ns = received_ns
        self._least_ns = min(self._least_ns, delay_ns)
        if self._least_before_ns is None:
            return self._least_ns
        return min(self._least_ns, self._least_before_ns)
