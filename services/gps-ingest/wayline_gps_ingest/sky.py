"""Pure: satellites in view (GSV) and in use (GSA) of one epoch."""

from functools import lru_cache
from typing import NamedTuple

import msgspec

from wayline.messages import GpsSky, Satellite
from wayline_gps_ingest.decode import Observation
from wayline_gps_ingest.fields import bearing_deg, count, number, positive

SYSTEMS_BY_TALKER = {
    "GP": "gps",
    "GL": "glonass",
    "GA": "galileo",
    "GB": "beidou",
    "BD": "beidou",
    "GQ": "qzss",
    "QZ": "qzss",
    "PQ": "qzss",
    "GI": "navic",
}
SYSTEMS_BY_ID = {
    "1": "gps",
    "2": "glonass",
    "3": "galileo",
    "4": "beidou",
    "5": "qzss",
    "6": "navic",
}
SYSTEMS_BY_PRN = (
    (1, 32, "gps"),
    (33, 64, "sbas"),
    (65, 96, "glonass"),
    (120, 158, "sbas"),
    (193, 202, "qzss"),
    (203, 264, "beidou"),
    (301, 336, "galileo"),
    (401, 463, "beidou"),
)


SENTENCES_MAX = 64
"""More than a receiver sends an epoch; one that never tells the time must not fill memory."""

Key = tuple[str, int]


class InView(NamedTuple):
    """A satellite in view, ready for either case: its own sentence does not say if it is used."""

    key: Key
    used: Satellite
    unused: Satellite


class Sky:
    """Collects an epoch's GSV and GSA sentences of every constellation, reads them when asked."""

    def __init__(self) -> None:
        self._sentences: list[Observation] = []
        self._used: set[Key] | None = None

    def add(self, observation: Observation) -> None:
        """Take a GSV or GSA sentence."""
        self._used = None
        if len(self._sentences) < SENTENCES_MAX:
            self._sentences.append(observation)

    def merge(self, later: "Sky") -> None:
        """Add what came in a second burst."""
        for observation in later._sentences:
            self.add(observation)

    def used(self) -> set[Key]:
        """System and number of the satellites in use."""
        if self._used is not None:
            return self._used
        keys: set[Key] = set()
        for observation in self._sentences:
            if observation.kind == "GSA":
                fields = observation.fields
                system_id = fields[17] if len(fields) > 17 else ""
                keys |= _used(observation.talker, system_id, tuple(fields[2:14]))
        self._used = keys
        return keys

    def message(self, t_ns: int) -> GpsSky:
        """The satellites in view, by system and number."""
        used, in_view = self.used(), self._in_view()
        satellites = [
            in_view[key].used if key in used else in_view[key].unused for key in sorted(in_view)
        ]
        return GpsSky(t_ns=t_ns, satellites=tuple(satellites))

    def _in_view(self) -> dict[Key, InView]:
        in_view: dict[Key, InView] = {}
        for observation in self._sentences:
            if observation.kind != "GSV":
                continue
            talker, fields = observation.talker, observation.fields
            # four fields a satellite; a signal's id that may follow them is left over
            slots = zip(fields[3::4], fields[4::4], fields[5::4], fields[6::4], strict=False)
            for prn, elevation, azimuth, snr in slots:
                seen = _parsed(talker, prn, elevation, azimuth, snr)
                if seen:
                    known = in_view.setdefault(seen.key, seen)
                    if known is not seen:
                        in_view[seen.key] = _stronger(known, seen)
        return in_view


# receivers use the same satellites for many seconds, and tell of them with the same numbers
@lru_cache(maxsize=1024)
def _used(talker: str, system_id: str, slots: tuple[str, ...]) -> frozenset[Key]:
    keys = (_key(talker, system_id, text) for text in slots)
    return frozenset(key for key in keys if key)


def _key(talker: str, system_id: str, prn: str) -> Key | None:
    number = count(prn)
    return (system_of(talker, system_id, number), number) if number else None


# a satellite hardly moves in a minute, and its signal comes back to the same few whole numbers
@lru_cache(maxsize=4096)
def _parsed(talker: str, prn: str, elevation: str, azimuth: str, snr: str) -> InView | None:
    """A satellite as one sentence tells of it; None for an empty place."""
    key = _key(talker, "", prn)
    if key is None:
        return None
    unused = Satellite(
        system=key[0],
        prn=key[1],
        elevation_deg=_elevation_deg(elevation),
        azimuth_deg=bearing_deg(azimuth),
        snr_dbhz=positive(snr),
    )
    return InView(key, used=msgspec.structs.replace(unused, used=True), unused=unused)


def _stronger(one: InView, other: InView) -> InView:
    """A satellite heard on several signals is listed once a signal: the strongest stands."""
    return other if (one.unused.snr_dbhz or 0.0) < (other.unused.snr_dbhz or 0.0) else one


def _elevation_deg(text: str) -> float | None:
    value = number(text)
    return value if value is not None and -90.0 <= value <= 90.0 else None


def system_of(talker: str, system_id: str, prn: int) -> str:
    """Constellation of a satellite: by the id of NMEA 0183 4.11, the talker, else its number.

    Under GP and GN receivers list satellites of other systems too, told apart by number.
    """
    told = SYSTEMS_BY_ID.get(system_id) or SYSTEMS_BY_TALKER.get(talker)
    if told and told != "gps":
        return told
    by_number = next((name for low, high, name in SYSTEMS_BY_PRN if low <= prn <= high), None)
    return by_number or told or "unknown"
