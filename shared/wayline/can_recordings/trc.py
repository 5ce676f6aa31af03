"""PEAK's .trc: the versions that python-can reads, and 1.2, which it takes for 1.0."""

import re
from pathlib import Path

import can

from wayline.can_recordings.lines import Lines
from wayline.can_recordings.reading import Reading
from wayline.can_recordings.text import ReaderOfLines
from wayline.errors import UnreadableError

VERSION = re.compile(r"^;\s*\$FILEVERSION\s*=\s*([\d.]+)", re.MULTILINE | re.IGNORECASE)
VERSIONS = ("1.0", "1.1", "1.2", "1.3", "2.0", "2.1")
OTHER = re.compile(
    r"\s*(?:;|$|\d+\)?\s+[\d.]+\s+(?:\d+\s+)?(?:Warng|Error|ST|EC|ER|EV|FFFFFFFF)\b)"
)
"""What python-can passes over: remarks, states of the bus."""
UP_TO_IDENTIFIER = re.compile(r"(\s*\d+\)\s+[\d.]+\s+\d+\s+[RT]x\s+[0-9A-Fa-f]+)\s")


class Lines12(Lines):
    """Lines of version 1.2 as those of 1.3, which has one column more."""

    def __next__(self) -> str:
        line = super().__next__()
        if line.startswith(";"):
            return VERSION.sub(";$FILEVERSION=1.3", line)
        return UP_TO_IDENTIFIER.sub(r"\1 - ", line)


def open_trc(path: Path, head: str) -> Reading:
    """A reader for a file with this beginning. Raises UnreadableError for an unknown version."""
    found = VERSION.search(head)
    version = found[1] if found else "1.0"
    if version not in VERSIONS:
        mend = "save it as version 2.1 or earlier"
        raise UnreadableError(str(path), f"is a .trc of version {version}, not read", mend)
    kind = Lines12 if version == "1.2" else Lines
    lines = kind(path, lambda line: OTHER.match(line) is None)
    return ReaderOfLines(lines, can.TRCReader, is_local=True)
