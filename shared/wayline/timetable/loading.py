"""Loads the timetables that a service or a replay is given, and says what is doubtful of them."""

import datetime as dt
from collections.abc import Iterator, Sequence
from pathlib import Path

from msgspec.structs import replace

from wayline.timetable.keeping import KeptTimetables
from wayline.timetable.model import Timetable
from wayline.timetable.notes import Notes
from wayline.timetable.reading import read_files, read_timetable
from wayline.timetable.tables import FeedFiles
from wayline.timetable.versions import NEVER, superseded_days


def load_timetable(path: Path, database_url: str | None) -> Timetable:
    """A feed's timetable, from the database where it was kept there before, else read and kept.

    Raises InputError where nothing of the feed can be used, or the database cannot be.
    """
    if database_url is None:
        return read_timetable(path)
    notes = Notes()
    files = FeedFiles(path, notes)
    kept = KeptTimetables(database_url)
    try:
        timetable = kept.find(files.fingerprint())
        if timetable is None:
            timetable = read_files(files, notes)
            kept.keep(timetable)
    finally:
        kept.close()
    return replace(timetable, source=str(path))


def timetable_warnings(
    timetables: Sequence[Timetable], assigned: Sequence[str | None]
) -> Iterator[str]:
    """What was mended of the feeds, ids that several have, trips and blocks that none has."""
    for timetable in timetables:
        yield from (f"{timetable.source} {note}" for note in timetable.notes)
    known = [{trip.trip_id for trip in each.trips} for each in timetables]
    superseded = superseded_days(timetables)
    for timetable, day in zip(timetables, superseded, strict=True):
        if day != NEVER:
            newer = f"a newer version counts from {dt.date.fromordinal(day)} on"
            yield f"{timetable.source}: {newer}"
    lasting = [ids for ids, day in zip(known, superseded, strict=True) if day == NEVER]
    if common := set[str]().union(*(a & b for at, a in enumerate(lasting) for b in lasting[:at])):
        shown = f"{len(common):,} trip ids are in two feeds, e.g. {min(common)}"
        yield f"{shown}: place and time decide"
    blocks = {trip.block_id for each in timetables for trip in each.trips}
    for name in assigned:
        if timetables and name and name not in blocks.union(*known):
            yield f"[assignment] {name}: no feed has such a trip or block: it is found"
