"""Pure: u-blox's RXM-RAWX, what a receiver measured of each signal, by pyubx2's fields.

Fields are those of the interface descriptions of u-blox 8 and F9 (UBX-RXM-RAWX). The carrier's
phase is not read, so that half cycles in it do no harm.
"""

from functools import cache
from operator import attrgetter
from typing import Any, NamedTuple

from pyubx2 import UBXMessage

from wayline.messages import RawSatellite
from wayline.satellites.gps_time import WEEK_S
from wayline_gps_ingest.raw.measured import raw_satellite

L1_HZ, B1I_HZ, L5_HZ = 1_575.42e6, 1_561.098e6, 1_176.45e6
GLONASS_HZ, GLONASS_STEP_HZ, GLONASS_MIDDLE = 1_602.0e6, 0.5625e6, 7
SIGNALS = {
    (0, 0): ("gps", L1_HZ),
    (1, 0): ("sbas", L1_HZ),
    (2, 0): ("galileo", L1_HZ),
    (2, 1): ("galileo", L1_HZ),
    (3, 0): ("beidou", B1I_HZ),
    (3, 1): ("beidou", B1I_HZ),
    (5, 0): ("qzss", L1_HZ),
    (6, 0): ("glonass", GLONASS_HZ),
    (7, 0): ("navic", L5_HZ),
}
"""By gnssId and sigId: each system's first signal, for which its broadcast clocks hold."""
LEAPS_KNOWN, CLOCK_RESET = 1, 2
"""Bits of recStat."""
PSEUDORANGE_VALID = 1
"""Bit of trkStat."""
LOW_BITS, STD_UNKNOWN = 0x0F, 15
PSEUDORANGE_STD_M, DOPPLER_STD_HZ = 0.01, 0.002
"""Times two to the power of what is told."""
FLAGS = ("prStdev", "doStdev", "trkStat")
"""Of a byte each."""
FIELDS = ("prMes", "doMes", "gnssId", "svId", "sigId", "freqId", "cno", *FLAGS)
FIRST_WEEK = 1_780
"""RXM-RAWX came with u-blox 8 in 2014: a week before has lost its count of 1024."""
WEEKS_LOST = 1_024
NEAR_S = 60.0
"""A week's end that comes again comes within so much."""
PAUSE_S = 86_400.0
"""Weeks may be lost while a receiver is off."""


class Rawx(NamedTuple):
    """An epoch as the receiver tells it."""

    week: int
    tow_s: float
    leaps_s: int | None
    """None where the receiver has not heard it yet."""
    clock_reset: bool
    satellites: tuple[RawSatellite, ...]
    """Without their places; of each its first frequency alone."""


def read_rawx(message: UBXMessage) -> Rawx:
    """An RXM-RAWX message as `pyubx2` has parsed it, bytes of bits left whole.

    Raises AttributeError where it holds less than it says.
    """
    read = [_signal(_fields(number)(message)) for number in range(1, message.numMeas + 1)]
    return Rawx(
        week=message.week,
        tow_s=message.rcvTow,
        leaps_s=message.leapS if message.recStat[0] & LEAPS_KNOWN else None,
        clock_reset=bool(message.recStat[0] & CLOCK_RESET),
        satellites=tuple(satellite for satellite in read if satellite is not None),
    )


@cache
def _fields(number: int) -> "attrgetter[tuple[Any, ...]]":
    """Reads the fields of one signal of a message; the first has number 1."""
    return attrgetter(*(f"{name}_{number:02d}" for name in FIELDS))


def _signal(values: tuple[Any, ...]) -> RawSatellite | None:
    """One signal; None where it is of a further frequency, or nothing could be measured."""
    pseudorange_m, doppler_hz, gnss_id, sv_id, signal_id, frequency_id, *quality = values
    cn0_dbhz, pseudorange_std, doppler_std, tracking = quality
    pseudorange_std, doppler_std = pseudorange_std[0] & LOW_BITS, doppler_std[0] & LOW_BITS
    known = SIGNALS.get((gnss_id, signal_id))
    if known is None:
        return None
    system, carrier_hz = known
    if system == "glonass":
        carrier_hz += (frequency_id - GLONASS_MIDDLE) * GLONASS_STEP_HZ
    told = {"doppler_hz": doppler_hz, "cn0_dbhz": cn0_dbhz, "carrier_hz": carrier_hz}
    if tracking[0] & PSEUDORANGE_VALID:
        told["pseudorange_m"] = pseudorange_m
    if pseudorange_std != STD_UNKNOWN:
        told["pseudorange_std_m"] = PSEUDORANGE_STD_M * 2.0**pseudorange_std
    if doppler_std != STD_UNKNOWN:
        told["doppler_std_hz"] = DOPPLER_STD_HZ * 2.0**doppler_std
    return raw_satellite(system, sv_id, told)


class Weeks:
    """Keeps a receiver's week count whole.

    The week is told apart from its seconds: a receiver may count it up late, so that a week's end
    seems to come again, and old ones have lost 1024 weeks, from the start or some day.
    """

    def __init__(self) -> None:
        self._last_s: float | None = None
        self.mended = 0
        """Epochs whose week was another one than told."""

    def whole(self, week: int, tow_s: float) -> int:
        """The week that a week as told is, at an instant of it."""
        right = week
        while right < FIRST_WEEK:
            right += WEEKS_LOST
        last_s = self._last_s
        if last_s is not None:
            back_s = last_s - right * WEEK_S - tow_s
            if abs(back_s - WEEK_S) < NEAR_S:
                right += 1
            elif abs(back_s - WEEKS_LOST * WEEK_S) < PAUSE_S:
                right += WEEKS_LOST
        self.mended += right != week
        self._last_s = right * WEEK_S + tow_s
        return right
