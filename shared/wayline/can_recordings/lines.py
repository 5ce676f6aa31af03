"""Lines of a text log, those that a power loss damaged left out."""

import io
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from wayline.log_file import HEAD, LogFile, encoding_of

LONGEST = 4096
"""Characters; a frame of 64 bytes takes 300."""
HALF_BYTE = re.compile(r"[\s,;x][0-9A-Fa-f]$")
"""How a line ends that was cut within its last byte: the half of it would be another byte."""


class Lines:
    """Iterates over the lines of a log, as a text file does; python-can's readers take it for one.

    `damaged` counts what is left out: lines with zeros in them, overlong ones, a last one that is
    cut within a byte, a packed log's end that cannot be unpacked, and those that `is_torn` says
    are a frame's though no frame was `taken` from them.
    """

    def __init__(self, path: Path, is_torn: Callable[[str], bool] = lambda _: False) -> None:
        self._log = LogFile(path)
        buffered = io.BufferedReader(self._log, buffer_size=1 << 17)
        encoding = encoding_of(buffered.peek(HEAD)[:HEAD])
        self._text = io.TextIOWrapper(buffered, encoding=encoding, errors="replace")
        self._is_torn = is_torn
        self._open: str | None = None
        self._pushed: list[str] = []
        self.damaged = 0
        self.count = 0
        self.has_ended = False

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        if self._open is not None:
            self.damaged += self._is_torn(self._open)
            self._open = None
        if self._pushed:
            self._open = self._pushed.pop()
            return self._open
        while line := self._text.readline(LONGEST):
            if self._is_overlong(line) or "\0" in line or is_cut(line):
                self.damaged += 1
            else:
                self._open = line
                self.count += 1
                return line
        if not self.has_ended:
            self.has_ended = True
            self.damaged += self._log.is_broken
        raise StopIteration

    def taken(self) -> None:
        """A frame came of the last line."""
        self._open = None

    def refused(self) -> None:
        """Nothing can be made of the last line."""
        self._open = None
        self.damaged += 1

    def push(self, line: str) -> None:
        """Let this be the next line, in place of the last one or after it."""
        self._open = None
        self._pushed.append(line)

    def close(self) -> None:
        """Close the file."""
        self._text.close()

    def _is_overlong(self, line: str) -> bool:
        """Read on to the end of a line that has none; what is no text may have no lines at all."""
        if len(line) < LONGEST or line.endswith("\n"):
            return False
        while line and not line.endswith("\n"):
            line = self._text.readline(LONGEST)
        return True


def is_cut(line: str) -> bool:
    """Whether a line ends the file within a byte."""
    return not line.endswith("\n") and HALF_BYTE.search(line) is not None
