"""Reads CAN recordings, whatever format python-can's LogReader opens."""

import sys
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import can
from can.io.generic import MessageReader, TextIOMessageReader

from wayline.errors import InputError
from wayline.inputs import Frame

Reader = Iterator[can.Message]
FORMATS = "a CAN recording: .log .asc .blf .trc .csv .mf4, or one of these with .gz"
DAMAGED = (ValueError, IndexError, KeyError, TypeError, EOFError, zlib.error, can.CanError)
"""What python-can's readers raise on damaged lines and records."""


class CanLog:
    """Frames of one or more recordings in order; error, remote and self-sent frames left out.

    `bad_input` counts damaged lines, which are skipped, and recordings that end in damage.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self.paths = tuple(paths)
        self.bad_input = 0

    def __iter__(self) -> Iterator[Frame]:
        for path in self.paths:
            for message in self._messages(path):
                if message.is_error_frame or message.is_remote_frame or not message.is_rx:
                    continue
                yield Frame(
                    round(message.timestamp * 1e6) * 1000,
                    str(message.channel),
                    message.arbitration_id,
                    message.is_extended_id,
                    bytes(message.data),
                )

    def _messages(self, path: Path) -> Reader:
        reader = _open(path)
        try:
            yield from self._resumed(iter(reader), reader)
        except OSError as error:
            raise InputError(str(path), f"cannot be read ({error})", f"give {FORMATS}") from None
        finally:
            reader.stop()

    def _resumed(self, messages: Reader, reader: MessageReader) -> Reader:
        """Go on behind a damaged line of a text log; a damaged binary log ends there."""
        while True:
            try:
                yield from messages
            except _damage():
                self.bad_input += 1
                if not isinstance(reader, TextIOMessageReader):
                    return
                messages = iter(reader)
            else:
                return


def _open(path: Path) -> MessageReader:
    try:
        if path.suffix == ".mf4" and not _magic(path).startswith((b"MDF", b"UnFinMF")):
            raise ValueError("is no MDF file")
        return can.LogReader(path)
    except FileNotFoundError:
        raise InputError(str(path), "no such file", "check the path") from None
    except (OSError, NotImplementedError) as error:
        raise InputError(str(path), str(error), f"give {FORMATS}") from None
    except _damage() as error:
        raise InputError(str(path), str(error), f"give {FORMATS}") from None


def _damage() -> tuple[type[Exception], ...]:
    """Exceptions that mean damage; asammdf's own only exists once an MF4 file was opened."""
    asammdf = sys.modules.get("asammdf.blocks.utils")
    return DAMAGED if asammdf is None else (*DAMAGED, asammdf.MdfException)


def _magic(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(7)
