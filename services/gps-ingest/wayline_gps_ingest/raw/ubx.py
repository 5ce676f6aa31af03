"""Pure: a u-blox receiver's bytes as epochs of raw measurements."""

from collections import Counter, deque
from typing import Protocol

from pyubx2 import GET, VALNONE, UBXMessageError, UBXParseError, UBXReader, UBXTypeError

from wayline.messages import EARLIEST_NS, LATEST_NS
from wayline.satellites.gps_time import unix_ns
from wayline_gps_ingest.raw.ephemerides import Placing
from wayline_gps_ingest.raw.epoch import RawEpoch
from wayline_gps_ingest.raw.ubx_frames import RAWX, SFRBX, UbxSplitter
from wayline_gps_ingest.raw.ubx_rawx import Weeks, read_rawx

TOW_MAX_S = 604_801.0
"""A receiver may count its week up a little late."""
UNTIMED_MAX = 256
"""Navigation messages from before the first epoch, which tells their time, that are kept."""


class HearsMessages(Protocol):
    """What takes the navigation messages that a receiver passes on."""

    def hear(self, message: bytes, t_ns: int) -> None:
        """Take a whole RXM-SFRBX message that came at about a time (Unix ns)."""
        ...


class UbxReceiver:
    """RXM-RAWX and RXM-SFRBX among all that a receiver sends; the rest is passed over.

    `heard` takes the satellites' messages; without it the places come from elsewhere.
    """

    def __init__(self, placing: Placing, heard: HearsMessages | None) -> None:
        self._placing = placing
        self._heard = heard
        self._splitter = UbxSplitter()
        self._weeks = Weeks()
        self._faults: Counter[str] = Counter()
        self._t_ns: int | None = None
        self._untimed: deque[bytes] = deque(maxlen=UNTIMED_MAX)
        self.messages = 0
        """UBX messages of any kind that were whole."""

    @property
    def faults(self) -> dict[str, int]:
        """What was counted, dropped or mended, by reason.

        `checksum`, `torn`: damaged messages; `malformed`: one that does not hold what it says;
        `time`: an epoch of no time that can be; `week`: its week was mended.
        """
        counted = {**self._splitter.faults, **self._faults, "week": self._weeks.mended}
        return {reason: times for reason, times in counted.items() if times}

    def feed(self, chunk: bytes, received_ns: int | None = None) -> list[RawEpoch]:
        """The epochs that a chunk completes."""
        return self.take(self._splitter.feed(chunk), received_ns)

    def end(self) -> list[RawEpoch]:
        """What the last bytes held, now that no more will come."""
        return self.take(self._splitter.end())

    def take(self, messages: list[bytes], received_ns: int | None = None) -> list[RawEpoch]:
        """The epochs in some messages that are whole."""
        epochs: list[RawEpoch] = []
        for message in messages:
            self.messages += 1
            kind = message[2:4]
            if kind == SFRBX:
                self._hear(message)
            elif kind == RAWX:
                epoch = self._epoch(message, received_ns)
                epochs += [epoch] if epoch else []
        return epochs

    def _hear(self, message: bytes) -> None:
        if self._t_ns is None:
            self._untimed.append(message)
        elif self._heard is not None:
            self._heard.hear(message, self._t_ns)

    def _epoch(self, message: bytes, received_ns: int | None) -> RawEpoch | None:
        try:
            # the checksum and the bits of flags are looked at here, which pyubx2 does more slowly
            parsed = UBXReader.parse(message, msgmode=GET, validate=VALNONE, parsebitfield=False)
            told = read_rawx(parsed)
        except (UBXParseError, UBXMessageError, UBXTypeError, AttributeError):
            self._faults["malformed"] += 1
            return None
        if not 0.0 <= told.tow_s <= TOW_MAX_S:
            self._faults["time"] += 1
            return None
        t_ns = unix_ns(self._weeks.whole(told.week, told.tow_s), told.tow_s, told.leaps_s)
        if not EARLIEST_NS <= t_ns <= LATEST_NS:
            self._faults["time"] += 1
            return None
        self._know(t_ns)
        return RawEpoch(
            t_ns=t_ns,
            satellites=self._placing.satellites(t_ns, told.satellites),
            received_ns=received_ns,
            clock_reset=told.clock_reset,
        )

    def _know(self, t_ns: int) -> None:
        """The time, and with it what was heard before it was known."""
        self._t_ns = t_ns
        while self._untimed:
            self._hear(self._untimed.popleft())
