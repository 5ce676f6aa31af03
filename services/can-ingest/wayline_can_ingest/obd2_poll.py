"""Asks a car for its values by OBD-II (SAE J1979 mode 01) over ISO-TP; it never asks for more.

Nothing here opens a bus: frames come in, messages to send go out, time is given.
"""

from collections import deque
from typing import NamedTuple

import can
import isotp

from wayline.inputs import Frame
from wayline_can_ingest.wanted import Filter

CURRENT_DATA = 0x01
"""The only service asked for: it reads."""
POSITIVE, NEGATIVE = 0x41, 0x7F
BUSY, PENDING = 0x21, 0x78
FUNCTIONAL_ID, FUNCTIONAL_EXTENDED_ID = 0x7DF, 0x18DB_33F1
REPLY_ID = 0x7E8
"""Replies are given on as the first control unit's single frames, which profile obd2 decodes."""
REPLIES: tuple[Filter, ...] = (
    {"can_id": 0x7E8, "can_mask": 0x7F8, "extended": False},
    {"can_id": 0x18DA_F100, "can_mask": 0x1FFF_FF00, "extended": True},
)
SPEED, RPM, TORQUE, REFERENCE_TORQUE, BAROMETER = 0x0D, 0x0C, 0x62, 0x63, 0x33
LOAD, FRICTION_TORQUE = 0x04, 0x8E
PERIODS_S = {
    SPEED: 0.05,
    RPM: 0.05,
    TORQUE: 0.05,
    FRICTION_TORQUE: 1.0,
    LOAD: 2.0,
    BAROMETER: 2.0,
    REFERENCE_TORQUE: 5.0,
}
"""At most so often; a vehicle that answers slowly is asked in turn, the one most overdue first."""
SUPPORT_PIDS = (0x00, 0x20, 0x40, 0x60, 0x80)
ASK_S = 0.5
"""Between calls into a silent bus, by turns with short and long identifiers."""
REPLY_S = 0.2
"""J1979 grants 50 ms; gateways take longer."""
PENDING_S = 5.0
"""J1979 after "response pending"."""
REFUSED_S = 60.0
"""A value that the vehicle refuses is asked for again after this long."""
MOST_MISSES = 5
"""Requests in a row without a reply after which the vehicle is taken for gone."""
LONGEST_GAP_S = 0.5
FIRST_GAP_S = 0.01


class Asked(NamedTuple):
    """A request under way."""

    pid: int
    deadline_s: float


class Ecu:
    """One control unit behind ISO-TP."""

    def __init__(self, reply_id: int, extended: bool) -> None:
        self.reply_id, self.extended = reply_id, extended
        mode = isotp.AddressingMode.Normal_11bits
        request_id = reply_id - 8
        if extended:
            mode = isotp.AddressingMode.Normal_29bits
            request_id = 0x18DA_00F1 | (reply_id & 0xFF) << 8
        self._in: deque[isotp.CanMessage] = deque()
        self._out: list[can.Message] = []
        self._stack = isotp.TransportLayerLogic(
            rxfn=lambda _: self._in.popleft() if self._in else None,
            txfn=self._send,
            address=isotp.Address(mode, txid=request_id, rxid=reply_id),
            params={"tx_padding": 0, "rx_consecutive_frame_timeout": round(REPLY_S * 1e3)},
        )

    def ask(self, pid: int) -> list[can.Message]:
        """The frames of a request."""
        self._stack.send(bytes((CURRENT_DATA, pid)))
        self._stack.process()
        return self.to_send()

    def hear(self, frame: Frame) -> bytes | None:
        """Take a frame of a reply; the reply where the frame completes it."""
        self._in.append(
            isotp.CanMessage(frame.arbitration_id, len(frame.data), frame.data, frame.extended)
        )
        self._stack.process()
        reply = self._stack.recv()
        return None if reply is None else bytes(reply)

    def to_send(self) -> list[can.Message]:
        """Frames that ISO-TP has to send, its flow control among them."""
        out, self._out = self._out, []
        return out

    def _send(self, message: isotp.CanMessage) -> None:
        self._out.append(request(message.arbitration_id, bytes(message.data), self.extended))


class Obd2Poll:
    """Finds the control unit that answers, asks what it supports, then asks for that in turn."""

    def __init__(self) -> None:
        self._ecu: Ecu | None = None
        self._found: dict[tuple[int, bool], Ecu] = {}
        self._asked: Asked | None = None
        self._due_s: dict[int, float] = {}
        self._misses = 0
        self._gap_s = FIRST_GAP_S
        self._next_s = 0.0
        self._calls_long = False

    @property
    def note(self) -> str:
        """Who is asked for what."""
        if self._ecu is None:
            return "the vehicle does not answer"
        pids = " ".join(f"{pid:02X}" for pid in sorted(self._due_s) if pid in PERIODS_S)
        return f"polls {self._ecu.reply_id:X} for {pids or 'what it supports'}"

    @staticmethod
    def is_reply(frame: Frame) -> bool:
        """Whether a frame comes from a control unit that answers testers."""
        return any(
            frame.extended == each["extended"]
            and not (frame.arbitration_id ^ each["can_id"]) & each["can_mask"]
            for each in REPLIES
        )

    def hear(self, frame: Frame, now_s: float) -> Frame | None:
        """Take a frame of a control unit; the value that it completes, as a single frame."""
        key = (frame.arbitration_id, frame.extended)
        ecu = self._found.get(key) or self._found.setdefault(key, Ecu(*key))
        reply = ecu.hear(frame)
        if reply is None or len(reply) < 3:
            return None
        if self._ecu is None:
            self._meet(ecu, reply, now_s)
            return None
        if ecu is not self._ecu:
            return None
        if reply[0] == NEGATIVE and reply[1] == CURRENT_DATA:
            self._refused(reply[2], now_s)
            return None
        return self._answered(frame, reply, now_s) if reply[0] == POSITIVE else None

    def act(self, now_s: float) -> list[can.Message]:
        """What to send now."""
        out = [] if self._ecu is None else self._ecu.to_send()
        if self._asked is not None:
            if now_s < self._asked.deadline_s:
                return out
            self._missed(now_s)
        if now_s < self._next_s:
            return out
        if self._ecu is None:
            return [*out, self._call(now_s)]
        pid = min(self._due_s, key=lambda each: self._due_s[each])
        if self._due_s[pid] > now_s:
            return out
        self._asked = Asked(pid, now_s + REPLY_S)
        return [*out, *self._ecu.ask(pid)]

    def wait_s(self, now_s: float) -> float:
        """How long nothing is to be sent unless something comes."""
        if self._asked is not None:
            return max(self._asked.deadline_s - now_s, 0.0)
        due_s = min(self._due_s.values(), default=0.0)
        return max(self._next_s - now_s, due_s - now_s, 0.0)

    def _call(self, now_s: float) -> can.Message:
        """Ask whoever is there what it supports."""
        self._next_s = now_s + ASK_S
        extended, self._calls_long = self._calls_long, not self._calls_long
        identifier = FUNCTIONAL_EXTENDED_ID if extended else FUNCTIONAL_ID
        return request(identifier, bytes((2, CURRENT_DATA, 0, 0, 0, 0, 0, 0)), extended)

    def _meet(self, ecu: Ecu, reply: bytes, now_s: float) -> None:
        """Follow the first control unit that knows the vehicle's or the engine's speed."""
        if reply[0] != POSITIVE or reply[1] != 0:
            return
        supported = supported_pids(reply)
        if not {SPEED, RPM} & supported:
            return
        self._ecu, self._misses, self._next_s = ecu, 0, now_s
        self._due_s = {}
        self._learn(supported, now_s)

    def _learn(self, supported: set[int], now_s: float) -> None:
        for pid in sorted(supported & {*PERIODS_S, *SUPPORT_PIDS}):
            self._due_s.setdefault(pid, now_s)

    def _answered(self, frame: Frame, reply: bytes, now_s: float) -> Frame | None:
        pid = reply[1]
        if self._asked is None or pid != self._asked.pid:
            return None
        self._asked, self._misses = None, 0
        self._gap_s *= 0.9
        self._next_s = now_s + self._gap_s
        if pid in SUPPORT_PIDS:
            del self._due_s[pid]
            self._learn(supported_pids(reply), now_s)
            return None
        self._due_s[pid] = max(self._due_s[pid] + PERIODS_S[pid], now_s)
        data = bytes((len(reply), *reply)).ljust(8, b"\0")
        return Frame(frame.t_ns, frame.channel, REPLY_ID, False, data) if len(data) == 8 else None

    def _refused(self, code: int, now_s: float) -> None:
        if self._asked is None:
            return
        pid = self._asked.pid
        if code == PENDING:
            self._asked = Asked(pid, now_s + PENDING_S)
            return
        self._asked, self._misses = None, 0
        self._next_s = now_s + self._gap_s
        self._due_s[pid] = now_s + (LONGEST_GAP_S if code == BUSY else REFUSED_S)

    def _missed(self, now_s: float) -> None:
        """Ask more slowly; after some misses in a row begin anew."""
        if self._asked is None:
            return
        pid, self._asked = self._asked.pid, None
        self._misses += 1
        self._gap_s = min(max(self._gap_s * 2.0, FIRST_GAP_S), LONGEST_GAP_S)
        self._next_s = now_s + self._gap_s
        self._due_s[pid] = now_s + PERIODS_S.get(pid, ASK_S)
        if self._misses >= MOST_MISSES:
            self._ecu, self._due_s, self._found = None, {}, {}
            self._gap_s, self._next_s = FIRST_GAP_S, now_s


def request(identifier: int, data: bytes, extended: bool) -> can.Message:
    """A frame to send."""
    return can.Message(arbitration_id=identifier, data=data, is_extended_id=extended)


def supported_pids(reply: bytes) -> set[int]:
    """The identifiers that a reply to 00, 20, 40 or 60 says are supported."""
    bits = int.from_bytes(reply[2:6].ljust(4, b"\0"), "big")
    return {reply[1] + number for number in range(1, 33) if bits >> (32 - number) & 1}
