"""Pure: J1939-21 transport protocol, heard as a bystander: packets in, whole messages out.

Announced to everybody (BAM) or agreed between two (RTS/CTS); we neither answer nor ask again.
"""

import math
from collections.abc import Collection
from dataclasses import dataclass, field

from wayline.inputs import Frame
from wayline_can_ingest.j1939 import identifier_of, pgn_of

CONNECTION_PGN, DATA_PGN = 0xEC00, 0xEB00
RTS, CTS, END, BAM, ABORT = 16, 17, 19, 32, 255
EVERYBODY = 0xFF
PACKET_BYTES = 7
LEAST_BYTES, MOST_BYTES = 9, 1785
BROADCAST_TIMEOUT_NS = 750_000_000
"""T1 between two packets of a broadcast."""
AGREED_TIMEOUT_NS = 1_250_000_000
"""T2 and T3: between packets and for an answer."""
MOST_SESSIONS = 64
"""At once; a bus of thirty units has a handful. Bounds the memory at 120 kB."""

SessionKey = tuple[str, int, int]
"""Channel, source, destination: between two units there is one at a time."""


@dataclass(slots=True)
class Session:
    """A message that is under way."""

    pgn: int
    size: int
    last_ns: int
    timeout_ns: int
    packets: dict[int, bytes] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Packets that make the message."""
        return math.ceil(self.size / PACKET_BYTES)

    def is_over(self, t_ns: int) -> bool:
        """Whether it timed out, or the clock stepped back."""
        return not 0 <= t_ns - self.last_ns <= self.timeout_ns

    def whole(self) -> bytes | None:
        """The message, None while packets are missing."""
        if len(self.packets) < self.count:
            return None
        data = b"".join(self.packets[number] for number in range(1, self.count + 1))
        return data[: self.size] if len(data) >= self.size else None


class Reassembler:
    """Messages of the wanted groups; packets of others are passed over."""

    def __init__(self, wanted: Collection[int]) -> None:
        self._wanted = frozenset(wanted)
        self._sessions: dict[SessionKey, Session] = {}
        self.broken = 0
        """Messages that began and were never whole: a packet lost, a time-out, an abort."""

    def take(self, frame: Frame) -> Frame | None:
        """The message that this frame completes, as one long frame at the last packet's time."""
        pgn = pgn_of(frame.arbitration_id)
        if pgn == DATA_PGN:
            return self._data(frame)
        if pgn == CONNECTION_PGN and len(frame.data) == 8:
            self._control(frame)
        return None

    def _control(self, frame: Frame) -> None:
        source, destination = _ends(frame)
        key, reverse = (
            (frame.channel, source, destination),
            (frame.channel, destination, source),
        )
        kind = frame.data[0]
        if kind in (RTS, BAM):
            self._drop(key)
            self._begin(key, frame, is_broadcast=kind == BAM)
        elif kind == CTS and reverse in self._sessions:
            self._sessions[reverse].last_ns = frame.t_ns
        elif kind == END:
            self._drop(reverse)
        elif kind == ABORT:
            self._drop(key)
            self._drop(reverse)

    def _begin(self, key: SessionKey, frame: Frame, *, is_broadcast: bool) -> None:
        size = int.from_bytes(frame.data[1:3], "little")
        pgn = int.from_bytes(frame.data[5:8], "little")
        timeout_ns = BROADCAST_TIMEOUT_NS if is_broadcast else AGREED_TIMEOUT_NS
        session = Session(pgn, size, frame.t_ns, timeout_ns)
        known = LEAST_BYTES <= size <= MOST_BYTES and frame.data[3] == session.count
        if pgn not in self._wanted or not known or is_broadcast != (key[2] == EVERYBODY):
            return
        if len(self._sessions) >= MOST_SESSIONS:
            self._drop(next(iter(self._sessions)))
        self._sessions[key] = session

    def _data(self, frame: Frame) -> Frame | None:
        source, destination = _ends(frame)
        key = (frame.channel, source, destination)
        session = self._sessions.get(key)
        if session is None or not frame.data:
            return None
        if session.is_over(frame.t_ns):
            self._drop(key)
            return None
        session.last_ns = frame.t_ns
        if 1 <= frame.data[0] <= session.count:
            session.packets[frame.data[0]] = frame.data[1:8]
        data = session.whole()
        if data is None:
            return None
        del self._sessions[key]
        identifier = identifier_of(session.pgn, source, destination)
        return Frame(frame.t_ns, frame.channel, identifier, True, data)

    def _drop(self, key: SessionKey) -> None:
        if self._sessions.pop(key, None) is not None:
            self.broken += 1


def _ends(frame: Frame) -> tuple[int, int]:
    """Source and destination address."""
    return frame.arbitration_id & 0xFF, (frame.arbitration_id >> 8) & 0xFF
