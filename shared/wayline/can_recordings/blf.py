"""Vector's .blf with its damage cut out, so that python-can's reader comes to the end of it."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import can

from wayline.can_recordings.text import DAMAGE
from wayline.errors import UnreadableError
from wayline.log_file import ZEROS, LogFile

MAGIC = b"LOGG"
OBJECT = b"LOBJ"
HEADER = struct.Struct("<4sL")
HEADER_SIZE = 144
START = slice(40, 56)
"""Where the header tells when the recording began; without, its times carry no date."""
OBJECT_HEADER = struct.Struct("<4sHHLL")
"""Signature, header size, header version, object size, object type."""
CONTAINER_HEADER = struct.Struct("<H6xL4x")
"""Compression, unpacked size."""
CONTAINER, STORED, DEFLATED = 10, 0, 2
SMALLEST = {1: 32, 2: 40}
"""Bytes of an object's header by its version."""
SMALLEST_DAMAGE = 8
"""Fewer bytes between two objects are padding."""
LARGEST = 1 << 24
"""Bytes of an object; a container has 128 kB, a frame 200 bytes."""


class Blf:
    """Frames of a .blf; a damaged container or object costs itself alone."""

    is_local = True
    is_dated = None
    first_channel = 1

    def __init__(self, path: Path) -> None:
        self._path = path
        self._log = LogFile(path)
        self.damaged = 0

    def __iter__(self) -> Iterator[can.Message]:
        sound: io.RawIOBase = _Sound(self._sound(io.BufferedReader(self._log)))
        try:
            yield from can.BLFReader(io.BufferedReader(sound))
        except (*DAMAGE, struct.error) as error:
            raise UnreadableError(
                str(self._path), f"is damaged ({error})", "give another recording"
            ) from None
        self.damaged += self._log.is_broken

    def close(self) -> None:
        """Close the file."""
        self._log.close()

    def _sound(self, file: io.BufferedReader[LogFile]) -> Iterator[bytes]:
        """The header, and containers that hold nothing but whole objects, unpacked."""
        head = file.read(HEADER_SIZE)
        if len(head) < HEADER_SIZE:
            raise UnreadableError(
                str(self._path), "ends within its header", "give another recording"
            )
        yield HEADER.pack(MAGIC, HEADER_SIZE) + head[HEADER.size :]
        rest = b""
        for body in self._containers(file):
            damaged = self.damaged
            whole, rest = self._whole(rest + self._unpacked(body))
            if self.damaged > damaged:
                rest = b""
            yield _container(whole)
        self.damaged += len(rest) >= OBJECT_HEADER.size

    def _containers(self, file: io.BufferedReader[LogFile]) -> Iterator[bytes]:
        while len(head := self._next_object(file)) == OBJECT_HEADER.size:
            _, _, _, size, kind = OBJECT_HEADER.unpack(head)
            if not OBJECT_HEADER.size <= size <= LARGEST:
                self.damaged += 1
                continue
            body = file.read(size - OBJECT_HEADER.size)
            if kind == CONTAINER:
                self.damaged += len(body) < size - OBJECT_HEADER.size
                yield body

    def _next_object(self, file: io.BufferedReader[LogFile]) -> bytes:
        """The header of the next object in the file, shorter at its end."""
        held = file.read(OBJECT_HEADER.size)
        skipped = 0
        while (found := held.find(OBJECT)) < 0:
            more = file.read(OBJECT_HEADER.size - len(OBJECT) + 1)
            if not more:
                found = len(held)
                break
            skipped += len(more)
            held = held[1 - len(OBJECT) :] + more
        self.damaged += skipped + found >= SMALLEST_DAMAGE
        return held[found:] + file.read(found)

    def _unpacked(self, body: bytes) -> bytes:
        """What a container holds, up to where it breaks."""
        if len(body) < CONTAINER_HEADER.size:
            return b""
        method, _ = CONTAINER_HEADER.unpack_from(body)
        data = body[CONTAINER_HEADER.size :]
        if method == STORED:
            return data
        if method != DEFLATED:
            self.damaged += 1
            return b""
        unpacked = _inflated(data)
        if unpacked is None:
            # where packed data is not cut but wrong, what it unpacks to may be anything
            unpacked = _inflated(data[: max(data.find(ZEROS), 0)])
            self.damaged += 1
        return unpacked or b""

    def _whole(self, data: bytes) -> tuple[bytes, bytes]:
        """The whole objects, one behind the other, and the beginning of the one that goes on."""
        objects: list[bytes] = []
        at = 0
        while (found := data.find(OBJECT, at)) >= 0 and found + OBJECT_HEADER.size <= len(data):
            self.damaged += found - at >= SMALLEST_DAMAGE
            _, header_size, version, size, _ = OBJECT_HEADER.unpack_from(data, found)
            if not SMALLEST.get(version, OBJECT_HEADER.size) <= header_size <= size <= LARGEST:
                self.damaged += 1
                at = found + len(OBJECT)
                continue
            if found + size > len(data):
                return b"".join(objects), data[found:]
            objects.append(data[found : found + size])
            at = found + size
        return b"".join(objects), data[found:] if found >= 0 else b""


class _Sound(io.RawIOBase):
    """Pieces of bytes as a file."""

    def __init__(self, pieces: Iterator[bytes]) -> None:
        super().__init__()
        self._pieces = pieces
        self._held = b""

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: bytearray, /) -> int:  # type: ignore[override]
        while not self._held:
            piece = next(self._pieces, None)
            if piece is None:
                return 0
            self._held = piece
        size = min(len(buffer), len(self._held))
        buffer[:size], self._held = self._held[:size], self._held[size:]
        return size


def _inflated(data: bytes) -> bytes | None:
    """What packed data holds, up to where it is cut; None where it is wrong."""
    try:
        return zlib.decompressobj().decompress(data, LARGEST)
    except zlib.error:
        return None


def _container(data: bytes) -> bytes:
    """A container as python-can reads it; it is followed by as many bytes as it lacks to a word."""
    size = OBJECT_HEADER.size + CONTAINER_HEADER.size + len(data)
    head = OBJECT_HEADER.pack(OBJECT, OBJECT_HEADER.size, 1, size, CONTAINER)
    return head + CONTAINER_HEADER.pack(STORED, len(data)) + data + bytes(size % 4)
