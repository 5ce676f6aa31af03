"""Pure: trips and events as HTTP tells them. Times are RFC 3339 UTC with milliseconds."""

from collections.abc import Sequence

import msgspec

from wayline.messages import Trip
from wayline.rfc3339 import rfc3339
from wayline_history.records import Event, EventKind


class StopAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """Where a vehicle stood on its way."""

    started: str
    dwell_s: float
    lat_deg: float
    lon_deg: float


class TripAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """A trip; unknown is null."""

    trip_key: str
    vehicle_id: str
    started: str
    ended: str
    """Of one that is under way: how far it is known to have come."""
    under_way: bool
    seconds: float
    distance_m: float
    distance_std_m: float
    climb_m: float | None
    climb_std_m: float | None
    moving_s: float
    max_speed_mps: float
    start_lat_deg: float | None
    start_lon_deg: float | None
    end_lat_deg: float | None
    end_lon_deg: float | None
    rejected: int
    outage_s: float
    stops: tuple[StopAnswer, ...]


class TripList(msgspec.Struct, frozen=True):
    """Trips in order of time."""

    trips: tuple[TripAnswer, ...]


class EventAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """Something that happened; `until` of what lasted, null while it goes on."""

    t: str
    until: str | None
    kind: EventKind
    name: str
    count: int | None
    lat_deg: float | None
    lon_deg: float | None
    detail: str | None


class EventList(msgspec.Struct, frozen=True, kw_only=True):
    """Events in order of time; `next` is from when on there are more, or null."""

    vehicle_id: str
    events: tuple[EventAnswer, ...]
    next: str | None


def trip_answer(vehicle_id: str, trip: Trip, is_over: bool) -> TripAnswer:
    """A trip with its times as text."""
    as_they_are = {
        name: getattr(trip, name)
        for name in TripAnswer.__struct_fields__
        if name in Trip.__struct_fields__ and name != "stops"
    }
    return TripAnswer(
        **as_they_are,
        vehicle_id=vehicle_id,
        under_way=not is_over,
        started=rfc3339(trip.started_ns),
        ended=rfc3339(trip.ended_ns),
        seconds=round((trip.ended_ns - trip.started_ns) * 1e-9, 3),
        stops=tuple(
            StopAnswer(
                started=rfc3339(stop.started_ns),
                dwell_s=stop.dwell_s,
                lat_deg=stop.lat_deg,
                lon_deg=stop.lon_deg,
            )
            for stop in trip.stops
        ),
    )


def event_list(vehicle_id: str, events: Sequence[Event], limit: int) -> EventList:
    """The first events of a list, and where it goes on."""
    rest = events[limit:]
    return EventList(
        vehicle_id=vehicle_id,
        events=tuple(map(_event, events[:limit])),
        next=rfc3339(rest[0].t_ns) if rest else None,
    )


def _event(event: Event) -> EventAnswer:
    return EventAnswer(
        t=rfc3339(event.t_ns),
        until=None if event.until_ns is None else rfc3339(event.until_ns),
        kind=event.kind,
        name=event.name,
        count=event.count,
        lat_deg=event.lat_deg,
        lon_deg=event.lon_deg,
        detail=event.detail,
    )
