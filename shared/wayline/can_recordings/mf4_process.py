"""Reads one .mf4 and writes its frames to stdout in batches; run by `mf4.py`.

Bounded in time and memory, because a damaged file may ask for any amount of both.
"""

import io
import os
import resource
import sys
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

import can
import msgspec

from wayline.can_recordings.mf4 import SIZE, Batch, Record
from wayline.log_file import LogFile

BATCH = 1000
TIME_S, TIME_S_PER_MB = 30, 30
"""Processor time; a megabyte of compressed frames takes 5 s."""
MEMORY, MEMORY_PER_BYTE = 3 << 30, 64
BUS_EVENT = 0x2
"""Flag of a channel group that holds raw frames."""


def main() -> None:
    """Write the frames of the file that the command line names."""
    out = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    sys.stdout = sys.stderr
    sys.excepthook = last_words(out)
    path = Path(sys.argv[1])
    bound(path.stat().st_size)
    reader = opened(path)
    if has_frames(reader):
        send(records(reader), out)
    else:
        write(out, Batch(has_frames=False))


def last_words(
    out: BinaryIO,
) -> Callable[[type[BaseException], BaseException, TracebackType | None], None]:
    """Tells the reader what ended this process: whatever asammdf makes of a damaged file."""

    def tell(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        del trace
        said = " ".join(str(error).split())
        write(out, Batch(fault=f"{kind.__name__}: {said}"[:160]))

    return tell


def send(messages: Iterator[Record], out: BinaryIO) -> None:
    """Write all batches, and before an exception what had come until then."""
    while True:
        batch: list[Record] = []
        try:
            batch.extend(islice(messages, BATCH))
        finally:
            if batch:
                write(out, Batch(records=batch))
        if len(batch) < BATCH:
            break
    write(out, Batch())


def bound(size: int) -> None:
    """Set this process's limits by the size of the file."""
    seconds = TIME_S + TIME_S_PER_MB * (size >> 20)
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    memory = MEMORY + MEMORY_PER_BYTE * size
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def opened(path: Path) -> can.MF4Reader:
    """python-can's reader of the file, or of what is packed in it."""
    log = LogFile(path)
    if not log.is_packed:
        log.close()
        return can.MF4Reader(path)
    return can.MF4Reader(io.BytesIO(io.BufferedReader(log).read()))


def has_frames(reader: can.MF4Reader) -> bool:
    """Whether any group is a log of a bus."""
    groups = reader._mdf.groups
    return any(group.channel_group.flags & BUS_EVENT for group in groups)


def records(reader: can.MF4Reader) -> Iterator[Record]:
    """Frames as they travel."""
    for message in reader:
        error = "error" if message.is_error_frame else "data"
        yield Record(
            message.timestamp,
            message.channel if isinstance(message.channel, int) else None,
            message.arbitration_id,
            message.is_extended_id,
            bytes(message.data),
            message.is_rx,
            "remote" if message.is_remote_frame else error,
        )


def write(out: BinaryIO, batch: Batch) -> None:
    """Send a batch."""
    body = msgspec.msgpack.encode(batch)
    out.write(SIZE.pack(len(body)) + body)
    out.flush()


if __name__ == "__main__":
    main()
