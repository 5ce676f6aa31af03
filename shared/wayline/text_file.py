"""Reads text files as people and programs leave them: packed, marked, in any usual encoding."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from wayline.errors import InputError
from wayline.log_file import LogFile, encoding_of, head_of

LINE_MAX = 1 << 16
"""A longer line is none: zeros that a loss of power left must not fill memory."""


class TextFile:
    """A text file, read once, by `lines` or `text`. Raises InputError where it cannot be read.

    What a gzip file holds before a place where it was cut or overwritten is read; `is_broken` tells
    of it afterwards.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._encoding = encoding_of(head_of(path))
        self.is_broken = False
        """Whether a gzip file could not be unpacked to its end; known when all was read."""

    def lines(self) -> Iterator[bytes]:
        """The lines, each at most 64 KiB, as bytes; UTF-16 and UTF-32 become Latin-1."""
        if self._encoding.startswith(("utf-16", "utf-32")):
            with self.text() as text:
                for line in iter(partial(text.readline, LINE_MAX), ""):
                    yield line.encode("latin-1", "replace")
        else:
            with self._open() as file:
                yield from iter(partial(file.readline, LINE_MAX), b"")

    @contextmanager
    def text(self) -> Iterator[io.TextIOWrapper]:
        """The content as text with the line ends that it has; what is no letter is U+FFFD."""
        with (
            self._open() as file,
            io.TextIOWrapper(file, self._encoding, "replace", newline="") as content,
        ):
            yield content

    @contextmanager
    def _open(self) -> Iterator["io.BufferedReader[LogFile]"]:
        try:
            with LogFile(self._path) as log, io.BufferedReader(log, LINE_MAX) as file:
                yield file
                self.is_broken = log.is_broken
        except OSError as error:
            what = f"cannot be read ({error.strerror or error})"
            raise InputError(str(self._path), what, "check the file") from None


def read_text(path: Path) -> str:
    """A whole file as text. Raises InputError where it is missing, unreadable or broken."""
    if not path.exists():
        raise InputError(str(path), "no such file", "check the path")
    file = TextFile(path)
    with file.text() as content:
        text = content.read()
    if file.is_broken:
        raise InputError(str(path), "is a gzip file that was cut or damaged", "copy it anew")
    return text
