"""The receivers and position reports of a recorded drive, as bus messages."""

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path

from wayline.avl_log import read_reports
from wayline.drive import AvlSource, Drive, NmeaSource, Vehicle
from wayline.errors import InputError
from wayline.inputs import PositionReport
from wayline.nmea_log import NmeaLog, gpsd_lines, has_date, has_sentence, is_gpsd_log
from wayline.received import Recording, source_names, translated
from wayline.text_file import TextFile
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.gpsd import GpsdCore, GpsdReport

READABLE = "give a receiver's log of GGA, RMC, GLL, GNS or the like, as it came from the line"


def recordings(drive: Drive, where: str) -> list[Recording]:
    """Every `[[nmea]]` and `[[avl]]` of a drive, in that order. Raises InputError."""
    del where  # what is wrong with them is in their own files
    names = source_names("gps-ingest")
    return [
        *(_receiver(nmea, drive.vehicle, next(names)) for nmea in drive.nmea),
        *(_reports(avl, drive.vehicle, next(names)) for avl in drive.avl),
    ]


def _receiver(source: NmeaSource, vehicle: Vehicle, name: str) -> Recording:
    path = Path(source.path)
    nothing = partial(_nothing_received, source.path)
    if is_gpsd_log(path):
        return _gpsd(path, vehicle, name)
    if not has_sentence(path):
        return Recording(name, (), lambda: 0, nothing=nothing)
    if source.date is None and not has_date(path):
        mend = "add date = YYYY-MM-DD to its [[nmea]]"
        raise InputError(str(path), "no sentence carries a date", mend)
    core = GpsIngestCore(vehicle.gps_latency_s, source.date)
    latency_ns = round(vehicle.gps_latency_s * 1e9)
    log = NmeaLog(path)
    messages = translated(
        log,
        core.handle,
        name,
        lambda sentence, message: (
            message.t_ns + latency_ns if sentence.received_ns is None else sentence.received_ns
        ),
    )
    return Recording(
        name, messages, lambda: core.bad_input + log.is_broken, nothing=lambda: nothing(core.faults)
    )


def _nothing_received(path: str, faults: Mapping[str, int] = {}) -> InputError:
    """Why a receiver's log made no message."""
    if not faults:
        return InputError(path, "holds no NMEA 0183 sentence that tells a position", READABLE)
    counted = ", ".join(f"{times:,} {reason}" for reason, times in sorted(faults.items()))
    return InputError(path, f"none of its sentences could be used ({counted})", READABLE)


def _gpsd(path: Path, vehicle: Vehicle, name: str) -> Recording:
    """What `gpspipe -w` wrote down of a gpsd."""
    core = GpsdCore(vehicle.gps_latency_s)
    latency_ns = round(vehicle.gps_latency_s * 1e9)
    log = TextFile(path)
    lines = (GpsdReport(None, line) for line in gpsd_lines(log))
    messages = translated(lines, core.handle, name, lambda _, fix: fix.t_ns + latency_ns)

    def nothing() -> InputError:
        mend = "record with gpspipe -w while the receiver has a fix"
        return InputError(str(path), "none of gpsd's reports in it tells a position", mend)

    return Recording(name, messages, lambda: core.bad_input + log.is_broken, nothing=nothing)


def _reports(source: AvlSource, vehicle: Vehicle, name: str) -> Recording:
    core = GpsIngestCore(vehicle.gps_latency_s)
    rows = Readable(read_reports(source))
    messages = translated(rows, core.handle, name, lambda report, _: report.t_ns)

    def nothing() -> InputError:
        what = f"none of its {rows.bad_input + core.bad_input:,} rows has a readable time and place"
        mend = "check its columns: time ISO 8601 or Unix seconds, lat_deg and lon_deg in degrees"
        return InputError(source.path, what, mend)

    return Recording(name, messages, lambda: core.bad_input + rows.bad_input, nothing=nothing)


class Readable:
    """Passes on the rows that could be read and counts the others."""

    def __init__(self, rows: Iterable[PositionReport | None]) -> None:
        self._rows = rows
        self.bad_input = 0

    def __iter__(self) -> Iterator[PositionReport]:
        for row in self._rows:
            if row is None:
                self.bad_input += 1
            else:
                yield row
