"""The history's tables for a `PatientStore`: keeps in batches, tidies up in between."""

import time
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import msgspec
import sqlalchemy as sa

from wayline.core import Record
from wayline.host_clock import told_ns
from wayline.keys import FLEET
from wayline.spool import Waiting
from wayline_history.chunk import Chunk
from wayline_history.core import PIECE_NS
from wayline_history.housekeeping import Housekeeping, Limits
from wayline_history.layouts import SOURCE, US
from wayline_history.losses import Losses
from wayline_history.points import shown
from wayline_history.reading import HistoryReader
from wayline_history.records import Event, Piece
from wayline_history.samples import fix_of
from wayline_history.store import Alive, HistoryStore
from wayline_history.travelled import SourcedFix
from wayline_history.trip_cutter import SILENCE_NS

GAP_NS = 5_000_000_000
"""What may not have been kept for less is told of nowhere."""
ALIVE_S = 60.0
"""How often is noted that the history is kept, where nothing comes."""
TIDY_EVERY_S = 10.0
TIDY_FOR_S = 0.2
RESUMED_NS = 12 * 3_600_000_000_000
"""A trip that began earlier is cut where the history was started anew."""


class UnderWay(NamedTuple):
    """Of a trip that may still be under way."""

    rows: Sequence[Sequence[int]] = ()
    """Of its poses."""
    fixes: Sequence[SourcedFix] = ()
    refused_ns: Sequence[int] = ()
    """When measurements were refused."""


class Openings:
    """What a process knows of its tables from before they were opened anew."""

    def __init__(self) -> None:
        self.well_ns: int | None = None
        """When they were last in order; None before they were opened for the first time."""


class HistoryTables:
    """What the store's thread does with the history."""

    def __init__(
        self, engine: sa.Engine, limits: Limits, losses: Losses, openings: Openings
    ) -> None:
        self._store = HistoryStore(engine, time.time)
        self._reader = HistoryReader(engine)
        self._housekeeping = Housekeeping(engine, limits, time.time)
        self._losses, self._openings = losses, openings
        self._is_opened = False
        self._alive_ns = 0
        self._tidied_s = -TIDY_EVERY_S

    def save(self, vehicle_id: str, record: Record) -> Sequence[msgspec.Struct]:
        """Keep one piece."""
        self._keep([(vehicle_id, record)])
        return ()

    def save_all(self, batch: Sequence[Waiting]) -> Sequence[msgspec.Struct]:
        """Keep many pieces at once."""
        self._keep([(each.vehicle_id, each.record) for each in batch])
        return ()

    def look(self) -> Sequence[msgspec.Struct]:
        """Tell of gaps, and let the history age; nobody has to be told anything."""
        gaps = self._losses.take()
        try:
            if gaps or not self._is_opened or told_ns() - self._alive_ns > ALIVE_S * 1e9:
                self._keep(gaps)
        except sa.exc.DBAPIError:
            self._losses.put_back(gaps)
            raise
        self._tidy()
        self._openings.well_ns = told_ns()
        return ()

    def under_way(self, vehicle_id: str) -> UnderWay:
        """What is kept of a trip that may still be under way; nothing where none can be."""
        newest_ns = self._reader.newest_ns(vehicle_id, "fused")
        if newest_ns is None:
            return UnderWay()
        span = newest_ns - RESUMED_NS, newest_ns + US
        rows: list[Sequence[int]] = []
        for row in _rows(self._reader.rows(vehicle_id, "fused", *span)):
            if rows and row[0] - rows[-1][0] > SILENCE_NS // US:
                rows = []
            rows.append(row)
        since = rows[0][0] * US, span[1] + US
        fixes = [
            SourcedFix(source, fix_of(row))
            for chunk in self._reader.rows(vehicle_id, "raw", *since)
            for source, row in zip(shown(chunk, SOURCE), chunk.values.tolist(), strict=True)
        ]
        refused = _rows(self._reader.rows(vehicle_id, "refused", *since))
        return UnderWay(rows, fixes, [row[0] * US for row in refused])

    def _keep(self, records: Sequence[tuple[str, Record]]) -> None:
        alive_ns = told_ns()
        pieces = [(vehicle_id, each) for vehicle_id, each in records if isinstance(each, Piece)]
        is_whole = any(piece.is_last for _, piece in pieces)
        if not self._is_opened and (gap := self._gap(alive_ns)) is not None:
            pieces.append((FLEET, Piece(events=(gap,))))
        self._store.save(pieces, Alive(alive_ns, is_whole))
        self._alive_ns = self._openings.well_ns = alive_ns
        self._is_opened = True

    def _gap(self, now_ns: int) -> Event | None:
        """The time in which nothing was kept, before the tables were opened."""
        since_ns, detail = self._openings.well_ns, "the database was away or full"
        if since_ns is None:
            alive = self._store.alive()
            if alive is None:
                return None
            # what was on its way when the process was killed is lost too
            since_ns = alive.t_ns - (0 if alive.is_whole else PIECE_NS)
            detail = "history was not running"
        if now_ns - since_ns < GAP_NS:
            return None
        return Event(t_ns=since_ns, until_ns=now_ns, kind="gap", name="history", detail=detail)

    def _tidy(self) -> None:
        now_s = time.monotonic()
        if now_s - self._tidied_s < TIDY_EVERY_S:
            return
        self._housekeeping.turn(TIDY_FOR_S, time.monotonic)
        self._tidied_s = time.monotonic()


def _rows(chunks: Iterable[Chunk]) -> Iterator[Sequence[int]]:
    for chunk in chunks:
        yield from chunk.values.tolist()
