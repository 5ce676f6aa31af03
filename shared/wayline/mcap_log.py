"""MCAP files of the bus: what was published, when it arrived, and the schemas to read it by.

One channel a key (its topic is the key itself, so that playing back restores it), JSON payloads
as they were on the bus, `publish_time` the message's `t_ns`, `log_time` its arrival. Chunks are
compressed with zstd. Every second what has arrived is handed to the operating system, so a file
whose writer was killed lacks at most that second and the index, and reads like any other here
(other tools may want `mcap recover` first).
"""

import io
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Self

import msgspec
import zstandard
from mcap.exceptions import EndOfFile, InvalidMagic, McapError
from mcap.records import Channel, McapRecord
from mcap.records import Message as McapMessage
from mcap.stream_reader import StreamReader
from mcap.well_known import MessageEncoding
from mcap.writer import CompressionType, Writer

from wayline import __version__
from wayline.codec import decode, encode
from wayline.errors import InputError
from wayline.keys import current_key, message_key, parse_key
from wayline.mcap_schema import SCHEMA_ENCODING, schema_json, schema_name
from wayline.messages import TOPICS, Message

PROFILE = "wayline"
FLUSH_NS = 1_000_000_000
_MAGIC = b"\x89MCAP0\r\n"
# what the reader and the decompressors raise for bytes that are not what they should be
_DAMAGE = (McapError, ValueError, RuntimeError, struct.error, zstandard.ZstdError)


class McapWriter:
    """Writes one file; closing it adds the index that viewers use to seek.

    Raises InputError when the file cannot be made, OSError when it cannot be written any more.
    """

    def __init__(self, path: Path) -> None:
        try:
            self._file = path.open("wb")
        except OSError as error:
            mend = "name a file in a folder that you may write to"
            raise InputError(str(path), f"cannot be made ({error.strerror})", mend) from None
        self._writer = Writer(self._file, compression=CompressionType.ZSTD)
        self._writer.start(profile=PROFILE, library=f"wayline {__version__}")
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._sequences: dict[str, int] = {}
        self._flushed_ns = 0

    def write(self, vehicle_id: str, source: str, message: Message, log_time_ns: int) -> None:
        """Add one message that arrived at a Unix time in ns."""
        key = message_key(vehicle_id, message.topic, source)
        self.write_payload(key, message.topic, encode(message), message.t_ns, log_time_ns)

    def write_payload(
        self, key: str, topic: str, payload: bytes, t_ns: int, log_time_ns: int
    ) -> None:
        """Add a payload as it was on the bus, fields that this version does not know included."""
        sequence = self._sequences.get(key, 0)
        self._sequences[key] = sequence + 1
        self._writer.add_message(
            channel_id=self._channel(key, topic),
            log_time=log_time_ns,
            data=payload,
            publish_time=t_ns,
            sequence=sequence,
        )
        # a clock that steps back must not hold the bytes for as long as it stepped
        if not 0 <= log_time_ns - self._flushed_ns < FLUSH_NS:
            self._writer.flush()  # type: ignore[no-untyped-call]  # mcap has not typed it
            self._flushed_ns = log_time_ns

    def close(self) -> None:
        """Write the last chunk and the index."""
        if self._file.closed:
            return
        try:
            self._writer.finish()  # type: ignore[no-untyped-call]  # mcap has not typed it
        finally:
            self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _channel(self, key: str, topic: str) -> int:
        if key not in self._channels:
            self._channels[key] = self._writer.register_channel(
                topic=key, message_encoding=MessageEncoding.JSON, schema_id=self._schema(topic)
            )
        return self._channels[key]

    def _schema(self, topic: str) -> int:
        if topic not in self._schemas:
            message = TOPICS[topic]
            self._schemas[topic] = self._writer.register_schema(
                name=schema_name(message), encoding=SCHEMA_ENCODING, data=schema_json(message)
            )
        return self._schemas[topic]


def read_records(path: Path) -> Iterator[tuple[int, str, bytes]]:
    """(log_time_ns, key, payload) of every message of ours, in the order of the file.

    A file that ends abruptly gives what it holds. Raises InputError for a file that is missing,
    damaged, no MCAP or without any channel of ours.
    """
    ours: dict[int, str] = {}
    foreign = 0
    for record in _records(path):
        if isinstance(record, Channel):
            if _is_ours(record):
                ours[record.id] = current_key(record.topic)
            else:
                foreign += 1
        elif isinstance(record, McapMessage) and record.channel_id in ours:
            yield record.log_time, ours[record.channel_id], bytes(record.data)
    if foreign and not ours:
        raise InputError(str(path), "holds no Wayline messages", "name one from wayline record")


def read_messages(
    path: Path, *, refused: Callable[[str], None] | None = None
) -> Iterator[tuple[str, str, Message]]:
    """(vehicle_id, source, message) of every message of ours, in the order of the file.

    A payload that does not fit its topic is left out and its key given to `refused`.
    Raises InputError as `read_records` does.
    """
    for _, key, payload in read_records(path):
        parts = parse_key(key)
        if parts is None:
            continue
        try:
            message = decode(parts.topic, payload)
        except msgspec.DecodeError:
            if refused is not None:
                refused(key)
            continue
        yield parts.vehicle_id, parts.source, message


def is_finished(path: Path) -> bool:
    """Whether the file's writer closed it; False for one that ends abruptly.

    Raises InputError for a file that cannot be opened.
    """
    with _opened(path) as file:
        size = file.seek(0, io.SEEK_END)
        file.seek(max(size - len(_MAGIC), 0))
        return size > len(_MAGIC) and file.read(len(_MAGIC)) == _MAGIC


def _is_ours(channel: Channel) -> bool:
    is_json = channel.message_encoding == MessageEncoding.JSON
    return is_json and parse_key(current_key(channel.topic)) is not None


class _WholeReads(io.BufferedReader):
    """A file that gives all the bytes asked for or says that it ended.

    The mcap reader would take a record cut short for a whole one, and ask for as much memory as a
    damaged length says.
    """

    def __init__(self, file: io.FileIO) -> None:
        super().__init__(file)
        self._size = self.seek(0, io.SEEK_END)
        self.seek(0)

    def read(self, size: int | None = -1, /) -> bytes:
        if size is not None and size > self._size - self.tell():
            raise EndOfFile
        return super().read(size)


def _opened(path: Path) -> io.FileIO:
    try:
        return io.FileIO(path)
    except FileNotFoundError:
        raise InputError(str(path), "no such file", "check the path") from None
    except OSError as error:
        mend = "name a file that you may read"
        raise InputError(str(path), f"cannot be read ({error.strerror})", mend) from None


def _records(path: Path) -> Iterator[McapRecord]:
    finished = is_finished(path)
    with _WholeReads(_opened(path)) as file:
        records = StreamReader(file, validate_crcs=True).records
        while True:
            try:
                record = next(records, None)
            except (InvalidMagic, EndOfFile) as error:
                if file.tell() <= len(_MAGIC):
                    mend = "name a file from wayline record"
                    raise InputError(str(path), "is no MCAP file", mend) from None
                if finished or isinstance(error, InvalidMagic):
                    raise _damaged(path, file.tell()) from error
                return
            except _DAMAGE as error:
                raise _damaged(path, file.tell()) from error
            if record is None:
                return
            yield record


def _damaged(path: Path, position: int) -> InputError:
    what = f"is damaged before byte {position}"
    return InputError(str(path), what, "use another copy, or mend it with `mcap recover`")
