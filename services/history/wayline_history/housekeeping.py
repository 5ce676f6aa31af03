"""What is done with the history as it ages: chunks joined, poses thinned, the oldest let go."""

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

import sqlalchemy as sa

from wayline.database import write_transaction
from wayline_history.chunk import Chunk, decoded, encoded, merged
from wayline_history.layouts import BY_NUMBER, LAYOUTS, POSES, Layout
from wayline_history.store import AS_IT_CAME, ROW_BYTES, SETTLED, THINNED, partition
from wayline_history.tables import CHUNKS, DAY_HOURS, EVENTS, HOURS, TRIPS, VEHICLES
from wayline_history.thinning import thinned

SETTLES_AFTER_S = 600
"""An hour of which nothing has come so long is over."""
MEGABYTE = 1_000_000


class Limits(NamedTuple):
    """How long and how much is kept."""

    days: float
    """After something of an hour has come last."""
    megabytes: float
    thins_after_s: float


class Hour(NamedTuple):
    """An hour that something is kept of."""

    hour: int
    bytes: int
    written_s: int
    state: int


class Housekeeping:
    """Does a little each time it is asked, so that nobody who writes meanwhile waits for long."""

    def __init__(self, engine: sa.Engine, limits: Limits, clock_s: Callable[[], float]) -> None:
        self._engine, self._limits, self._clock_s = engine, limits, clock_s
        self._ageing: Iterator[None] = iter(())

    def turn(self, patience_s: float, elapsed_s: Callable[[], float]) -> None:
        """Work for so long by a clock that only goes forward."""
        ends_s = elapsed_s() + patience_s
        self.let_go()
        while elapsed_s() < ends_s:
            if next(self._ageing, self) is self:
                self._ageing = self._aged()
                if next(self._ageing, self) is self:
                    break

    def finish(self) -> None:
        """Do all that there is to do now."""
        self.let_go()
        for _ in self._aged():
            pass

    def let_go(self) -> bool:
        """Remove the hours that are too old, then the oldest while all take too much room."""
        hours = self._hours()
        oldest_s = self._clock_s() - self._limits.days * 86_400.0
        room = self._limits.megabytes * MEGABYTE - sum(each.bytes for each in hours)
        going = []
        for each in hours:
            is_old = max(each.written_s, (each.hour + 1) * 3600) < oldest_s
            # the hour that is being written is never taken from under its writer
            is_too_much = room < 0.0 and each is not hours[-1]
            if is_old or is_too_much:
                going.append(each.hour)
                room += each.bytes
        if going:
            self._remove(going, {each.hour for each in hours})
        return bool(going)

    def _hours(self) -> list[Hour]:
        columns = [HOURS.c[name] for name in Hour._fields]
        with self._engine.connect() as connection:
            found = connection.execute(sa.select(*columns).order_by(HOURS.c.hour))
            return [Hour(*row) for row in found]

    def _remove(self, hours: Sequence[int], all_hours: set[int]) -> None:
        with write_transaction(self._engine) as connection:
            for day, group in groupby(hours, lambda hour: hour // DAY_HOURS):
                going = list(group)
                stays = {hour for hour in all_hours - set(hours) if hour // DAY_HOURS == day}
                if connection.dialect.name == "postgresql" and not stays:
                    connection.exec_driver_sql(f"DROP TABLE IF EXISTS {partition(day)}")
                else:
                    connection.execute(sa.delete(CHUNKS).where(*_of_hours(going)))
                for table in (EVENTS, TRIPS, HOURS):
                    connection.execute(sa.delete(table).where(table.c.hour.in_(going)))

    def _aged(self) -> Iterator[None]:
        """Join and thin what is due; a pause after each vehicle's hour."""
        now_s = self._clock_s()
        for each in self._hours():
            quiet_s = now_s - max(each.written_s, min((each.hour + 1) * 3600, now_s))
            if each.state == AS_IT_CAME and quiet_s >= SETTLES_AFTER_S:
                yield from self._age(each, SETTLED)
            elif each.state == SETTLED and quiet_s >= self._limits.thins_after_s:
                yield from self._age(each, THINNED)

    def _age(self, hour: Hour, state: int) -> Iterator[None]:
        with self._engine.connect() as connection:
            numbers = connection.execute(sa.select(VEHICLES.c.vehicle_no)).scalars().all()
        kinds = LAYOUTS.values() if state == SETTLED else (POSES,)
        for number in numbers:
            for layout in kinds:
                self._rewrite(hour.hour, number, layout, state)
            yield
        with write_transaction(self._engine) as connection:
            # unless something came meanwhile
            same = HOURS.c.written_s == hour.written_s
            done = sa.update(HOURS).where(HOURS.c.hour == hour.hour, same).values(state=state)
            connection.execute(done)

    def _rewrite(self, hour: int, number: int, layout: Layout, state: int) -> None:
        """One chunk in place of those of a vehicle's hour; no reader sees both or none."""
        query = sa.select(CHUNKS.c.chunk_no, CHUNKS.c.data).where(
            CHUNKS.c.vehicle_no == number, CHUNKS.c.kind == layout.number, CHUNKS.c.hour == hour
        )
        with self._engine.connect() as connection:
            found = connection.execute(query.order_by(CHUNKS.c.chunk_no)).all()
        if not found or (len(found) == 1 and state == SETTLED):
            return
        chunk = _joined(layout, [row[1] for row in found])
        data = encoded(thinned(chunk) if state == THINNED else chunk)
        former = [row[0] for row in found]
        saved = sum(len(row[1]) + ROW_BYTES for row in found) - len(data) - ROW_BYTES
        with write_transaction(self._engine) as connection:
            connection.execute(
                sa.delete(CHUNKS).where(CHUNKS.c.hour == hour, CHUNKS.c.chunk_no.in_(former))
            )
            connection.execute(
                sa.insert(CHUNKS)
                .inline()
                .values(hour=hour, vehicle_no=number, kind=layout.number, data=data)
            )
            connection.execute(
                sa.update(HOURS).where(HOURS.c.hour == hour).values(bytes=HOURS.c.bytes - saved)
            )


def _of_hours(hours: Sequence[int]) -> list[sa.ColumnElement[bool]]:
    """Conditions of chunks that the index by vehicle serves."""
    return [
        CHUNKS.c.vehicle_no.in_(sa.select(VEHICLES.c.vehicle_no)),
        CHUNKS.c.kind.in_(list(BY_NUMBER)),
        CHUNKS.c.hour.in_(hours),
    ]


def _joined(layout: Layout, data: Sequence[bytes]) -> Chunk:
    chunks = [decoded(layout, each) for each in data]
    return chunks[0] if len(chunks) == 1 else merged(layout, chunks)
