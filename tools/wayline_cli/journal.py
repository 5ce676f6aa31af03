"""What the demo's processes say, kept in a file instead of on the screen."""

import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from wayline.errors import InputError


class Journal:
    """Lines of several processes in one file; the last of each is remembered."""

    def __init__(self, path: Path, file: TextIO) -> None:
        self.path, self._file = path, file
        self._lock = threading.Lock()
        self._last: dict[str, str] = {}

    def note(self, name: str, line: str) -> None:
        """Take a line of a process; called from several threads."""
        with self._lock:
            self._last[name] = line
            # a process's own last words may come when the file has been closed
            if not self._file.closed:
                self._file.write(f"{time.strftime('%H:%M:%S')} {name} | {line}\n")
                self._file.flush()

    def last_words(self, names: Iterable[str]) -> list[str]:
        """The last line of each process that has said something."""
        with self._lock:
            return [f"{name}: {self._last[name]}" for name in names if name in self._last]


@contextmanager
def journal_in(folder: Path) -> Iterator[Journal]:
    """A journal in `folder/demo.log`. Raises InputError where it cannot be written."""
    path = folder / "demo.log"
    try:
        file = path.open("w", encoding="utf-8")
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(str(path), reason, "name a folder that can be written") from None
    with file:
        yield Journal(path, file)
