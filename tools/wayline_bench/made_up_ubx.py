"""Pure: made-up GPS satellites as a u-blox receiver passes them on: UBX of their broadcasts.

Orbits are those that IS-GPS-200 writes. What is put into the subframes' bits is what a place is
reckoned from, so that a library which reads the bits and reckons anew can be held against it.
"""

import math
import struct
from collections.abc import Sequence
from typing import NamedTuple

from wayline.satellites.earth import EARTH_RATE_RADPS

SEMICIRCLE = math.pi
HALF_WEEK_S, WEEK_S = 302_400.0, 604_800.0
MU_GPS = 3.986005e14
"""IS-GPS-200's own, which its orbits are to be reckoned with."""
RELATIVISTIC_S_PER_SQRT_M = -4.442807633e-10


class Field(NamedTuple):
    """Some bits of a subframe of 240 (parity left out), and what one is worth."""

    first: int
    bits: int
    scale: float = 1.0
    signed: bool = False


LAYOUT: dict[int, dict[str, Field]] = {
    1: {
        "week": Field(48, 10),
        "health": Field(64, 6),
        "toc_s": Field(176, 16, 16.0),
        "f1": Field(200, 16, 2.0**-43, True),
        "f0_s": Field(216, 22, 2.0**-31, True),
        "tgd_s": Field(160, 8, 2.0**-31, True),
        "iodc_low": Field(168, 8),
    },
    2: {
        "iode": Field(48, 8),
        "deln": Field(72, 16, 2.0**-43 * SEMICIRCLE, True),
        "m0": Field(88, 32, 2.0**-31 * SEMICIRCLE, True),
        "e": Field(136, 32, 2.0**-33),
        "sqrt_a": Field(184, 32, 2.0**-19),
        "toe_s": Field(216, 16, 16.0),
    },
    3: {
        "omega0": Field(64, 32, 2.0**-31 * SEMICIRCLE, True),
        "i0": Field(112, 32, 2.0**-31 * SEMICIRCLE, True),
        "omega": Field(160, 32, 2.0**-31 * SEMICIRCLE, True),
        "omega_dot": Field(192, 24, 2.0**-43 * SEMICIRCLE, True),
        "iode": Field(216, 8),
    },
}


class Orbit(NamedTuple):
    """A satellite's broadcast ephemeris, rounded to what its bits hold."""

    prn: int
    week: int
    toe_s: float
    numbers: dict[str, float]

    def subframes(self) -> list[list[int]]:
        """Subframes 1 to 3 as ten words of 24 bits each."""
        return [self._subframe(number) for number in (1, 2, 3)]

    def _subframe(self, number: int) -> list[int]:
        bits = 0x8B << 232
        sent_6s = int(self.toe_s - 7200.0 + 6 * number) % int(WEEK_S) // 6
        bits |= sent_6s << (240 - 41) | number << (240 - 46)
        for name, field in LAYOUT[number].items():
            raw = round(self.numbers[name] / field.scale) & ((1 << field.bits) - 1)
            bits |= raw << (240 - field.first - field.bits)
        return [bits >> (240 - 24 * (word + 1)) & 0xFFFFFF for word in range(10)]

    def clock_s(self, tow_s: float) -> float:
        """The satellite's clock's lead, relativity included (20.3.3.3.3.1)."""
        numbers = self.numbers
        since_s = since(tow_s, numbers["toc_s"])
        relativity_s = (
            RELATIVISTIC_S_PER_SQRT_M
            * numbers["e"]
            * numbers["sqrt_a"]
            * math.sin(self._anomaly(tow_s))
        )
        return numbers["f0_s"] + numbers["f1"] * since_s + relativity_s

    def lead_s(self, tow_s: float) -> float:
        """The clock's lead on L1 alone: less the group delay (20.3.3.3.3.2)."""
        return self.clock_s(tow_s) - self.numbers["tgd_s"]

    def place_m(self, tow_s: float) -> tuple[float, float, float]:
        """Earth-fixed, at a second of the week (table 20-IV)."""
        numbers, since_s = self.numbers, since(tow_s, self.toe_s)
        eccentric = self._anomaly(tow_s)
        e, semi_m = numbers["e"], numbers["sqrt_a"] ** 2
        true = math.atan2(math.sqrt(1 - e * e) * math.sin(eccentric), math.cos(eccentric) - e)
        along, radius_m = true + numbers["omega"], semi_m * (1 - e * math.cos(eccentric))
        node = (
            numbers["omega0"]
            + (numbers["omega_dot"] - EARTH_RATE_RADPS) * since_s
            - EARTH_RATE_RADPS * self.toe_s
        )
        x, y = radius_m * math.cos(along), radius_m * math.sin(along)
        tilt = numbers["i0"]
        return (
            x * math.cos(node) - y * math.cos(tilt) * math.sin(node),
            x * math.sin(node) + y * math.cos(tilt) * math.cos(node),
            y * math.sin(tilt),
        )

    def _anomaly(self, tow_s: float) -> float:
        numbers = self.numbers
        rate = math.sqrt(MU_GPS / numbers["sqrt_a"] ** 6) + numbers["deln"]
        mean = numbers["m0"] + rate * since(tow_s, self.toe_s)
        eccentric = mean
        for _ in range(12):
            eccentric = mean + numbers["e"] * math.sin(eccentric)
        return eccentric


def since(tow_s: float, reference_s: float) -> float:
    """Seconds since a time of the week, over the week's end too."""
    return (tow_s - reference_s + HALF_WEEK_S) % WEEK_S - HALF_WEEK_S


def orbit(prn: int, week: int, toe_s: float, **changed: float) -> Orbit:
    """A plausible satellite, another place for every number; `changed` by the layout's names."""
    wanted = {
        "week": week % 1024,
        "health": 0,
        "toc_s": toe_s,
        "f1": 2e-12 * (prn % 5 - 2),
        "f0_s": 1e-5 * (prn - 16),
        "tgd_s": 5e-9 * (prn % 4 - 1),
        "iodc_low": prn,
        "iode": prn,
        "deln": 4.5e-9,
        "m0": wrapped(2.1 * prn),
        "e": 0.01 + 0.0002 * prn,
        "sqrt_a": 5153.7,
        "toe_s": toe_s,
        "omega0": wrapped(math.radians(60.0 * (prn % 6)) + EARTH_RATE_RADPS * toe_s),
        "i0": math.radians(55.0),
        "omega": 0.7,
        "omega_dot": -8.0e-9,
    } | changed
    fields = {name: field for layout in LAYOUT.values() for name, field in layout.items()}
    rounded = {
        name: round(value / fields[name].scale) * fields[name].scale
        for name, value in wanted.items()
    }
    return Orbit(prn, week, toe_s, rounded)


def wrapped(angle_rad: float) -> float:
    """As a signed field holds it."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


def ubx(kind: int, number: int, payload: bytes) -> bytes:
    """A UBX message."""
    body = struct.pack("<BBH", kind, number, len(payload)) + payload
    first = second = 0
    for byte in body:
        first = (first + byte) & 0xFF
        second = (second + first) & 0xFF
    return b"\xb5\x62" + body + bytes((first, second))


def sfrbx(orbit: Orbit) -> bytes:
    """The RXM-SFRBX messages of a satellite's first three subframes."""
    return b"".join(
        ubx(
            0x02,
            0x13,
            struct.pack("<BBBBBBBB", 0, orbit.prn, 0, 0, 10, 0, 2, 0)
            # a word of 30 bits; its parity, which the receiver has checked, is left 0
            + struct.pack("<10I", *(word << 6 for word in words)),
        )
        for words in orbit.subframes()
    )


class Signal(NamedTuple):
    """One signal of an RXM-RAWX."""

    prn: int
    pseudorange_m: float
    doppler_hz: float = 0.0
    gnss: int = 0
    signal: int = 0
    frequency: int = 0
    cn0_dbhz: int = 45
    pseudorange_std: int = 5
    doppler_std: int = 6
    tracking: int = 0x07
    """Bits: pseudorange valid, phase valid, half cycle valid, half cycle subtracted."""
    phase_cycles: float = 1.1e8


def rawx(week: int, tow_s: float, signals: Sequence[Signal], *, state: int = 1) -> bytes:
    """An RXM-RAWX; `state`: bits leap seconds known (18), clock reset."""
    payload = struct.pack("<dHbBBBBB", tow_s, week, 18, len(signals), state, 1, 0, 0)
    for each in signals:
        payload += struct.pack(
            "<ddfBBBBHBBBBBB",
            each.pseudorange_m,
            each.phase_cycles,
            each.doppler_hz,
            each.gnss,
            each.prn,
            each.signal,
            each.frequency,
            1000,
            each.cn0_dbhz,
            each.pseudorange_std,
            4,
            each.doppler_std,
            each.tracking,
            0,
        )
    return ubx(0x02, 0x15, payload)
