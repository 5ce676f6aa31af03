"""Pure: one line into address and fields, by pynmea2, its checksum verified.

pynmea2 is asked only for framing and checksum. Its converted fields are not used: they turn an
unreadable number into text, a position without hemisphere into 0 degrees, refuse minutes without
decimals, and cost more than the parsing itself.
"""

import re
from functools import lru_cache, reduce
from operator import xor
from typing import Literal

import msgspec
import pynmea2

Fault = Literal["checksum", "malformed", "torn"]

KINDS = frozenset(("GGA", "RMC", "GSA", "GSV", "GST", "VTG", "GLL", "GNS", "ZDA"))
PROPRIETARY = {"PGRMZ": ("PG", "RMZ"), "PQGSV": ("PQ", "GSV")}
"""Talker and kind of proprietary sentences: Garmin's altitude, Quectel's satellites of QZSS."""
FIELDS_MIN = {
    "GGA": 10,
    "RMC": 9,
    "GLL": 4,
    "GNS": 9,
    "GST": 8,
    "VTG": 4,
    "ZDA": 4,
    "GSA": 16,
    "GSV": 3,
    "RMZ": 2,
}
"""Fields that a whole sentence has; the checksum of a part of one may be right by chance."""
ADDRESS = re.compile(r"[$!]([A-Z0-9]{2}[A-Z0-9.]*)[,*]")
HEAD = len("$GPGGA,")
"""Of every sentence that is read; the proprietary ones have as many letters."""
CHECKED = re.compile(r"[$!]([^*]*)\*([0-9A-Fa-f]{2})")


class Parsed(msgspec.Struct, frozen=True):
    """A sentence's talker (`GP`), kind (`GGA`), fields and whether a checksum vouches for them."""

    talker: str
    kind: str
    fields: list[str]
    checked: bool


def parse(text: str) -> Parsed | Fault | None:
    """A sentence that gps-ingest reads, why it cannot be read, or None for one of no interest."""
    start = text.rfind("$")
    text = (text[start:] if start > 0 else text).rstrip()
    known = _known(text[:HEAD])
    if known is None:
        return _unread(text)
    try:
        sentence = pynmea2.parse(text)
    except pynmea2.ChecksumError:
        return "checksum"
    except pynmea2.ParseError:
        return "malformed" if _checksum_holds(text) else "checksum"
    checked = "*" in text
    # of a proprietary sentence pynmea2 takes the last letters of the address for a field
    talker, kind, is_proprietary = known
    fields = sentence.data[1:] if is_proprietary else sentence.data
    if len(fields) < FIELDS_MIN[kind]:
        return "torn"
    if " " in text:
        # columns of fixed width
        fields = [field.strip() for field in fields]
    return Parsed(talker, kind, fields, checked)


# a receiver has a dozen addresses and says them many times a second
@lru_cache(maxsize=256)
def _known(head: str) -> tuple[str, str, bool] | None:
    """Talker, kind and whether it is proprietary, of an address that gps-ingest reads."""
    found = ADDRESS.match(head)
    if found is None or head[0] != "$":
        return None
    address = found[1]
    if address in PROPRIETARY:
        return (*PROPRIETARY[address], True)
    if len(address) == 5 and address[2:] in KINDS and address[0] != "P":
        return address[:2], address[2:], False
    return None


def _unread(text: str) -> Fault | None:
    """What is wrong with a sentence that is not read, if anything."""
    if not ADDRESS.match(text):
        return "malformed"
    return None if _checksum_holds(text) else "checksum"


def _checksum_holds(text: str) -> bool:
    """Whether the checksum is right or not given; a wrong one counts whatever the sentence."""
    found = CHECKED.match(text)
    if not found:
        return True
    return reduce(xor, map(ord, found[1]), 0) == int(found[2], 16)
