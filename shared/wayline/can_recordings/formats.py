"""Which format a CAN recording is, by what it holds, and its reader."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import can

from wayline.can_recordings import blf, mf4
from wayline.can_recordings.asc import Asc
from wayline.can_recordings.blf import Blf
from wayline.can_recordings.line_formats import (
    Busmaster,
    Columns,
    candump_screen,
    columns_of,
    crtd,
    microchip,
    table,
)
from wayline.can_recordings.lines import Lines
from wayline.can_recordings.mf4 import Mf4
from wayline.can_recordings.reading import Reading
from wayline.can_recordings.sqlite import Sqlite
from wayline.can_recordings.text import LineByLine, ReaderOfLines
from wayline.can_recordings.trc import open_trc
from wayline.errors import UnreadableError
from wayline.log_file import encoding_of, head_of

READABLE = (
    "give a CAN recording: candump -l (.log), Vector .asc or .blf, PEAK .trc, MDF 4 with raw "
    "frames (.mf4), a CSV of SavvyCAN (GVRET), CSS, cabana or python-can, a BUSMASTER, Microchip "
    "or CRTD log, or one of them with .gz"
)
SAVE = "save it as candump -l (.log) or as Vector .asc"
CSV_HEADER = "timestamp,arbitration_id"


class TextFormat(NamedTuple):
    """A text format, by a line of it or of its header, and how it is read."""

    pattern: re.Pattern[str]
    open: Callable[[Path, str], Reading]
    """With the first characters of the file."""


class Foreign(NamedTuple):
    """A format that is known but not read."""

    pattern: re.Pattern[str]
    name: str
    mend: str


def _lines(pattern: str) -> re.Pattern[str]:
    return re.compile(pattern, re.MULTILINE | re.IGNORECASE)


def _python_can_csv(path: Path, head: str) -> Reading:
    lines = Lines(path)
    if not head.lstrip().startswith(CSV_HEADER):
        lines.push("\n")
    return ReaderOfLines(lines, can.CSVReader)


def _candump(path: Path, head: str) -> Reading:
    del head
    return ReaderOfLines(Lines(path), can.CanutilsLogReader)


def _table(path: Path, header: str, columns: Columns) -> Reading:
    return LineByLine(Lines(path), table(columns, header))


TEXTS = (
    TextFormat(_lines(r"^;\s*\$(?:FILEVERSION|STARTTIME|COLUMNS)|^;.*(?:PCAN|PEAK-)"), open_trc),
    TextFormat(
        _lines(r"^\s*(?:date\s+\S+\s+\S+\s+\d|base\s+(?:hex|dec)\b|begin\s+triggerblock)"),
        lambda path, _: Asc(path),
    ),
    TextFormat(
        _lines(r"^\*\*\*(?:BUSMASTER|<Time>)"),
        lambda path, _: LineByLine(Lines(path), Busmaster(), is_local=True),
    ),
    TextFormat(_lines(r"^\(\d+\.\d+\)\s+\S+\s+[0-9A-F]{3,8}#"), _candump),
    TextFormat(
        _lines(r"^\s*\([\d.: -]+\)\s+\S+\s+(?:[TR]X\s+\S\s+\S\s+)?[0-9A-F]{3,8}\s+\[\d+\]"),
        lambda path, head: LineByLine(
            Lines(path), candump_screen, is_local=re.search(r"^\s*\(\d+-", head, re.M) is not None
        ),
    ),
    TextFormat(_lines(rf"^\s*{CSV_HEADER}"), _python_can_csv),
    TextFormat(
        _lines(r"^(?:CAN BUS Analyzer|\d+;[TR]X;0x)"),
        lambda path, _: LineByLine(Lines(path), microchip),
    ),
    TextFormat(
        _lines(r"^\d+\.\d+\s+\d*(?:[TR](?:11|29)\s+[0-9A-F]|CXX\b)"),
        lambda path, _: LineByLine(Lines(path), crtd),
    ),
)
BY_SUFFIX: dict[str, Callable[[Path, str], Reading]] = {
    ".log": _candump,
    ".asc": lambda path, _: Asc(path),
    ".trc": open_trc,
    ".csv": _python_can_csv,
}
"""Where the beginning is damaged."""
FOREIGN = (
    Foreign(
        _lines(r"^\s*[A-Za-z]\w*\s+(?:[TR]X\s+\S\s+\S\s+)?[0-9A-F]{3,8}\s+\[\d+\]"),
        "candump's screen output without times",
        "record with candump -l",
    ),
    Foreign(_lines(r"\A\s*@ TEXT @"), "a CARBUS Analyzer trace", SAVE),
    Foreign(_lines(r"^\s*Chn\s+Identifier\s+Flg"), "a Kvaser CanKing log", SAVE),
    Foreign(_lines(r"Vehicle Spy|Intrepid Control"), "a Vehicle Spy export", SAVE),
    Foreign(_lines(r"IXXAT|^\"?Time\"?[;,]\"?Identifier"), "an IXXAT trace", SAVE),
    Foreign(_lines(r"^\s*Time\s+ID\s+DLC\s+Data"), "a CANHacker trace", SAVE),
    Foreign(_lines(r"\A\s*ID,(?:D0|Data|len)"), "a CSV of frames without times", SAVE),
    Foreign(_lines(r"^(?:\d+(?:\.\d+)? )?[$!][A-Z]{2}[A-Z]{3},"), "NMEA 0183 text",
            "name it in a [[nmea]]"),
    Foreign(_lines(r"^\s*VERSION\s*\"|^BO_ \d+ "), "a DBC, not a recording", "name it in dbc"),
    Foreign(_lines(r"\A\s*<\?xml|\A\s*<"), "XML", SAVE),
    Foreign(_lines(r"\A\s*[\[{]"), "JSON", SAVE),
)  # fmt: skip
BINARY = (
    (b"PK\x03\x04", "a zip archive", "unpack it, or pack it with gzip"),
    (b"\xd4\xc3\xb2\xa1", "a pcap capture", SAVE),
    (b"\xa1\xb2\xc3\xd4", "a pcap capture", SAVE),
    (b"\x0a\x0d\x0d\x0a", "a pcapng capture", SAVE),
    (b"\x89MCAP", "an MCAP file", "give the CAN recording itself"),
    (b"7z\xbc\xaf", "a 7z archive", "unpack it, or pack it with gzip"),
    (b"BZh", "packed with bzip2", "unpack it, or pack it with gzip"),
    (b"\xfd7zXZ", "packed with xz", "unpack it, or pack it with gzip"),
    (b"\x28\xb5\x2f\xfd", "packed with zstd", "unpack it, or pack it with gzip"),
)


def open_recording(path: Path) -> Reading:
    """A reader of the file. Raises InputError, UnreadableError for what is no CAN recording."""
    head = head_of(path)
    if not head.strip(b"\0"):
        what = "is empty" if not head else "holds nothing but zeros"
        raise UnreadableError(str(path), what, "give another recording")
    if head.startswith(blf.MAGIC):
        return Blf(path)
    if head.startswith(mf4.MAGIC):
        return Mf4(path)
    if head.startswith(Sqlite.MAGIC):
        return Sqlite(path)
    for magic, name, mend in BINARY:
        if head.startswith(magic):
            raise UnreadableError(str(path), f"is {name}, no CAN recording", mend)
    return _open_text(path, head.decode(encoding_of(head), errors="replace"))


def _open_text(path: Path, head: str) -> Reading:
    for line in head.splitlines():
        if columns := columns_of(line):
            return _table(path, line, columns)
    for known in TEXTS:
        if known.pattern.search(head):
            return known.open(path, head)
    for foreign in FOREIGN:
        if foreign.pattern.search(head):
            raise UnreadableError(str(path), f"is {foreign.name}, not read", foreign.mend)
    by_suffix = BY_SUFFIX.get(suffix_of(path))
    if by_suffix is None or head.startswith(blf.MAGIC.decode()):
        raise UnreadableError(str(path), f"is no CAN recording ({begins(head)})", READABLE)
    return by_suffix(path, head)


def suffix_of(path: Path) -> str:
    """What a name ends in, in small letters, without the .gz of a packed one."""
    suffixes = [suffix.lower() for suffix in path.suffixes]
    if suffixes[-1:] == [".gz"]:
        suffixes.pop()
    return suffixes[-1] if suffixes else ""


def begins(head: str) -> str:
    """How a file begins, as a terminal can show it."""
    line = next(_shown(head), "")
    return f"it begins {line[:60]!r}" if line else "it holds no text"


def _shown(head: str) -> Iterator[str]:
    for line in head.splitlines():
        shown = "".join(each if each.isprintable() else "?" for each in line).strip()
        if shown:
            yield shown
