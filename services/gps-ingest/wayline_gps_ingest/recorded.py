"""The receivers and position reports of a recorded drive, as bus messages."""

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path

from wayline.avl_log import ReportLog
from wayline.drive import AvlSource, Drive, NmeaSource, Vehicle
from wayline.errors import InputError
from wayline.inputs import PositionReport, Sentence
from wayline.messages import Message
from wayline.nmea_log import NmeaLog, gpsd_lines, has_date, has_sentence, is_gpsd_log
from wayline.received import Account, Recording, source_names, translated
from wayline.text_file import TextFile
from wayline_gps_ingest.core import GpsIngestCore
from wayline_gps_ingest.gpsd import GpsdCore, GpsdReport
from wayline_gps_ingest.raw.recorded import raw_recording
from wayline_gps_ingest.recorded_agency import agency_recording

READABLE = "give a receiver's log of GGA, RMC, GLL, GNS or the like, as it came from the line"


def recordings(drive: Drive, where: str) -> list[Recording]:
    """Every `[[nmea]]`, `[[avl]]` and `[[raw]]` of a drive, in that order. Raises InputError."""
    del where  # what is wrong with them is in their own files
    names = source_names("gps-ingest")
    return [
        *(_receiver(nmea, drive.vehicle, next(names)) for nmea in drive.nmea),
        *(_reports(avl, drive, next(names)) for avl in drive.avl),
        *(raw_recording(raw, next(names)) for raw in drive.raw),
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
    core = GpsIngestCore(vehicle.gps_latency_s, source.date, recorded=True)
    latency_ns = round(vehicle.gps_latency_s * 1e9)
    log = NmeaLog(path)

    def received_ns(sentence: Sentence, message: Message) -> int:
        if sentence.received_ns is None:
            return message.t_ns + latency_ns
        # what was held until now was received as much earlier as it is older
        return sentence.received_ns - (core.told_ns - message.t_ns)

    messages = translated(log, core.handle, name, received_ns)
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
    core = GpsdCore(vehicle.gps_latency_s, recorded=True)
    latency_ns = round(vehicle.gps_latency_s * 1e9)
    log = TextFile(path)
    lines = (GpsdReport(None, line) for line in gpsd_lines(log))
    messages = translated(lines, core.handle, name, lambda _, fix: fix.t_ns + latency_ns)

    def nothing() -> InputError:
        mend = "record with gpspipe -w while the receiver has a fix"
        return InputError(str(path), "none of gpsd's reports in it tells a position", mend)

    return Recording(name, messages, lambda: core.bad_input + log.is_broken, nothing=nothing)


def _reports(source: AvlSource, drive: Drive, name: str) -> Recording:
    if source.columns is None:
        return agency_recording(source, drive.drive.vehicle_id, drive.vehicle, name)
    return _table(source, drive.vehicle, name)


def _table(source: AvlSource, vehicle: Vehicle, name: str) -> Recording:
    core = GpsIngestCore(vehicle.gps_latency_s, recorded=True)
    latency_ns = round(vehicle.gps_latency_s * 1e9)
    log = ReportLog(source)
    rows = Readable(log)
    messages = translated(rows, core.handle, name, lambda _, fix: fix.t_ns + latency_ns)

    def account() -> Account:
        return Account({"of other rows": log.left_out} if log.left_out else {})

    def nothing() -> InputError:
        if log.left_out and not rows.bad_input + core.bad_input:
            asked = ", ".join(f"{column} {value}" for column, value in source.where.items())
            what = f"none of its {log.left_out:,} rows has {asked}"
            return InputError(source.path, what, "correct where in its [[avl]]")
        what = f"none of its {rows.bad_input + core.bad_input:,} rows has a readable time and place"
        mend = "check its columns: time ISO 8601 or Unix seconds, lat_deg and lon_deg in degrees"
        return InputError(source.path, what, mend)

    return Recording(name, messages, lambda: core.bad_input + rows.bad_input, account, nothing)


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
