"""Frames of text logs: by python-can's readers, or a line at a time."""

from collections.abc import Callable, Iterator

import can
from can.io.generic import TextIOMessageReader

from wayline.can_recordings.lines import Lines

DAMAGE = (ValueError, IndexError, KeyError, TypeError, OverflowError, can.CanError)
"""What readers raise on lines that hold no frame of theirs."""
Parse = Callable[[str], can.Message | None]
"""A line's frame; None where it is meant to hold none, an exception of DAMAGE where it is torn."""


class ReaderOfLines:
    """One of python-can's readers over the lines that are whole; a damaged one costs itself."""

    is_dated = None
    first_channel = 0

    def __init__(
        self, lines: Lines, reader: type[TextIOMessageReader], *, is_local: bool = False
    ) -> None:
        self._lines = lines
        self._reader = reader(lines)  # type: ignore[arg-type]
        self.is_local = is_local

    @property
    def damaged(self) -> int:
        """Lines and endings that were left out so far."""
        return self._lines.damaged

    def __iter__(self) -> Iterator[can.Message]:
        lines = self._lines
        count = -1
        while not lines.has_ended and lines.count > count:
            count = lines.count
            try:
                for message in self._reader:
                    if is_whole(message):
                        lines.taken()
                        yield message
                    else:
                        lines.refused()
            except DAMAGE:
                lines.refused()
                # the reader begins anew with a header, and takes the first line for a part of it
                lines.push("\n")

    def close(self) -> None:
        """Close the file."""
        self._lines.close()


class LineByLine:
    """Frames of a format whose lines stand each for itself."""

    is_dated = None
    first_channel = 0

    def __init__(self, lines: Lines, parse: Parse, *, is_local: bool = False) -> None:
        self._lines = lines
        self._parse = parse
        self.is_local = is_local

    @property
    def damaged(self) -> int:
        """Lines and endings that were left out so far."""
        return self._lines.damaged

    def __iter__(self) -> Iterator[can.Message]:
        for line in self._lines:
            try:
                message = self._parse(line)
            except DAMAGE:
                self._lines.refused()
                continue
            if message is None:
                continue
            if is_whole(message):
                yield message
            else:
                self._lines.refused()

    def close(self) -> None:
        """Close the file."""
        self._lines.close()


def is_whole(message: can.Message) -> bool:
    """Whether a frame has the bytes that its length says: a torn line has fewer."""
    if message.is_error_frame or message.is_remote_frame:
        return True
    held = len(message.data)
    return held == message.dlc or (held == 8 and message.dlc > 8 and not message.is_fd)
