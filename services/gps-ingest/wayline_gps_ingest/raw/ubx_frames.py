"""Pure: a receiver's bytes into whole UBX messages, whatever else comes among them."""

from collections import Counter

import msgspec
import numpy as np

SYNC = b"\xb5\x62"
RAWX, SFRBX = b"\x02\x15", b"\x02\x13"
"""Class and id: measurements, and words of satellites' navigation messages."""
HEAD_BYTES, TAIL_BYTES = 6, 2
"""Sync, class, id and length before the payload; the checksum behind it."""
PAYLOAD_MAX_BYTES = 8_192
"""More than an RXM-RAWX of 255 signals: a length beyond that is damage."""


class UbxBytes(msgspec.Struct, frozen=True):
    """A UBX message as it came, head and checksum included."""

    received_ns: int | None
    message: bytes


class UbxSplitter:
    """Bytes of one connection or file in, in whatever pieces they come, messages out.

    A message is found by its sync and proved by its checksum; where that fails the search goes on
    right behind the sync, so that a torn message costs itself and not the next one. Counted in
    `faults`, which may be shared by splitters that follow each other: `checksum`, and `torn` for
    what the end has cut off.
    """

    def __init__(self, faults: Counter[str] | None = None) -> None:
        self._rest = bytearray()
        self.faults: Counter[str] = Counter() if faults is None else faults

    def feed(self, chunk: bytes) -> list[bytes]:
        """The messages that a chunk completes, head and checksum included."""
        rest = self._rest
        rest += chunk
        messages: list[bytes] = []
        start = rest.find(SYNC)
        while start >= 0:
            end = _end(rest, start)
            if end > len(rest):
                break
            message = bytes(rest[start:end])
            if end and is_sound(message):
                messages.append(message)
                start = rest.find(SYNC, end)
            else:
                self.faults["checksum"] += bool(end)
                start = rest.find(SYNC, start + len(SYNC))
        # a sync may be torn, too
        del rest[: start if start >= 0 else max(len(rest) - 1, 0)]
        return messages

    def end(self) -> list[bytes]:
        """What was held back for a message that will not be completed, now that no more comes."""
        messages: list[bytes] = []
        while self._rest.startswith(SYNC):
            self.faults["torn"] += 1
            del self._rest[: len(SYNC)]
            messages += self.feed(b"")
        return messages


def _end(data: bytearray, start: int) -> int:
    """Where a message ends that starts there: beyond the data if it goes on, 0 if it is none."""
    if len(data) < start + HEAD_BYTES:
        return len(data) + 1
    length = int.from_bytes(data[start + 4 : start + HEAD_BYTES], "little")
    return start + HEAD_BYTES + length + TAIL_BYTES if length <= PAYLOAD_MAX_BYTES else 0


def is_sound(message: bytes) -> bool:
    """Whether a whole message's checksum (8-bit Fletcher) holds."""
    covered = np.frombuffer(message, np.uint8)[2:-TAIL_BYTES].astype(np.int64)
    first = int(covered.sum()) & 0xFF
    second = int(covered @ np.arange(len(covered), 0, -1)) & 0xFF
    return message[-TAIL_BYTES:] == bytes((first, second))
