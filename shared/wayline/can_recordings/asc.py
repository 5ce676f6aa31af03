"""Vector's .asc: the date of its header, relative times, and what python-can passes over."""

import datetime as dt
import re
from collections.abc import Iterator
from pathlib import Path

import can

from wayline.can_recordings.lines import Lines
from wayline.can_recordings.text import ReaderOfLines

HEADER = re.compile(r"\s*(?:date\s|base\s|//|(?:no\s+)?internal\s+events)", re.IGNORECASE)
DATE = re.compile(
    r"\s*(?P<what>date|begin\s+triggerblock)\s+(?:\S+\s+)?(?P<month>[^\W\d]{3,})\.?\s+(?P<day>\d+)"
    r"\s+(?P<hour>\d+):(?P<minute>\d+):(?P<second>\d+)(?:\.(?P<part>\d{1,6}))?"
    r"(?:\s+(?P<half>[ap]m))?\s+(?P<year>\d{4})\s*$",
    re.IGNORECASE,
)
MONTHS = (
    ("jan",), ("feb",), ("mar", "mär", "mrz"), ("apr",), ("may", "mai"), ("jun",),
    ("jul",), ("aug",), ("sep",), ("oct", "okt"), ("nov",), ("dec", "dez"),
)  # fmt: skip
"""As CANoe writes them in English and German."""
RELATIVE = re.compile(r"\s*base\s.*timestamps\s+relative", re.IGNORECASE)
TIMED = re.compile(r"(\s*)(\d+)\.(\d+)(?=\s)")
TORN = re.compile(
    r"\s*\d+(?:\.\d*)?(?:\s+(?:CANFD\s+)?\d*(?:\s+(?:[0-9A-Fa-f]+x?|[TR]x)(?:\s.*)?)?)?\s*$"
)
"""A time and what may follow it in the line of a frame."""


class AscLines(Lines):
    """Lines of an .asc with the time since its beginning, which is `start_s` (Unix, 0 unknown).

    "timestamps relative" counts from line to line, lines that are no frame among them. A block
    begins with the date of its trigger; its times count from the header's date or from that one,
    whichever puts the first of them nearer to it.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path, is_torn=lambda line: TORN.match(line) is not None)
        self.start_s = 0.0
        self._header_s: float | None = None
        self._trigger_s: float | None = None
        self._in_header = True
        self._is_relative = False
        self._elapsed_us = 0

    def __next__(self) -> str:
        line = super().__next__()
        if self._in_header and not line.isspace():
            return self._header(line)
        timed = TIMED.match(line) if self._is_relative or self._trigger_s is not None else None
        if timed is not None:
            return self._timed(line, timed)
        if line[:1] in "bB" and (found := DATE.match(line)):
            self._trigger_s = unix_s(found)
        return line

    def _header(self, line: str) -> str:
        """python-can loses the line behind the header: it gets an empty one."""
        if not HEADER.match(line):
            self._in_header = False
            self.push(line)
            return "\n"
        if RELATIVE.match(line):
            self._is_relative = True
        elif found := DATE.match(line):
            self._header_s = unix_s(found)
            self.start_s = self._header_s or 0.0
        return line

    def _timed(self, line: str, timed: re.Match[str]) -> str:
        us = int(timed[2]) * 1_000_000 + int(timed[3][:6].ljust(6, "0"))
        if self._is_relative:
            self._elapsed_us += us
            us = self._elapsed_us
        if self._trigger_s is not None:
            self._begin_block(us * 1e-6, self._trigger_s)
        seconds, part = divmod(us, 1_000_000)
        return f"{timed[1]}{seconds}.{part:06d}{line[timed.end() :]}"

    def _begin_block(self, first_s: float, trigger_s: float) -> None:
        header_s = self._header_s
        if header_s is None or abs(header_s + first_s - trigger_s) > abs(first_s):
            self.start_s = trigger_s
        else:
            self.start_s = header_s
        self._trigger_s = None


class Asc(ReaderOfLines):
    """Frames of an .asc; python-can counts its channels from 0, the file from 1."""

    first_channel = 1

    def __init__(self, path: Path) -> None:
        self._dated = AscLines(path)
        super().__init__(self._dated, can.ASCReader, is_local=True)

    def __iter__(self) -> Iterator[can.Message]:
        for message in super().__iter__():
            message.timestamp += self._dated.start_s
            yield message


def unix_s(found: re.Match[str]) -> float | None:
    """The date of a header as if it were UTC; None where it is none."""
    name = found["month"].lower()
    month = next((n for n, names in enumerate(MONTHS, 1) if name.startswith(names)), None)
    hour = int(found["hour"])
    if found["half"]:
        hour = hour % 12 + (12 if found["half"].lower() == "pm" else 0)
    if month is None:
        return None
    try:
        date = dt.datetime(
            int(found["year"]),
            month,
            int(found["day"]),
            hour,
            int(found["minute"]),
            int(found["second"]),
            int((found["part"] or "").ljust(6, "0")),
            tzinfo=dt.UTC,
        )
    except ValueError:
        return None
    return date.timestamp()
