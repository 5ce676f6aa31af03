"""Pure: satellites in view (GSV) and in use (GSA) of one epoch."""

from collections.abc import Sequence

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


class Sky:
    """Collects an epoch's GSV and GSA sentences of every constellation."""

    def __init__(self) -> None:
        self._in_view: dict[tuple[str, int], Satellite] = {}
        self._used: set[tuple[str, int]] = set()

    @property
    def used_count(self) -> int:
        """Satellites in use."""
        return len(self._used)

    def add(self, observation: Observation) -> None:
        """Take a GSV or GSA sentence."""
        if observation.kind == "GSA":
            self._add_used(observation.talker, observation.fields)
        else:
            self._add_in_view(observation.talker, observation.fields)

    def merge(self, later: "Sky") -> None:
        """Add what came in a second burst."""
        self._in_view |= later._in_view
        self._used |= later._used

    def message(self, t_ns: int) -> GpsSky:
        """The satellites in view, by system and number."""
        used = self._used
        return GpsSky(
            t_ns=t_ns,
            satellites=tuple(
                Satellite(
                    system=satellite.system,
                    prn=satellite.prn,
                    elevation_deg=satellite.elevation_deg,
                    azimuth_deg=satellite.azimuth_deg,
                    snr_dbhz=satellite.snr_dbhz,
                    used=key in used,
                )
                for key, satellite in sorted(self._in_view.items())
            ),
        )

    def _add_used(self, talker: str, fields: Sequence[str]) -> None:
        system_id = fields[17] if len(fields) > 17 else ""
        for text in fields[2:14]:
            prn = count(text)
            if prn:
                self._used.add((system_of(talker, system_id, prn), prn))

    def _add_in_view(self, talker: str, fields: Sequence[str]) -> None:
        for start in range(3, len(fields) - 3, 4):
            prn = count(fields[start])
            if prn:
                self._see(system_of(talker, "", prn), prn, fields[start + 1 : start + 4])

    def _see(self, system: str, prn: int, fields: Sequence[str]) -> None:
        elevation_deg = number(fields[0])
        if elevation_deg is not None and not -90.0 <= elevation_deg <= 90.0:
            elevation_deg = None
        snr_dbhz = positive(fields[2])
        known = self._in_view.get((system, prn))
        # a satellite heard on several signals is listed once a signal
        if known and (known.snr_dbhz or 0.0) >= (snr_dbhz or 0.0):
            return
        self._in_view[system, prn] = Satellite(
            system=system,
            prn=prn,
            elevation_deg=elevation_deg,
            azimuth_deg=bearing_deg(fields[1]),
            snr_dbhz=snr_dbhz,
        )


def system_of(talker: str, system_id: str, prn: int) -> str:
    """Constellation of a satellite: by the id of NMEA 0183 4.11, the talker, else its number."""
    system = SYSTEMS_BY_ID.get(system_id) or SYSTEMS_BY_TALKER.get(talker)
    if system == "gps" or system is None:
        by_number = next((name for low, high, name in SYSTEMS_BY_PRN if low <= prn <= high), None)
        return by_number or system or "unknown"
    return system
