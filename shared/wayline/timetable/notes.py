"""Pure: what was mended in a feed, what was marked, and what of it cannot be used."""

from collections.abc import Sequence
from typing import Literal

import msgspec

Kind = Literal["mended", "marked", "unusable"]
SHOWN = 3
"""Places that a note names; the rest is a number."""


class Note(msgspec.Struct, frozen=True, array_like=True):
    """One fault of a feed, with the rows that have it."""

    kind: Kind
    """Mended: used as if it were right. Marked: used as it is. Unusable: left out."""
    file: str
    fault: str
    places: tuple[str, ...]
    """The first few: a row by its line in the file, or what the fault is about."""
    count: int

    def __str__(self) -> str:
        more = f" and {self.count - len(self.places):,} more" if self.count > SHOWN else ""
        where = f" ({', '.join(self.places)}{more})" if self.places else ""
        return f"{self.file}: {self.fault}{where}: {self.kind}"


class Notes:
    """Gathers notes; a fault that many rows have is one note."""

    def __init__(self, notes: Sequence[Note] = ()) -> None:
        self._notes = {(note.kind, note.file, note.fault): note for note in notes}

    def add(self, kind: Kind, file: str, fault: str, *places: str, count: int = 0) -> None:
        """Note a fault; `count` where there are more places than are given."""
        key = (kind, file, fault)
        old = self._notes.get(key, Note(kind, file, fault, (), 0))
        known = (*old.places, *places)[:SHOWN]
        self._notes[key] = Note(kind, file, fault, known, old.count + (count or len(places)))

    def add_rows(self, kind: Kind, file: str, fault: str, lines: Sequence[int]) -> None:
        """Note a fault of the rows on these lines of a file; none is no fault."""
        if len(lines):
            places = [f"row {int(line)}" for line in lines[:SHOWN]]
            self.add(kind, file, fault, *places, count=len(lines))

    def all(self) -> tuple[Note, ...]:
        """Every note, in the order in which their faults were met."""
        return tuple(self._notes.values())
