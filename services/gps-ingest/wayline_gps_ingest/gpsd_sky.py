"""Pure: what gpsd's SKY reports say together; newer ones tell of one sky in several."""

from typing import NamedTuple

from wayline.messages import Satellite
from wayline_gps_ingest.gpsd_reports import Sky, SkyView, satellite_of, time_ns

HELD_NS = 10_000_000_000
"""The sky is told apart from the fix, by some receivers every 5 s: so long it stands beside it."""

Key = tuple[int | None, int]


class Dilutions(NamedTuple):
    """Of precision, each None where it is not known."""

    hdop: float | None = None
    pdop: float | None = None
    vdop: float | None = None


class GpsdSky:
    """Satellites and dilutions, each as last told.

    A report with some satellites of a sky adds to those that were told of the same time; one that
    tells of a satellite again, or of another time, begins anew.
    """

    def __init__(self) -> None:
        self._listed_ns = self._used_ns = self._dilutions_ns = 0
        self._views: dict[Key, SkyView] = {}
        self._seen = 0
        self._used: int | None = None
        self._dilutions = Dilutions()

    def take(self, sky: Sky, fix_ns: int) -> None:
        """A report that came after the fix of an instant."""
        told_ns = fix_ns if sky.time is None else time_ns(sky.time)
        views = {(view.gnssid, view.prn): view for view in sky.satellites}
        if views:
            if told_ns != self._listed_ns or not self._views.keys().isdisjoint(views):
                self._views = {}
            self._views |= views
            self._seen, self._listed_ns = sky.seen or 0, told_ns
        if sky.used is not None:
            self._used, self._used_ns = sky.used, told_ns
        told = Dilutions(sky.hdop, sky.pdop, sky.vdop)
        if told != Dilutions():
            self._dilutions, self._dilutions_ns = told, told_ns

    def used(self, fix_ns: int) -> int | None:
        """Satellites in use at an instant: as counted by gpsd, else as listed; None if unknown."""
        if self._used is not None and self._used_ns >= self._listed_ns:
            return self._used if _is_recent(self._used_ns, fix_ns) else None
        if not self._views or not _is_recent(self._listed_ns, fix_ns):
            return None
        return sum(view.used for view in self._views.values())

    def dilutions(self, fix_ns: int) -> Dilutions:
        """Those that hold at an instant."""
        return self._dilutions if _is_recent(self._dilutions_ns, fix_ns) else Dilutions()

    @property
    def is_whole(self) -> bool:
        """Whether as many satellites were told as there are said to be."""
        return len(self._views) >= self._seen

    @property
    def satellites(self) -> tuple[Satellite, ...]:
        """Those in view, in the order of the reports."""
        return tuple(map(satellite_of, self._views.values()))


def _is_recent(told_ns: int, now_ns: int) -> bool:
    return abs(now_ns - told_ns) <= HELD_NS
