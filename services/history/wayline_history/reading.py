"""Reads the history: a track hour by hour, so that a day is never held; trips and events."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

import msgspec
import sqlalchemy as sa

from wayline.keys import FLEET
from wayline.messages import Trip
from wayline_history.chunk import Chunk, decoded, merged
from wayline_history.layouts import LAYOUTS, US, Kind
from wayline_history.records import Event
from wayline_history.tables import CHUNKS, EVENTS, HOUR_US, HOURS, TRIPS, VEHICLES

HOURS_AT_ONCE = 6
"""Read in one go; a reader that takes its time holds up no writer."""


class VehicleKept(NamedTuple):
    """A vehicle of which something is kept, and from when to when, by whole hours."""

    vehicle_id: str
    first_ns: int
    last_ns: int
    chunks: int
    bytes: int


class KeptTrip(NamedTuple):
    """A trip, and whether it is over; one that is not has come so far as yet."""

    vehicle_id: str
    trip: Trip
    is_over: bool


class HistoryReader:
    """Reads from an engine of `open_database(url, "wayline_history")`, in any thread."""

    def __init__(self, engine: sa.Engine) -> None:
        self._engine = engine

    def is_known(self, vehicle_id: str) -> bool:
        """Whether anything was ever kept of a vehicle."""
        return self._number(vehicle_id) is not None

    def vehicles(self) -> list[VehicleKept]:
        """Every vehicle of which rows are kept, by id."""
        hour = CHUNKS.c.hour
        query = (
            sa.select(
                VEHICLES.c.vehicle_id,
                sa.func.min(hour),
                sa.func.max(hour),
                sa.func.count(),
                sa.func.sum(sa.func.length(CHUNKS.c.data)),
            )
            .join_from(CHUNKS, VEHICLES, CHUNKS.c.vehicle_no == VEHICLES.c.vehicle_no)
            .group_by(VEHICLES.c.vehicle_id)
            .order_by(VEHICLES.c.vehicle_id)
        )
        hour_ns = HOUR_US * US
        with self._engine.connect() as connection:
            return [
                VehicleKept(row[0], row[1] * hour_ns, (row[2] + 1) * hour_ns, row[3], int(row[4]))
                for row in connection.execute(query)
            ]

    def newest_ns(self, vehicle_id: str, kind: Kind) -> int | None:
        """The instant of the last row of a vehicle; None where there is none."""
        number = self._number(vehicle_id)
        if number is None:
            return None
        query = sa.select(sa.func.max(CHUNKS.c.hour)).where(
            CHUNKS.c.vehicle_no == number, CHUNKS.c.kind == LAYOUTS[kind].number
        )
        with self._engine.connect() as connection:
            hour = connection.execute(query).scalar()
        if hour is None:
            return None
        (chunk,) = self._hours(number, kind, hour, hour)
        return int(chunk.times_us[-1]) * US

    def rows(self, vehicle_id: str, kind: Kind, from_ns: int, to_ns: int) -> Iterator[Chunk]:
        """The rows of a vehicle from an instant on and before another, an hour or less at a time.

        In order of time, each once, whatever came late or twice.
        """
        number = self._number(vehicle_id)
        if number is None or to_ns <= from_ns:
            return
        from_us, to_us = -(-from_ns // US), -(-to_ns // US)
        hours = self._kept_hours(from_us // HOUR_US, (to_us - 1) // HOUR_US)
        for place in range(0, len(hours), HOURS_AT_ONCE):
            some = hours[place : place + HOURS_AT_ONCE]
            for chunk in self._hours(number, kind, some[0], some[-1]):
                inside = chunk.between(from_us, to_us)
                if len(inside):
                    yield inside

    def trips(self, vehicle_id: str, from_ns: int, to_ns: int) -> list[KeptTrip]:
        """The trips of a vehicle that have a part between two instants, in order of time."""
        number = self._number(vehicle_id)
        if number is None:
            return []
        query = (
            sa.select(VEHICLES.c.vehicle_id, TRIPS.c.data, TRIPS.c.is_over)
            .join_from(TRIPS, VEHICLES, TRIPS.c.vehicle_no == VEHICLES.c.vehicle_no)
            .where(
                TRIPS.c.vehicle_no == number, TRIPS.c.started_ns < to_ns, TRIPS.c.ended_ns > from_ns
            )
            .order_by(TRIPS.c.started_ns)
        )
        with self._engine.connect() as connection:
            return [_kept_trip(*row) for row in connection.execute(query)]

    def trip(self, trip_key: str) -> KeptTrip | None:
        """A trip; None where there is none of that key."""
        query = (
            sa.select(VEHICLES.c.vehicle_id, TRIPS.c.data, TRIPS.c.is_over)
            .join_from(TRIPS, VEHICLES, TRIPS.c.vehicle_no == VEHICLES.c.vehicle_no)
            .where(TRIPS.c.trip_key == trip_key)
        )
        with self._engine.connect() as connection:
            row = connection.execute(query).first()
        return None if row is None else _kept_trip(*row)

    def events(self, vehicle_id: str, from_ns: int, to_ns: int, limit: int) -> list[Event]:
        """What happened to a vehicle and to the fleet's services, in order of time."""
        numbers = [self._number(each) for each in (vehicle_id, FLEET)]
        query = (
            sa.select(EVENTS.c.data)
            .where(
                EVENTS.c.vehicle_no.in_([number for number in numbers if number is not None]),
                EVENTS.c.t_ns >= from_ns,
                EVENTS.c.t_ns < to_ns,
            )
            .order_by(EVENTS.c.t_ns, EVENTS.c.kind, EVENTS.c.name)
            .limit(limit)
        )
        with self._engine.connect() as connection:
            return [msgspec.json.decode(row[0], type=Event) for row in connection.execute(query)]

    def _number(self, vehicle_id: str) -> int | None:
        query = sa.select(VEHICLES.c.vehicle_no).where(VEHICLES.c.vehicle_id == vehicle_id)
        with self._engine.connect() as connection:
            return connection.execute(query).scalar()

    def _kept_hours(self, first: int, last: int) -> Sequence[int]:
        """The hours of which something is kept, of whatever vehicle."""
        query = sa.select(HOURS.c.hour).where(HOURS.c.hour.between(first, last))
        with self._engine.connect() as connection:
            return connection.execute(query.order_by(HOURS.c.hour)).scalars().all()

    def _hours(self, number: int, kind: Kind, first: int, last: int) -> Iterator[Chunk]:
        layout = LAYOUTS[kind]
        query = (
            sa.select(CHUNKS.c.hour, CHUNKS.c.data)
            .where(
                CHUNKS.c.vehicle_no == number,
                CHUNKS.c.kind == layout.number,
                CHUNKS.c.hour.between(first, last),
            )
            .order_by(CHUNKS.c.hour, CHUNKS.c.chunk_no)
        )
        with self._engine.connect() as connection:
            found = connection.execute(query).all()
        for _, rows in groupby(found, lambda row: row[0]):
            chunks = [decoded(layout, row[1]) for row in rows]
            yield chunks[0] if len(chunks) == 1 else merged(layout, chunks)


def _kept_trip(vehicle_id: str, data: bytes, is_over: bool) -> KeptTrip:
    return KeptTrip(vehicle_id, msgspec.json.decode(data, type=Trip), is_over)
