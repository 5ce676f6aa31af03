"""ASAM MDF 4 (.mf4), read by asammdf in a process of its own.

A damaged file sends asammdf round in circles, asks for more memory than there is, or leaves it
with half an object whose end is a traceback. A process can be bounded in time and memory; what it
has read before it ends is kept.
"""

import io
import os
import struct
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import can
import msgspec

from wayline.errors import UnreadableError
from wayline.log_file import LogFile

MAGIC = (b"MDF     ", b"UnFinMF ")
VERSION = slice(8, 16)
HEADER_BLOCK = struct.Struct("<QhhB")
"""Of the block HD: start in Unix ns, minutes of zone and of summer time, flags."""
HEADER_BLOCK_AT = 64 + 24 + 6 * 8
DATED_FROM_NS = 315_532_800 * 1_000_000_000
"""1980, as for every recording."""
LOCAL = 0x01
"""The start is by the clock on the wall."""
SIZE = struct.Struct("<L")
MEND = "save it anew, or give another recording"


class Record(msgspec.Struct, array_like=True, frozen=True, gc=False):
    """A frame on its way from the process that reads it."""

    t_s: float
    channel: int | None
    arbitration_id: int
    extended: bool
    data: bytes
    is_rx: bool
    kind: str
    """`data`, `error` or `remote`."""


class Batch(msgspec.Struct, array_like=True, frozen=True):
    """Records, or why there are no more."""

    records: list[Record] = []
    fault: str = ""
    has_frames: bool = True
    """Whether the file has groups of raw frames at all."""


class Mf4:
    """Frames of an .mf4 in order of time."""

    first_channel = 0

    def __init__(self, path: Path) -> None:
        self._path = path
        self.damaged = 0
        head = _head(path)
        if head[VERSION][:1] not in (b"4", b"\0"):
            version = head[VERSION].split(b"\0")[0].decode("latin-1").strip()
            raise UnreadableError(str(path), f"is MDF {version}, not 4", "save it as MDF 4 (.mf4)")
        start_ns, flags = _start(head)
        self.is_local = bool(flags & LOCAL)
        self.is_dated = start_ns >= DATED_FROM_NS

    def __iter__(self) -> Iterator[can.Message]:
        command = [sys.executable, "-m", "wayline.can_recordings.mf4_process", str(self._path)]
        pipe = subprocess.PIPE
        environment = {**os.environ, "TZ": "UTC"}
        with subprocess.Popen(  # noqa: S603 the interpreter that runs this, and a path
            command, stdin=subprocess.DEVNULL, stdout=pipe, stderr=subprocess.DEVNULL,
            env=environment,
        ) as process:  # fmt: skip
            try:
                if process.stdout is not None:
                    yield from self._messages(process.stdout)
            finally:
                process.kill()

    def close(self) -> None:
        """The process ends with the iteration."""

    def _messages(self, stream: IO[bytes]) -> Iterator[can.Message]:
        count = 0
        fault = "the process that read it ended: it is damaged, or too large for this machine"
        for batch in _batches(stream):
            for record in batch.records:
                count += 1
                yield message_of(record)
            if not batch.records:
                fault = batch.fault
                if not batch.has_frames:
                    mend = "give a bus log; what is decoded already cannot be mapped"
                    raise UnreadableError(str(self._path), "holds no raw CAN frames", mend)
        if fault and not count:
            raise UnreadableError(str(self._path), f"cannot be read ({fault})", MEND)
        self.damaged += bool(fault)


def _batches(stream: IO[bytes]) -> Iterator[Batch]:
    decode = msgspec.msgpack.Decoder(Batch).decode
    while len(head := stream.read(SIZE.size)) == SIZE.size:
        (size,) = SIZE.unpack(head)
        body = stream.read(size)
        if len(body) < size:
            return
        yield decode(body)


def message_of(record: Record) -> can.Message:
    """As python-can would have it."""
    return can.Message(
        timestamp=record.t_s,
        channel=record.channel,
        arbitration_id=record.arbitration_id,
        is_extended_id=record.extended,
        data=record.data,
        is_rx=record.is_rx,
        is_error_frame=record.kind == "error",
        is_remote_frame=record.kind == "remote",
    )


def _head(path: Path) -> bytes:
    with LogFile(path) as log:
        return io.BufferedReader(log).read(HEADER_BLOCK_AT + HEADER_BLOCK.size)


def _start(head: bytes) -> tuple[int, int]:
    """Unix ns of the beginning, and what kind of time that is."""
    if len(head) < HEADER_BLOCK_AT + HEADER_BLOCK.size:
        return 0, 0
    start_ns, _, _, flags = HEADER_BLOCK.unpack_from(head, HEADER_BLOCK_AT)
    return start_ns, flags
