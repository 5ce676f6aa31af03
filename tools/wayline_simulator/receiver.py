"""Pure: the sentences that a receiver makes of its fixes."""

import datetime as dt
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from wayline_simulator.gps import Fixes
from wayline_simulator.gps_model import GpsModel, SentenceKind
from wayline_simulator.gps_sky import DILUTION_MAX, View
from wayline_simulator.nmea_text import KMPH_PER_MPS, course, knots, place, sentence, utc
from wayline_simulator.stream import TimedLine

GEOID_SEP_M = 46.3
"""Of Munich: receivers carry a coarse table of it; a constant keeps altitude what it is."""
BITS_PER_BYTE = 10
"""On a serial line, start and stop bit included."""
LINE_END_BYTES = 2
LISTED_MAX = 12
"""Satellites that a GSA has room for, and the most that a GGA counts to (NMEA 0183)."""
SATELLITES_PER_GSV = 4
STD_MAX_M = 999.0
SYSTEM_TALKERS = {"gps": "GP", "glonass": "GL", "galileo": "GA"}
SYSTEM_IDS = {"gps": 1, "glonass": 2, "galileo": 3}
"""NMEA 0183 4.11, table of GNSS system ids."""


class Epoch(NamedTuple):
    """One fix, its numbers unpacked."""

    clock: str
    date: dt.date
    valid: bool
    mode: int
    place: str
    alt_m: float
    speed_mps: float
    course_deg: float
    h_std_m: float
    v_std_m: float
    dilutions: tuple[float, float, float]
    """PDOP, HDOP, VDOP"""
    row: int
    """Of the view; -1 without a sky."""


class Sky:
    """GSA and GSV of a receiver; they change once a second, so the last ones are kept."""

    def __init__(self, view: View, model: GpsModel) -> None:
        self._view = view
        self._systems = model.systems
        self._several = len(model.systems) > 1
        self._row = -2
        self._in_view: list[str] = []

    def used(self, row: int) -> int:
        """Satellites in use."""
        return int(np.count_nonzero(self._view.used[row])) if row >= 0 else 0

    def gsa(self, epoch: Epoch) -> Iterator[str]:
        """One a constellation, where there are several."""
        dilutions = ",".join(f"{value:.2f}" for value in epoch.dilutions)
        for number, system in enumerate(self._systems):
            prns: list[str] = []
            if epoch.valid:
                here = self._view.used[epoch.row] & (self._view.systems == number)
                prns = [f"{prn:02d}" for prn in self._view.prns[here][:LISTED_MAX]]
            slots = ",".join(prns + [""] * (LISTED_MAX - len(prns)))
            end = f",{SYSTEM_IDS[system]}" if self._several else ""
            talker = "GN" if self._several else SYSTEM_TALKERS[system]
            yield f"{talker}GSA,A,{epoch.mode},{slots},{dilutions}{end}"

    def gsv(self, epoch: Epoch) -> list[str]:
        """GSV sentences of all satellites above the horizon, as the receiver's almanac has them."""
        if epoch.row != self._row:
            self._row = epoch.row
            self._in_view = [
                body
                for number, system in enumerate(self._systems)
                for body in self._of_system(number, SYSTEM_TALKERS[system])
            ]
        return self._in_view

    def _of_system(self, number: int, talker: str) -> Iterator[str]:
        satellites = self._listed(number) if self._row >= 0 else []
        pages = max(-(-len(satellites) // SATELLITES_PER_GSV), 1)
        end = ",1" if self._several else ""
        for page in range(pages):
            listed = satellites[page * SATELLITES_PER_GSV : (page + 1) * SATELLITES_PER_GSV]
            text = "".join(f",{satellite}" for satellite in listed)
            yield f"{talker}GSV,{pages},{page + 1},{len(satellites):02d}{text}{end}"

    def _listed(self, number: int) -> list[str]:
        view, row = self._view, self._row
        above = np.flatnonzero((view.systems == number) & (view.elevations_deg[row] >= 0.0))
        columns = (view.prns, view.elevations_deg[row], view.azimuths_deg[row])
        prns, elevations_deg, azimuths_deg = (column[above].tolist() for column in columns)
        strengths = [f"{value:02.0f}" if value else "" for value in view.strengths_dbhz[row, above]]
        return [
            f"{prn:02d},{elevation:02.0f},{round(azimuth) % 360:03d},{strength}"
            for prn, elevation, azimuth, strength in zip(
                prns, elevations_deg, azimuths_deg, strengths, strict=True
            )
        ]


class Writer:
    """Writes epochs as one receiver's sentences, `$` and checksum left out."""

    def __init__(self, view: View, model: GpsModel) -> None:
        self._talker = "GN" if len(model.systems) > 1 else SYSTEM_TALKERS[model.systems[0]]
        self._sky = Sky(view, model)
        self._kinds = model.sentences
        self._bodies: dict[SentenceKind, Callable[[Epoch], list[str]]] = {
            "RMC": lambda epoch: [self._rmc(epoch)],
            "GGA": lambda epoch: [self._gga(epoch)],
            "GSA": lambda epoch: list(self._sky.gsa(epoch)),
            "GSV": self._sky.gsv,
            "GST": lambda epoch: [self._gst(epoch)],
            "VTG": lambda epoch: [self._vtg(epoch)],
            "ZDA": lambda epoch: [self._zda(epoch)],
        }

    def bodies(self, epoch: Epoch) -> Iterator[str]:
        """An epoch's sentences in the receiver's order."""
        for kind in self._kinds:
            yield from self._bodies[kind](epoch)

    def _rmc(self, epoch: Epoch) -> str:
        date = f"{epoch.date:%d%m%y}"
        if not epoch.valid:
            return f"{self._talker}RMC,{epoch.clock},V,,,,,,,{date},,,N"
        motion = f"{knots(epoch.speed_mps)},{course(epoch.course_deg)}"
        return f"{self._talker}RMC,{epoch.clock},A,{epoch.place},{motion},{date},,,A"

    def _gga(self, epoch: Epoch) -> str:
        head = f"{self._talker}GGA,{epoch.clock}"
        _, hdop, _ = epoch.dilutions
        if not epoch.valid:
            return f"{head},,,,,0,00,{hdop:.2f},,,,,,"
        used = min(self._sky.used(epoch.row), LISTED_MAX)
        heights = f"{epoch.alt_m:.1f},M,{GEOID_SEP_M},M"
        return f"{head},{epoch.place},1,{used:02d},{hdop:.2f},{heights},,"

    def _gst(self, epoch: Epoch) -> str:
        head = f"{self._talker}GST,{epoch.clock}"
        if not epoch.valid:
            return f"{head},,,,,,,"
        h_m, v_m = min(epoch.h_std_m, STD_MAX_M), min(epoch.v_std_m, STD_MAX_M)
        # errors are alike in all directions: the ellipse is a circle
        return f"{head},{h_m:.1f},{h_m:.1f},{h_m:.1f},0.0,{h_m:.1f},{h_m:.1f},{v_m:.1f}"

    def _vtg(self, epoch: Epoch) -> str:
        if not epoch.valid:
            return f"{self._talker}VTG,,T,,M,,N,,K,N"
        kmph = f"{epoch.speed_mps * KMPH_PER_MPS:.2f}"
        head = f"{self._talker}VTG,{course(epoch.course_deg)},T,,M"
        return f"{head},{knots(epoch.speed_mps)},N,{kmph},K,A"

    def _zda(self, epoch: Epoch) -> str:
        return f"{self._talker}ZDA,{epoch.clock},{epoch.date:%d,%m,%Y},00,00"


def nmea_lines(fixes: Fixes, model: GpsModel) -> Iterator[TimedLine]:
    """A receiver's sentences in order of arrival, each as late as its serial line makes it."""
    writer = Writer(fixes.view, model)
    byte_s = BITS_PER_BYTE / model.baud_bps
    free_s = 0.0
    for arrival_s, epoch in zip(fixes.arrivals_s.tolist(), _epochs(fixes, model), strict=True):
        free_s = max(free_s, arrival_s)
        for body in writer.bodies(epoch):
            text = sentence(body)
            yield TimedLine(free_s, text)
            free_s += (len(text) + LINE_END_BYTES) * byte_s


def _epochs(fixes: Fixes, model: GpsModel) -> Iterator[Epoch]:
    unknown = (DILUTION_MAX, DILUTION_MAX, DILUTION_MAX)
    # numbers of Python's own are quicker to write than numpy's
    clocks = [utc(time_s) for time_s in fixes.timestamps_s.tolist()]
    lats_deg, lons_deg = fixes.lats_deg.tolist(), fixes.lons_deg.tolist()
    alts_m, speeds_mps = fixes.alts_m.tolist(), fixes.speeds_mps.tolist()
    h_stds_m, v_stds_m = fixes.h_std_m.tolist(), fixes.v_std_m.tolist()
    dilutions = list(
        zip(fixes.pdop.tolist(), fixes.hdop.tolist(), fixes.vdop.tolist(), strict=True)
    )
    for index, (clock, date) in enumerate(clocks):
        valid = bool(fixes.valid[index])
        yield Epoch(
            clock=clock,
            date=date,
            valid=valid,
            mode=int(fixes.mode[index]),
            place=place(lats_deg[index], lons_deg[index], model.minute_decimals),
            alt_m=alts_m[index],
            speed_mps=speeds_mps[index],
            course_deg=float(fixes.courses_deg[index]),
            h_std_m=h_stds_m[index],
            v_std_m=v_stds_m[index],
            dilutions=dilutions[index] if valid else unknown,
            row=int(fixes.rows[index]) if fixes.sky_seen[index] else -1,
        )
