"""Pure: what each sentence says, in SI units and degrees.

Field numbers follow NMEA 0183 4.11 with the address left out; old receivers send fewer fields.
"""

import datetime as dt
from collections.abc import Callable, Sequence
from typing import Literal, TypedDict

import msgspec

from wayline.messages import SPEED_MAX_MPS, STD_MAX, FixKind
from wayline_gps_ingest.dates import instant_of
from wayline_gps_ingest.fields import (
    M_PER_FOOT,
    MPS_PER_KMPH,
    MPS_PER_KNOT,
    BadFieldError,
    bearing_deg,
    count,
    date_of,
    dilution,
    latitude_deg,
    longitude_deg,
    not_negative,
    number,
    positive,
    time_of_day_ns,
)
from wayline_gps_ingest.parsing import Parsed

ALTITUDE_MIN_M = -1000.0
"""Below any road; receivers write -5400 m and the like for unknown."""
BLANKS = [""] * 20
QUALITY: dict[str, FixKind] = {
    "1": "gps",
    "2": "dgps",
    "3": "gps",
    "4": "rtk_fixed",
    "5": "rtk_float",
    "6": "dead_reckoning",
    "7": "manual",
    "8": "simulator",
    "9": "dgps",
}
MODES: dict[str, FixKind] = {
    "A": "gps",
    "P": "gps",
    "D": "dgps",
    "F": "rtk_float",
    "R": "rtk_fixed",
    "E": "dead_reckoning",
    "M": "manual",
    "S": "simulator",
}
BEST_FIRST = "RFDPAEMS"
NO_FIX = "N"
QUALITIES = frozenset(("", *"0123456789"))
STATUSES = frozenset(("", "A", "D", "V"))
METRES = frozenset(("", "M", "m"))
"""What these fields may hold; where one holds something else, fields before it are missing."""


class Facts(TypedDict, total=False):
    """What is known of an epoch; a key is absent where nothing was said of it."""

    dated_ns: int
    """Unix time of the sentence that carried a date."""
    gga_valid: bool
    gns_valid: bool
    rmc_valid: bool
    gll_valid: bool
    lat_deg: float
    lon_deg: float
    alt_m: float
    other_alt_m: float
    """Coarser than the one beside the position, for want of that."""
    geoid_sep_m: float
    speed_mps: float
    course_deg: float
    gsa_mode: int
    quality: FixKind
    mode_fix: FixKind
    satellites: int
    hdop: float
    pdop: float
    vdop: float
    h_std_m: float
    v_std_m: float


NOTHING = Facts()
"""Of a sentence of satellites; nobody may add to it."""


class Observation(msgspec.Struct, frozen=True):
    """One sentence, read. `key` tells it from the others of its receiver's cycle."""

    key: str
    kind: str
    time_ns: int | None
    """Since midnight UTC; None for kinds without time."""
    facts: Facts
    fields: Sequence[str] = ()
    """Of GSA and GSV, for the sky."""
    talker: str = ""
    is_whole_s: bool = False
    """Whether its time was told without decimals."""


def decode(parsed: Parsed) -> Observation:
    """What a sentence says. Raises BadFieldError where its time, date or position is no such."""
    return DECODERS[parsed.kind](parsed, parsed.fields + BLANKS)


def _gga(parsed: Parsed, fields: list[str]) -> Observation:
    if fields[5] not in QUALITIES or fields[9] not in METRES:
        raise BadFieldError(f"{fields[5]} {fields[9]}")
    quality = QUALITY.get(fields[5])
    facts = _position(fields[1:5], valid=quality is not None)
    facts["gga_valid"] = "lat_deg" in facts
    if quality:
        facts["quality"] = quality
    _levels(facts, satellites=fields[6], hdop=fields[7], alt_m=fields[8], sep_m=fields[10])
    return _timed(parsed, fields[0], facts)


def _gns(parsed: Parsed, fields: list[str]) -> Observation:
    best = next((mode for mode in BEST_FIRST if mode in fields[5]), None)
    facts = _position(fields[1:5], valid=best is not None)
    facts["gns_valid"] = "lat_deg" in facts
    if best:
        facts["quality"] = MODES[best]
    _levels(facts, satellites=fields[6], hdop=fields[7], alt_m=fields[8], sep_m=fields[9])
    if parsed.talker != "GN" and not fields[5]:
        # beside the GNGNS that has the position, one a constellation tells only its corrections
        facts = Facts()
    return _timed(parsed, fields[0], facts)


def _rmc(parsed: Parsed, fields: list[str]) -> Observation:
    is_active = fields[1] in ("A", "D")
    if not is_active and fields[1] not in STATUSES:
        raise BadFieldError(fields[1])
    facts = _position(fields[2:6], valid=is_active and fields[11] != NO_FIX)
    facts["rmc_valid"] = "lat_deg" in facts
    _motion(facts, not_negative(fields[6]), MPS_PER_KNOT, fields[7])
    if fields[11] in MODES:
        facts["mode_fix"] = MODES[fields[11]]
    date = fields[8]
    return _timed(parsed, fields[0], facts, date_of(date[:2], date[2:4], date[4:]))


def _gll(parsed: Parsed, fields: list[str]) -> Observation:
    # before NMEA 0183 2.0 a position was sent without a status
    if fields[5] not in STATUSES:
        raise BadFieldError(fields[5])
    is_active = fields[5] == "A" or len(parsed.fields) < 6
    facts = _position(fields[0:4], valid=is_active and fields[6] != NO_FIX)
    facts["gll_valid"] = "lat_deg" in facts
    if fields[6] in MODES:
        facts["mode_fix"] = MODES[fields[6]]
    return _timed(parsed, fields[4], facts)


def _vtg(parsed: Parsed, fields: list[str]) -> Observation:
    facts = Facts()
    key = f"{parsed.talker}VTG"
    if fields[8] == "N":
        return Observation(key, "VTG", None, facts)
    # before NMEA 0183 2.0 the letters of the units were not sent
    knots, kmph = (fields[4], fields[6]) if fields[1] in ("T", "") else (fields[2], fields[3])
    speed_knots = not_negative(knots)
    if speed_knots is not None:
        _motion(facts, speed_knots, MPS_PER_KNOT, fields[0])
    else:
        _motion(facts, not_negative(kmph), MPS_PER_KMPH, fields[0])
    return Observation(key, "VTG", None, facts)


def _gsa(parsed: Parsed, fields: list[str]) -> Observation:
    facts = Facts()
    if fields[1] in ("1", "2", "3"):
        facts["gsa_mode"] = int(fields[1])
    dilutions: tuple[tuple[Literal["pdop", "hdop", "vdop"], str], ...] = (
        ("pdop", fields[14]),
        ("hdop", fields[15]),
        ("vdop", fields[16]),
    )
    for name, text in dilutions:
        value = dilution(text)
        if value is not None:
            facts[name] = value
    key = f"{parsed.talker}GSA{fields[17][:1]}"
    return Observation(key, "GSA", None, facts, parsed.fields, parsed.talker)


def _gsv(parsed: Parsed, fields: list[str]) -> Observation:
    # four fields a satellite, and since NMEA 0183 4.10 the signal
    has_signal = len(parsed.fields) > 3 and len(parsed.fields) % 4 == 0
    signal = parsed.fields[-1][:1] if has_signal else ""
    end = "" if fields[0] == fields[1] else "+"
    key = parsed.talker + "GSV" + signal + end
    return Observation(key, "GSV", None, NOTHING, parsed.fields, parsed.talker)


def _gst(parsed: Parsed, fields: list[str]) -> Observation:
    facts = Facts()
    lat_m, lon_m, alt_m = (positive(text) for text in fields[5:8])
    if lat_m is not None and lon_m is not None and max(lat_m, lon_m) <= STD_MAX:
        facts["h_std_m"] = ((lat_m**2 + lon_m**2) / 2.0) ** 0.5
    if alt_m is not None and alt_m <= STD_MAX:
        facts["v_std_m"] = alt_m
    return _timed(parsed, fields[0], facts)


def _zda(parsed: Parsed, fields: list[str]) -> Observation:
    return _timed(parsed, fields[0], Facts(), date_of(*fields[1:4]))


def _rmz(parsed: Parsed, fields: list[str]) -> Observation:
    """Garmin's altitude above mean sea level in whole feet; dimension 2 has it from the user."""
    facts = Facts()
    altitude_ft = number(fields[0])
    if altitude_ft is not None and fields[1] in ("f", "F") and fields[2] == "3":
        facts["other_alt_m"] = altitude_ft * M_PER_FOOT
    return Observation("PGRMZ", parsed.kind, None, facts)


DECODERS: dict[str, Callable[[Parsed, list[str]], Observation]] = {
    "GGA": _gga,
    "GNS": _gns,
    "RMC": _rmc,
    "GLL": _gll,
    "VTG": _vtg,
    "GSA": _gsa,
    "GSV": _gsv,
    "GST": _gst,
    "ZDA": _zda,
    "RMZ": _rmz,
}


def _timed(parsed: Parsed, time: str, facts: Facts, day: dt.date | None = None) -> Observation:
    """What a sentence with a time of day, maybe of a day, says."""
    time_ns = time_of_day_ns(time)
    # year 1980 is a cold receiver's clock before it has heard the time
    if day and day.year > 1980:
        facts["dated_ns"] = instant_of(day, time_ns)
    key = parsed.talker + parsed.kind
    return Observation(key, parsed.kind, time_ns, facts, (), "", "." not in time)


def _position(fields: Sequence[str], *, valid: bool) -> Facts:
    """Nothing where the receiver has no fix: it fills the fields with its last one or anything."""
    if not valid:
        return Facts()
    lat_deg = latitude_deg(fields[0], fields[1])
    lon_deg = longitude_deg(fields[2], fields[3])
    if lat_deg is None or lon_deg is None or lat_deg == lon_deg == 0.0:
        # 0 north 0 east is what receivers write for unknown
        return Facts()
    return Facts(lat_deg=lat_deg, lon_deg=lon_deg)


def _levels(facts: Facts, *, satellites: str, hdop: str, alt_m: str, sep_m: str) -> None:
    used, horizontal = count(satellites), dilution(hdop)
    if used is not None:
        facts["satellites"] = used
    if horizontal is not None:
        facts["hdop"] = horizontal
    altitude_m, separation_m = number(alt_m), number(sep_m)
    if altitude_m is not None and altitude_m > ALTITUDE_MIN_M:
        facts["alt_m"] = altitude_m
    if separation_m is not None:
        facts["geoid_sep_m"] = separation_m


def _motion(facts: Facts, speed: float | None, mps_per_unit: float, course: str) -> None:
    course_deg = bearing_deg(course)
    if speed is not None and speed * mps_per_unit <= SPEED_MAX_MPS:
        facts["speed_mps"] = speed * mps_per_unit
    if course_deg is not None:
        facts["course_deg"] = course_deg
