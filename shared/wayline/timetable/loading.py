"""Loads the timetables that a service or a replay is given, and says what is doubtful of them."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from wayline.timetable.model import Timetable
from wayline.timetable.reading import read_timetable


def load_timetable(path: Path) -> Timetable:
    """A feed's timetable. Raises InputError where nothing of it can be used."""
    return read_timetable(path)


def timetable_warnings(
    timetables: Sequence[Timetable], assigned: Sequence[str | None]
) -> Iterator[str]:
    """What was mended of the feeds, ids that several have, trips and blocks that none has."""
    for timetable in timetables:
        yield from (f"{timetable.source} {note}" for note in timetable.notes)
    known = [{trip.trip_id for trip in each.trips} for each in timetables]
    if common := set[str]().union(*(a & b for at, a in enumerate(known) for b in known[:at])):
        shown = f"{len(common):,} trip ids are in two feeds, e.g. {min(common)}"
        yield f"{shown}: place and time decide"
    blocks = {trip.block_id for each in timetables for trip in each.trips}
    for name in assigned:
        if timetables and name and name not in blocks.union(*known):
            yield f"[assignment] {name}: no feed has such a trip or block: it is found"
