"""Pure: satellites in view (GSV) and in use (GSA) of one epoch."""

from collections.abc import Iterator, Sequence
from functools import lru_cache

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


class Sky:
    """Collects an epoch's GSV and GSA sentences of every constellation, reads them when asked."""

    def __init__(self) -> None:
        self._sentences: list[Observation] = []

    def add(self, observation: Observation) -> None:
        """Take a GSV or GSA sentence."""
        if len(self._sentences) < SENTENCES_MAX:
            self._sentences.append(observation)

    def merge(self, later: "Sky") -> None:
        """Add what came in a second burst."""
        for observation in later._sentences:
            self.add(observation)

    def used(self) -> set[Key]:
        """System and number of the satellites in use."""
        keys: set[Key] = set()
        for observation in self._sentences:
            if observation.kind == "GSA":
                fields = observation.fields
                system_id = fields[17] if len(fields) > 17 else ""
                keys |= _used(observation.talker, system_id, tuple(fields[2:14]))
        return keys

    def message(self, t_ns: int) -> GpsSky:
        """The satellites in view, by system and number."""
        used = self.used()
        in_view: dict[Key, Satellite] = {}
        for observation in self._sentences:
            if observation.kind == "GSV":
                for key, satellite in _in_view(observation.talker, observation.fields, used):
                    known = in_view.setdefault(key, satellite)
                    if known is not satellite:
                        in_view[key] = _stronger(known, satellite)
        return GpsSky(t_ns=t_ns, satellites=tuple(in_view[key] for key in sorted(in_view)))


# receivers use the same satellites for many seconds, and tell of them with the same numbers
@lru_cache(maxsize=1024)
def _used(talker: str, system_id: str, slots: tuple[str, ...]) -> frozenset[Key]:
    keys = (_key(talker, system_id, text) for text in slots)
    return frozenset(key for key in keys if key)


def _in_view(talker: str, fields: Sequence[str], used: set[Key]) -> Iterator[tuple[Key, Satellite]]:
    for start in range(3, len(fields) - 3, 4):
        key = _key(talker, "", fields[start])
        if key:
            yield key, _satellite(key, *fields[start + 1 : start + 4], key in used)


@lru_cache(maxsize=1024)
def _key(talker: str, system_id: str, prn: str) -> Key | None:
    number = count(prn)
    return (system_of(talker, system_id, number), number) if number else None


@lru_cache(maxsize=4096)
def _satellite(key: Key, elevation: str, azimuth: str, snr: str, used: bool) -> Satellite:
    system, prn = key
    return Satellite(
        system=system,
        prn=prn,
        elevation_deg=_elevation_deg(elevation),
        azimuth_deg=bearing_deg(azimuth),
        snr_dbhz=positive(snr),
        used=used,
    )


def _stronger(one: Satellite, other: Satellite) -> Satellite:
    """A satellite heard on several signals is listed once a signal: the strongest stands."""
    return other if (one.snr_dbhz or 0.0) < (other.snr_dbhz or 0.0) else one


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
