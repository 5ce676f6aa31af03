"""Pure: what gpsd says of a receiver, in its JSON protocol, as `gps_fix` and `gps_sky`.

gpsd's own reports are read, not the sentences that it passes on: it makes the same ones of every
receiver, those that speak a binary protocol included. Its error estimates (eph, epx, ...) are left
out, because their certainty is not told; dilutions of precision and GST's stds are not.
"""

from collections import Counter
from typing import ClassVar

import msgspec

from wayline.inputs import Flush
from wayline.messages import (
    EARLIEST_NS,
    LATEST_NS,
    SPEED_MAX_MPS,
    GpsFix,
    GpsSky,
    Message,
)
from wayline_gps_ingest.fields import SECOND_NS
from wayline_gps_ingest.gpsd_reports import (
    KINDS,
    Gst,
    Sky,
    Tpv,
    horizontal_std_m,
    read_report,
    time_ns,
    vertical_std_m,
)
from wayline_gps_ingest.gpsd_sky import HELD_NS, GpsdSky
from wayline_gps_ingest.onward_clock import OnwardClock

GONE_NS = 2 * SECOND_NS
"""Another device of the same gpsd is followed when the one before was silent this long."""


class GpsdReport(msgspec.Struct, frozen=True):
    """A line from gpsd, as it came."""

    received_ns: int | None
    text: str


class GpsdCore:
    """One receiver behind gpsd.

    While gpsd does not know yet how a receiver's cycle ends it reports one instant several times;
    as many reports as the last instant had are taken as one, so that nothing waits for the next.
    """

    reads: ClassVar[frozenset[type[Message]]] = frozenset()
    period_ns: ClassVar[int | None] = None

    def __init__(self, gps_latency_s: float = 0.0) -> None:
        self._latency_ns = round(gps_latency_s * SECOND_NS)
        self._clock = OnwardClock()
        self._faults: Counter[str] = Counter()
        self._device = ""
        self._open: Tpv | None = None
        self._reports = self._expected = 0
        self._last_ns = 0
        self._published_ns = 0
        self._sky = GpsdSky()
        self._is_sky_new = False
        self._gst: tuple[int, Gst] | None = None
        self._sky_second: int | None = None

    @property
    def faults(self) -> dict[str, int]:
        """Bad input so far: `report` unreadable, `clock` stepped, `device` another receiver's."""
        counted = {**self._faults, "clock": self._clock.faults}
        return {reason: times for reason, times in counted.items() if times}

    @property
    def bad_input(self) -> int:
        """Reports that were counted and dropped or mended."""
        return sum(self.faults.values())

    def handle(self, message: msgspec.Struct, source: str) -> list[Message]:  # noqa: ARG002 -- one receiver
        """Take a GpsdReport or Flush; return what it completes."""
        if isinstance(message, Flush):
            return self._complete()
        if not isinstance(message, GpsdReport):
            return []
        try:
            report = read_report(message.text)
        except (msgspec.DecodeError, RecursionError):
            self._faults["report"] += 1
            return []
        return self._take(report) if report else []

    def _take(self, report: Tpv | Sky | Gst) -> list[Message]:
        if isinstance(report, Tpv):
            return self._position(report)
        if report.device != self._device:
            return []
        if isinstance(report, Gst):
            self._gst = self._last_ns, report
            return []
        self._sky.take(report, self._last_ns)
        self._is_sky_new = self._is_sky_new or bool(report.satellites)
        is_to_tell = self._published_ns and self._sky.is_whole
        return self._sky_message(self._published_ns) if is_to_tell else []

    def _position(self, report: Tpv) -> list[Message]:
        if report.time is None:
            return []
        t_ns = time_ns(report.time)
        if not EARLIEST_NS + self._latency_ns <= t_ns <= LATEST_NS:
            self._faults["report"] += 1
            return []
        if not self._is_followed(report.device, t_ns):
            return []
        messages: list[Message] = []
        if t_ns != self._last_ns:
            messages += self._complete()
            self._expected, self._reports = self._reports, 0
            self._last_ns, self._open = t_ns, report
        elif self._open:
            self._open = report
        self._reports += 1
        if self._reports >= self._expected:
            messages += self._complete()
        return messages

    def _is_followed(self, device: str, t_ns: int) -> bool:
        """Whether a report is of the receiver that was heard last, or of one in its stead."""
        if device != self._device:
            if self._device and abs(t_ns - self._last_ns) < GONE_NS:
                self._faults["device"] += 1
                return False
            self._device, self._sky, self._gst = device, GpsdSky(), None
            self._is_sky_new = False
        return True

    def _complete(self) -> list[Message]:
        """The open instant as a fix."""
        report, self._open = self._open, None
        if report is None:
            return []
        raw_ns = self._last_ns - self._latency_ns
        is_valid = report.mode >= 2 and _is_on_earth(report.lat, report.lon)
        clock = self._clock
        t_ns = clock.fixed_ns(raw_ns) if is_valid else clock.unfixed_ns(raw_ns)
        if t_ns is None or t_ns > LATEST_NS:
            return []
        fix = self._fix(report, t_ns) if is_valid else self._unfixed(t_ns)
        self._published_ns = t_ns
        return [fix, *self._sky_message(t_ns)]

    def _fix(self, report: Tpv, t_ns: int) -> GpsFix:
        gst = self._held_gst()
        speed_mps, course_deg = report.speed, report.track
        return msgspec.structs.replace(
            self._unfixed(t_ns),
            valid=True,
            lat_deg=report.lat,
            lon_deg=report.lon,
            alt_m=report.alt_m,
            geoid_sep_m=report.geoid_sep,
            speed_mps=speed_mps if _is_a_vehicles(speed_mps) else None,
            course_deg=course_deg % 360.0 if course_deg is not None else None,
            mode=3 if report.mode == 3 else 2,
            fix=KINDS.get(report.status, "gps"),
            h_std_m=horizontal_std_m(gst) if gst else None,
            v_std_m=vertical_std_m(gst) if gst else None,
        )

    def _unfixed(self, t_ns: int) -> GpsFix:
        """What is known of an instant without a position."""
        hdop, pdop, vdop = self._sky.dilutions(self._last_ns)
        return GpsFix(
            t_ns=t_ns,
            valid=False,
            satellites=self._sky.used(self._last_ns),
            hdop=hdop,
            pdop=pdop,
            vdop=vdop,
        )

    def _held_gst(self) -> Gst | None:
        """What was told beside an earlier instant, while it is not too old."""
        if self._gst is None or not 0 <= self._last_ns - self._gst[0] <= HELD_NS:
            return None
        return self._gst[1]

    def _sky_message(self, t_ns: int) -> list[Message]:
        """What is new of the sky, once in a whole second, whatever the receiver's rate."""
        if not self._is_sky_new or t_ns // SECOND_NS == self._sky_second:
            return []
        self._sky_second, self._is_sky_new = t_ns // SECOND_NS, False
        return [GpsSky(t_ns=t_ns, satellites=self._sky.satellites)]


def _is_a_vehicles(speed_mps: float | None) -> bool:
    return speed_mps is not None and 0.0 <= speed_mps <= SPEED_MAX_MPS


def _is_on_earth(lat_deg: float | None, lon_deg: float | None) -> bool:
    """0 north 0 east is what receivers say that do not know."""
    if lat_deg is None or lon_deg is None or lat_deg == lon_deg == 0.0:
        return False
    return abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0
