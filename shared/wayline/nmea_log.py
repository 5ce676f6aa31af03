"""Reads a recorded NMEA 0183 log: text lines, plain or with the time of their receipt before them.

A log is read as bytes, because receivers mix binary messages in (see `wayline.framing`).
"""

import re
from collections.abc import Iterator
from pathlib import Path

from wayline.errors import InputError
from wayline.framing import split_sentences
from wayline.inputs import Sentence

RECEIPT = re.compile(r"(\d{1,12})(?:\.(\d{1,9})\d*)?\s+(?=[$!])")
DATED = re.compile(
    rb"\$[A-Z]{2}(?:RMC,(?:[^,*\r\n]*,){8}\d{6}[,*\r\n]|ZDA,[^,*\r\n]*,\d\d?,\d\d?,\d{4}[,*\r\n])"
)


def read_sentences(path: Path) -> Iterator[Sentence]:
    """Sentences of a log in order, each with its receipt where the log holds it.

    Lines may end in CR LF, CR CR LF, CR or LF. Comment lines (`#`) and bytes outside sentences are
    skipped. Raises InputError if the file cannot be opened.
    """
    for line in _lines(path):
        text = line.decode("latin-1")
        if not text.startswith("#"):
            received_ns = _received_ns(text)
            for sentence in split_sentences(text):
                yield Sentence(received_ns, sentence)


def has_date(path: Path) -> bool:
    """Whether any sentence of a log carries a date (RMC, ZDA); reads only up to the first one.

    Raises InputError if the file cannot be opened.
    """
    return any(DATED.search(line) for line in _lines(path))


def has_sentence(path: Path) -> bool:
    """Whether a log holds anything like a sentence; reads only up to the first one.

    Raises InputError if the file cannot be opened.
    """
    return next(iter(read_sentences(path)), None) is not None


def _lines(path: Path) -> Iterator[bytes]:
    try:
        with path.open("rb") as log:
            for line in log:
                yield from filter(None, line.replace(b"\r", b"\n").split(b"\n"))
    except OSError as error:
        raise InputError(
            str(path), f"cannot be read ({error.strerror})", "check the path"
        ) from None


def _received_ns(text: str) -> int | None:
    found = RECEIPT.match(text)
    if not found:
        return None
    return int(found[1]) * 1_000_000_000 + int((found[2] or "").ljust(9, "0"))
