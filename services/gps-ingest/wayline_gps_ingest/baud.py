"""Pure: finds the rate of a serial line from what was read of it.

Read at a wrong rate, a receiver's text is noise: no sentence in it is sound, and most of its bytes
are no text. Nothing is sent to the receiver, so it is not disturbed.
"""

import re
import string
from functools import reduce
from operator import xor

RATES = (9600, 4800, 115200, 38400, 57600, 19200, 230400, 460800, 921600)
"""Bits per second, the most common of receivers first."""
NOISE_MAX = 400
"""So many bytes without a sentence or a binary message tell that the rate is wrong."""
PAUSE_S = 0.15
"""Longer than within a burst: a receiver has said all that it had to say."""
PATIENCE_S = 2.0
"""Noise passes: a rate that was right is not left sooner."""
TEXT_MIN = 0.9
"""Share of text in what a link that opens in mid-sentence reads at the right rate."""
TEXT = string.printable.encode()
SOUND = re.compile(r"[$!]([ -~]*)\*([0-9A-Fa-f]{2})")
UNCHECKED = re.compile(r"[$!][A-Z0-9]{5}(?:,[ -~]*){4,}")
UBX_HEAD = b"\xb5\x62"
UBX_OVERHEAD_BYTES = 8
UBX_KEPT_BYTES = 2048


class BaudSearch:
    """Tries rates until sentences are sound, and again when they no longer are.

    While it looks, the last good rate has every second turn: noise may pass, and a receiver that
    was unplugged comes back as it was. `now_s` is any steady clock.
    """

    def __init__(self) -> None:
        self.rate_bps = RATES[0]
        self.found_bps: int | None = None
        """The last rate at which something was sound."""
        self._place = 0
        self._sound_s = float("-inf")
        self.start()

    @property
    def is_found(self) -> bool:
        """Whether the present rate is one at which something was sound."""
        return self.rate_bps == self.found_bps

    def start(self) -> None:
        """Forget what was read: the line was opened, or its rate changed."""
        self._noise_bytes = self._text_bytes = 0
        self._last_s = 0.0

    def heard(self, now_s: float, chunk: bytes, *, sound: bool) -> bool:
        """Take what was read, be it nothing, and whether it held something sound.

        True when the line is to be read at another `rate_bps` from now on.
        """
        if sound:
            self.found_bps, self._sound_s = self.rate_bps, now_s
            self.start()
            return False
        if chunk:
            self._noise_bytes += len(chunk)
            self._text_bytes += len(chunk) - len(chunk.translate(None, TEXT))
            self._last_s = now_s
        if not self._is_wrong(now_s):
            return False
        self._turn()
        return True

    def _is_wrong(self, now_s: float) -> bool:
        if not self._noise_bytes or (self.is_found and now_s - self._sound_s < PATIENCE_S):
            return False
        paused = now_s - self._last_s >= PAUSE_S
        is_text = self._text_bytes >= TEXT_MIN * self._noise_bytes
        return self._noise_bytes >= NOISE_MAX or (paused and not is_text)

    def _turn(self) -> None:
        if self.found_bps is not None and not self.is_found:
            self.rate_bps = self.found_bps
        else:
            others = [rate_bps for rate_bps in RATES if rate_bps != self.found_bps]
            self._place = (self._place + 1) % len(others)
            self.rate_bps = others[self._place]
        self.start()


def is_sound(sentence: str) -> bool:
    """Whether a sentence was read at the right rate; those of old receivers have no checksum."""
    checked = SOUND.match(sentence)
    if checked:
        return reduce(xor, checked[1].encode(), 0) == int(checked[2], 16)
    return UNCHECKED.fullmatch(sentence) is not None


class UbxEar:
    """Notices u-blox binary messages, of a receiver whose NMEA output may be off."""

    def __init__(self) -> None:
        self._kept = b""

    def hears(self, chunk: bytes) -> bool:
        """Whether a whole message with its checksum ends in this chunk."""
        data = self._kept + chunk
        self._kept = data[-UBX_KEPT_BYTES:]
        start = data.find(UBX_HEAD)
        while start >= 0:
            if _is_ubx(data[start:]):
                self._kept = b""
                return True
            start = data.find(UBX_HEAD, start + 1)
        return False


def _is_ubx(data: bytes) -> bool:
    """Whether data begin with a UBX message whose checksum (8-bit Fletcher) holds."""
    length = int.from_bytes(data[4:6], "little")
    if length > UBX_KEPT_BYTES or len(data) < UBX_OVERHEAD_BYTES + length:
        return False
    first = second = 0
    for byte in data[2 : 6 + length]:
        first = (first + byte) & 0xFF
        second = (second + first) & 0xFF
    return (first, second) == (data[6 + length], data[7 + length])
