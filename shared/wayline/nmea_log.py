"""Reads a recorded NMEA 0183 log: text lines, plain or with the time of their receipt before them.

A log is read as bytes, because receivers mix binary messages in (see `wayline.framing`).
"""

import re
from collections.abc import Iterator
from pathlib import Path

from wayline.framing import split_sentences
from wayline.inputs import Sentence
from wayline.text_file import TextFile

RECEIPT = re.compile(r"(?:\xef\xbb\xbf)?(\d{1,12})(?:\.(\d{1,9})\d*)?\s+(?=[$!])")
"""Seconds before a sentence; a byte order mark may stand before the first."""
DATED = re.compile(
    rb"\$[A-Z]{2}(?:"
    rb"RMC,(?:[^,*\r\n]*,){8} *(?!0{6})\d{4}(?!80)\d\d *|"
    rb"ZDA,[^,*\r\n]*, *\d\d? *, *\d\d? *, *(?!0000|1980)\d{4} *)[,*\r\n]"
)
"""A date; zeros and 1980 are what a receiver writes that has not heard it."""


class NmeaLog:
    """A log, read once: its sentences in order, each with its receipt where the log holds it.

    Lines may end in CR LF, CR CR LF, CR or LF; the log may be a gzip file, UTF-16 or have a byte
    order mark. Comment lines (`#`) and bytes outside sentences are skipped. Raises InputError if
    the file cannot be opened.
    """

    def __init__(self, path: Path) -> None:
        self._file = TextFile(path)

    @property
    def is_broken(self) -> bool:
        """Whether a gzip file could not be unpacked to its end; known when all was read."""
        return self._file.is_broken

    def __iter__(self) -> Iterator[Sentence]:
        for line in _lines(self._file):
            text = line.decode("latin-1")
            if not text.startswith("#"):
                received_ns = _received_ns(text)
                for sentence in split_sentences(text):
                    yield Sentence(received_ns, sentence)


def read_sentences(path: Path) -> Iterator[Sentence]:
    """The sentences of a log, as `NmeaLog` reads them. Raises InputError."""
    yield from NmeaLog(path)


def is_gpsd_log(path: Path) -> bool:
    """Whether a log is of gpsd's JSON reports (`gpspipe -w`) instead. Raises InputError."""
    first = next((line for line in _lines(TextFile(path)) if line.strip()), b"")
    return first.lstrip(b"\xef\xbb\xbf ").startswith(b'{"class":')


def gpsd_lines(file: TextFile) -> Iterator[str]:
    """The reports of gpsd that a log holds, in order. Raises InputError."""
    for line in _lines(file):
        yield line[max(line.find(b"{"), 0) :].decode("utf-8", "replace")


def has_date(path: Path) -> bool:
    """Whether any sentence of a log carries a date (RMC, ZDA); reads only up to the first one.

    Raises InputError if the file cannot be opened.
    """
    return any(DATED.search(line) for line in _lines(TextFile(path)))


def has_sentence(path: Path) -> bool:
    """Whether a log holds anything like a sentence; reads only up to the first one.

    Raises InputError if the file cannot be opened.
    """
    return next(iter(NmeaLog(path)), None) is not None


def _lines(file: TextFile) -> Iterator[bytes]:
    for line in file.lines():
        yield from filter(None, line.replace(b"\r", b"\n").split(b"\n"))


def _received_ns(text: str) -> int | None:
    found = RECEIPT.match(text)
    if not found:
        return None
    return int(found[1]) * 1_000_000_000 + int((found[2] or "").ljust(9, "0"))
