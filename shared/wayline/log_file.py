"""Opens a log as it lies on a disk: plain or gzip, cut short or not, text in any encoding."""

import codecs
import io
import mmap
import zlib
from pathlib import Path

from wayline.errors import InputError

GZIP = b"\x1f\x8b"
CHUNK = 1 << 16
ZEROS = bytes(8)
HEAD = 4096
"""Bytes that tell what a file is."""
MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


class LogFile(io.RawIOBase):
    """The bytes of a log, unpacked where they are packed; reads up to where a packed one breaks.

    `is_broken` tells, once it was read, that it ends in damage. Raises InputError if the file
    cannot be opened, OSError where the disk fails.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        try:
            self._file = path.open("rb")
        except OSError as error:
            raise InputError(
                str(path), f"cannot be read ({error.strerror})", "check the path"
            ) from None
        self.is_packed = self._file.peek(len(GZIP)).startswith(GZIP)
        self.is_broken = False
        self._unpacking: zlib._Decompress | None = None
        self._packed = b""
        self._end = path.stat().st_size
        """Bytes of a packed log that are read; zeros in the middle of it unpack to anything."""
        if self.is_packed and not self._is_sound():
            self._end = zeros_at(path)

    def readable(self) -> bool:
        """It is."""
        return True

    def readinto(self, buffer: "bytearray | memoryview", /) -> int:  # type: ignore[override]
        """Fill a part of the buffer; 0 at the end."""
        size = len(buffer)
        data = self._unpacked(size) if self.is_packed else self._file.read(size)
        buffer[: len(data)] = data
        return len(data)

    def close(self) -> None:
        """Close the file too."""
        self._file.close()
        super().close()

    def _unpacked(self, size: int) -> bytes:
        """Up to so many bytes; what follows one packed part is the next, or padding."""
        while True:
            if not self._packed:
                self._packed = self._file.read(min(CHUNK, self._end - self._file.tell()))
            if self._unpacking is None:
                self._packed = self._packed.lstrip(b"\0")
                if not self._packed:
                    return b""
                self._unpacking = zlib.decompressobj(wbits=31)
            at_end = not self._packed
            try:
                data = self._unpacking.decompress(self._packed, size)
            except zlib.error:
                return self._break()
            self._packed = self._unpacking.unconsumed_tail or self._unpacking.unused_data
            if self._unpacking.eof:
                self._unpacking = None
            elif at_end and not data:
                return self._break()
            if data:
                return data

    def _is_sound(self) -> bool:
        """Whether it unpacks to its end; begins anew thereafter."""
        while self._unpacked(CHUNK):
            pass
        is_sound = not self.is_broken
        self._file.seek(0)
        self._unpacking, self._packed, self.is_broken = None, b"", False
        return is_sound

    def _break(self) -> bytes:
        self.is_broken = True
        self._unpacking, self._packed = None, b""
        self._file.seek(self._end)
        return b""


def zeros_at(path: Path) -> int:
    """Where a file has a run of zeros that packed data does not have; its length without one."""
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        found = data.find(ZEROS)
    return found if found >= 0 else path.stat().st_size


def head_of(path: Path) -> bytes:
    """The first bytes of a log. Raises InputError if it cannot be opened or read."""
    with LogFile(path) as log:
        try:
            return io.BufferedReader(log).read(HEAD)
        except OSError as error:
            raise InputError(
                str(path), f"cannot be read ({error.strerror})", "check the file"
            ) from None


def encoding_of(head: bytes) -> str:
    """How a text is encoded, by its first bytes.

    A byte order mark tells, or the zeros between the letters; else it is UTF-8, or where it cannot
    be that, the Windows code page of western Europe.
    """
    for mark, encoding in MARKS:
        if head.startswith(mark):
            return encoding
    if len(head) >= 4 and not any(head[1::2]) and all(head[0::2]):
        return "utf-16-le"
    if len(head) >= 4 and not any(head[0::2]) and all(head[1::2]):
        return "utf-16-be"
    try:
        codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def decoded(data: bytes) -> str:
    """A whole text, whatever its encoding; what cannot be decoded becomes a replacement mark."""
    return data.decode(encoding_of(data), errors="replace")
