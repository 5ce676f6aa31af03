"""Text formats that python-can does not read, a line at a time."""

import datetime as dt
import re
from collections.abc import Callable
from typing import NamedTuple

import can

DAY_S = 86_400.0
SCREEN = re.compile(
    r"\s*\((?P<time>[\d.: -]+)\)\s+(?P<channel>\S+)\s+(?:(?P<way>[TR]X)\s+[-B]\s+[-E]\s+)?"
    r"(?P<id>[0-9A-F]{3}|[0-9A-F]{8})\s+\[(?P<length>\d+)\]\s*(?P<rest>.*)"
)
BUSMASTER = re.compile(
    r"(?P<hour>\d+):(?P<minute>\d+):(?P<second>\d+):(?P<part>\d{1,4})\s+(?P<way>[TR]x)\s+"
    r"(?P<channel>\S+)\s+(?P<id>(?:0x)?[0-9A-Fa-f]+)\s+(?P<kind>[sx])(?P<remote>r?)\s+"
    r"(?P<length>\d+)(?P<data>(?:\s+[0-9A-Fa-f]+)*)\s*$"
)
STARTED = re.compile(r"START DATE AND TIME (\d+):(\d+):(\d+) (\d+):(\d+):(\d+):(\d+)")
MICROCHIP = re.compile(
    r"(?P<ms>\d+);(?P<way>[TR]X);(?P<id>0x[0-9A-Fa-f]+);(?P<length>\d+);(?P<data>[0-9A-Fa-fx;]*)\s*$"
)
CRTD = re.compile(
    r"(?P<time>\d+\.\d+)\s+(?P<channel>\d*)(?P<way>[TR])(?P<bits>11|29)\s+(?P<id>[0-9A-Fa-f]+)"
    r"(?P<data>(?:\s+[0-9A-Fa-f]{1,2})*)\s*$"
)
CRTD_OTHER = re.compile(r"\d+\.\d+\s+\d*C[A-Z]{2}")
STANDARD_MOST = 0x7FF


def candump_screen(line: str) -> can.Message | None:
    """What candump shows with -t a or -t A (here with `is_local`), as far as it is no event."""
    if line.isspace():
        return None
    found = _matched(SCREEN, line)
    length, rest = int(found["length"]), found["rest"]
    is_remote, is_error = "remote request" in rest, "ERRORFRAME" in rest
    return can.Message(
        timestamp=_candump_s(found["time"]),
        channel=found["channel"],
        arbitration_id=int(found["id"], 16) & 0x1FFF_FFFF,
        is_extended_id=len(found["id"]) > 3,
        is_rx=found["way"] != "TX",
        is_fd=length > 8,
        is_remote_frame=is_remote,
        is_error_frame=is_error,
        dlc=length,
        data=None if is_remote else bytes(int(each, 16) for each in rest.split()[:length]),
    )


def _candump_s(text: str) -> float:
    if "-" not in text:
        return float(text)
    return dt.datetime.fromisoformat(text.strip()).replace(tzinfo=dt.UTC).timestamp()


class Busmaster:
    """Lines of a BUSMASTER log; its times are of the day, of the log or of the line before."""

    def __init__(self) -> None:
        self._base = 16
        self._mode = "SYSTEM"
        self._day_s = 0.0
        self._start_s = 0.0
        self._last_s = 0.0

    def __call__(self, line: str) -> can.Message | None:
        """The frame of a line; header and remarks are none."""
        if line.startswith("***"):
            self._header(line)
            return None
        if line.isspace():
            return None
        found = _matched(BUSMASTER, line)
        return can.Message(
            timestamp=self._unix_s(found),
            channel=found["channel"],
            arbitration_id=int(found["id"], self._base),
            is_extended_id=found["kind"] == "x",
            is_rx=found["way"] == "Rx",
            is_remote_frame=bool(found["remote"]),
            dlc=int(found["length"]),
            data=None
            if found["remote"]
            else bytes(int(each, self._base) for each in found["data"].split()),
        )

    def _header(self, line: str) -> None:
        text = line.strip().strip("*")
        if text in ("HEX", "DEC"):
            self._base = 16 if text == "HEX" else 10
        elif text.endswith(" MODE"):
            self._mode = text.split()[0]
        elif started := STARTED.match(text):
            day, month, year, hour, minute, second, ms = map(int, started.groups())
            midnight = dt.datetime(year, month, day, tzinfo=dt.UTC)
            self._day_s = midnight.timestamp()
            self._start_s = self._day_s + hour * 3600 + minute * 60 + second + ms / 1000
            self._last_s = self._start_s

    def _unix_s(self, found: re.Match[str]) -> float:
        """Of four digits the last part of a time is tenths of a millisecond, else milliseconds."""
        part = found["part"]
        since_s = int(found["hour"]) * 3600 + int(found["minute"]) * 60 + int(found["second"])
        time_s = since_s + int(part) / (10_000 if len(part) == 4 else 1000)
        if self._mode == "ABSOLUTE":
            return self._start_s + time_s
        if self._mode == "RELATIVE":
            self._last_s += time_s
            return self._last_s
        if self._day_s + time_s < self._last_s - DAY_S / 2:
            self._day_s += DAY_S
        self._last_s = self._day_s + time_s
        return self._last_s


def microchip(line: str) -> can.Message | None:
    """A line of Microchip's CAN BUS Analyzer; its header is no frame."""
    if not line[:1].isdigit():
        return None
    found = _matched(MICROCHIP, line)
    number = int(found["id"], 16)
    return can.Message(
        timestamp=int(found["ms"]) / 1000,
        arbitration_id=number,
        is_extended_id=number > STANDARD_MOST,
        is_rx=found["way"] == "RX",
        dlc=int(found["length"]),
        data=bytes(int(each, 16) for each in found["data"].split(";") if each),
    )


def crtd(line: str) -> can.Message | None:
    """A line of a CRTD log, as OVMS writes it; comments and events are no frames."""
    if line.isspace() or CRTD_OTHER.match(line):
        return None
    found = _matched(CRTD, line)
    if not (found["data"] or line.endswith("\n")):
        raise ValueError("cut within its identifier")
    return can.Message(
        timestamp=float(found["time"]),
        channel=found["channel"] or None,
        arbitration_id=int(found["id"], 16),
        is_extended_id=found["bits"] == "29",
        is_rx=found["way"] == "R",
        data=bytes(int(each, 16) for each in found["data"].split()),
    )


class Columns(NamedTuple):
    """Where a table of frames has what; None where it has no such column."""

    time: int
    number: int
    scale_s: float
    """Seconds in the unit of its times."""
    data: int
    """The column of all bytes, or of the first one."""
    has_byte_columns: bool
    length: int | None
    extended: int | None
    way: int | None
    channel: int | None


def columns_of(header: str) -> Columns | None:
    """The columns of a table of frames that is known: SavvyCAN (GVRET), CSS Electronics, cabana."""
    names = [name.strip().strip('"').lower() for name in _cells(header)]
    for time, number, scale_s, data in (
        ("time stamp", "id", 1e-6, "d1"),
        ("timestampepoch", "id", 1.0, "databytes"),
        ("time", "addr", 1.0, "data"),
    ):
        if {time, number, data} <= set(names):
            return Columns(
                time=names.index(time),
                number=names.index(number),
                scale_s=scale_s,
                data=names.index(data),
                has_byte_columns=data == "d1",
                length=_index(names, "len", "datalength"),
                extended=_index(names, "extended", "ide"),
                way=_index(names, "dir"),
                channel=_index(names, "bus", "buschannel"),
            )
    return None


def table(columns: Columns, header: str) -> Callable[[str], can.Message | None]:
    """Reads the rows of such a table."""

    def read(line: str) -> can.Message | None:
        if line.isspace() or line.strip() == header.strip():
            return None
        cells = [cell.strip() for cell in _cells(line)]
        time, number = cells[columns.time], int(cells[columns.number], 16)
        data = _bytes(cells[columns.data :], columns)
        told = None if columns.extended is None else cells[columns.extended].lower()
        way = "rx" if columns.way is None else cells[columns.way].lower()
        return can.Message(
            timestamp=float(time) * columns.scale_s,
            channel=None if columns.channel is None else cells[columns.channel],
            arbitration_id=number & 0x1FFF_FFFF,
            is_extended_id=number > STANDARD_MOST if told is None else told in ("true", "1"),
            is_rx=way not in ("tx", "1", "true"),
            dlc=len(data) if columns.length is None else int(cells[columns.length]),
            is_fd=len(data) > 8,
            data=data,
        )

    return read


def _bytes(cells: list[str], columns: Columns) -> bytes:
    if columns.has_byte_columns:
        return bytes(int(cell, 16) for cell in cells if cell)
    return bytes.fromhex(cells[0].removeprefix("0x"))


def _cells(line: str) -> list[str]:
    line = line.strip()
    return line.split(";" if ";" in line else ",")


def _index(names: list[str], *wanted: str) -> int | None:
    return next((names.index(name) for name in wanted if name in names), None)


def _matched(pattern: re.Pattern[str], line: str) -> re.Match[str]:
    found = pattern.match(line)
    if found is None:
        raise ValueError("no such line")
    return found
