"""The rate of a serial line is found from what was read of it; an emulated line makes the noise."""

import pytest

from wayline.framing import SentenceSplitter
from wayline_gps_ingest.baud import PATIENCE_S, RATES, BaudSearch, UbxEar, is_sound

BURST = (
    b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n"
    b"$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\r\n"
    b"$GPGSA,A,3,04,05,,09,12,,,24,,,,,2.5,1.3,2.1*39\r\n"
    b"$GPGSV,2,1,08,01,40,083,46,02,17,308,41,12,07,344,39,14,22,228,45*75\r\n"
)
NAV_POSLLH_POLL = bytes.fromhex("b56201020000030a")
PIECE = 32
POLL_S = 0.2


def read_at(data: bytes, sent_bps: int, read_bps: int) -> bytes:
    """What a UART at one rate makes of what another one sends at its own."""
    levels = [1]
    for byte in data:
        levels += [0, *(byte >> bit & 1 for bit in range(8)), 1]
    step = sent_bps / read_bps
    heard, place = bytearray(), 0
    while 0 in levels[place:]:
        start = levels.index(0, place)
        sampled = [int(start + (bit + 1.5) * step) for bit in range(8)]
        bits = [levels[at] if at < len(levels) else 1 for at in sampled]
        heard.append(sum(level << bit for bit, level in enumerate(bits)))
        # the next start bit comes after a level that could be a stop bit
        stop = int(start + 9.5 * step)
        place = levels.index(1, stop) if 1 in levels[stop:] else len(levels)
    return bytes(heard)


class Line:
    """A receiver that sends a burst each second, and a search that reads the line."""

    def __init__(self) -> None:
        self.search = BaudSearch()
        self.now_s = 0.0
        self._splitter = SentenceSplitter()

    def second(self, sent_bps: int, burst: bytes = BURST) -> None:
        end_s = self.now_s + 1.0
        for start in range(0, len(burst), PIECE):
            piece = burst[start : start + PIECE]
            self.now_s += len(piece) * 10.0 / sent_bps
            self._read(read_at(piece, sent_bps, self.search.rate_bps))
        while self.now_s < end_s:
            self.now_s += POLL_S
            self._read(b"")
        self.now_s = end_s

    def _read(self, chunk: bytes) -> None:
        sound = any(map(is_sound, self._splitter.feed(chunk) if chunk else []))
        if self.search.heard(self.now_s, chunk, sound=sound):
            self._splitter = SentenceSplitter()

    def seconds_until_found(self, sent_bps: int) -> int:
        for seconds in range(20):
            if self.search.found_bps == self.search.rate_bps == sent_bps:
                return seconds
            self.second(sent_bps)
        raise AssertionError(f"{sent_bps} was not found, {self.search.rate_bps} is tried")


def test_the_emulated_line_is_clear_at_its_own_rate_and_noise_at_others() -> None:
    """Else the tests below would test nothing."""
    assert read_at(BURST, 9600, 9600) == BURST
    for rate_bps in set(RATES) - {9600}:
        assert not any(map(is_sound, SentenceSplitter().feed(read_at(BURST, 9600, rate_bps))))


@pytest.mark.parametrize("sent_bps", RATES)
def test_every_rate_is_found_within_one_round(sent_bps: int) -> None:
    """A receiver that speaks once a second is found by its ninth second at the latest."""
    assert Line().seconds_until_found(sent_bps) <= len(RATES)


def test_noise_passes_without_a_change_of_rate() -> None:
    """A rate that was right is kept through a second of noise."""
    line = Line()
    line.second(9600)
    line.second(57600)
    assert line.search.rate_bps == 9600


@pytest.mark.parametrize("noisy_s", range(3, 12))
def test_after_any_spell_of_noise_the_old_rate_is_back_within_two_seconds(noisy_s: int) -> None:
    """While others are tried the last good rate has every second turn."""
    line = Line()
    assert line.seconds_until_found(115200) > 0
    for _ in range(noisy_s):
        line.second(300)
    assert line.seconds_until_found(115200) <= 2


def test_a_receiver_that_changed_its_rate_is_found_again() -> None:
    """Patience with the old rate has an end."""
    line = Line()
    assert line.seconds_until_found(9600) == 1
    assert line.seconds_until_found(38400) <= PATIENCE_S + 2 * len(RATES)


def test_silence_changes_nothing() -> None:
    """A receiver that says nothing says nothing of its rate."""
    line = Line()
    for _ in range(10):
        line.second(9600, b"")
    assert line.search.rate_bps == RATES[0]
    assert line.search.found_bps is None


def test_the_end_of_a_sentence_is_no_reason_to_leave() -> None:
    """A line that is opened in mid-sentence reads text, though nothing sound."""
    line = Line()
    line.second(9600, BURST[-30:])
    assert line.search.rate_bps == 9600


def test_a_sentence_is_sound_by_its_checksum_or_by_its_text() -> None:
    """Receivers of the eighties send no checksum."""
    assert is_sound("$GPGLL,4916.45,N,12311.12,W,225444,A,*1D")
    assert not is_sound("$GPGLL,4916.45,N,12311.12,W,225444,A,*1E")
    assert is_sound("$GPGLL,4916.45,N,12311.12,W,225444,A")
    assert not is_sound("$GPGLL,4916.45,N,\x8f\x00,W,225444,A")
    assert not is_sound("$GPGLL,4916")


def test_ubx_is_noticed_in_pieces_and_only_with_its_checksum() -> None:
    """A receiver whose NMEA output is off is told from noise."""
    ear = UbxEar()
    assert not ear.hears(b"\x00\xb5" + NAV_POSLLH_POLL[:5])
    assert ear.hears(NAV_POSLLH_POLL[5:])
    assert not ear.hears(NAV_POSLLH_POLL[:-1] + b"\x00")
    assert not ear.hears(b"\xb5\x62" * 3000)
