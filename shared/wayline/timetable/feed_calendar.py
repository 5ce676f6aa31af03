"""Services of a feed: the week of calendar.txt and the days of calendar_dates.txt."""

import datetime as dt

import polars as pl

from wayline.timetable.calendar import Service
from wayline.timetable.clock_times import ordinal_of_date
from wayline.timetable.notes import Notes
from wayline.timetable.tables import ROW

WEEKDAYS = ("monday", "tuesday", "wednesday", "thursday", "friday", "saturday", "sunday")
NO_WEEK = (False,) * 7
ADDED = "1"


def services_of(calendar: pl.DataFrame, exceptions: pl.DataFrame, notes: Notes) -> list[Service]:
    """Every service of either table; a row with a date that is none is left out and noted."""
    services = {service.service_id: service for service in _weekly(calendar, notes)}
    added: dict[str, set[int]] = {}
    removed: dict[str, set[int]] = {}
    wrong: list[int] = []
    for row in exceptions.iter_rows(named=True):
        if (day := ordinal_of_date(row["date"])) is None:
            wrong.append(row[ROW])
            continue
        days = added if row["exception_type"] == ADDED else removed
        days.setdefault(row["service_id"], set()).add(day)
    notes.add_rows("unusable", "calendar_dates.txt", "date is none", wrong)
    for service_id in [*services, *(each for each in added if each not in services)]:
        week = services.get(service_id, _no_week(service_id))
        services[service_id] = Service(
            service_id,
            week.weekdays,
            week.first_day,
            week.last_day,
            frozenset(added.get(service_id, ())),
            frozenset(removed.get(service_id, ())),
        )
    return list(services.values())


def _no_week(service_id: str) -> Service:
    return Service(service_id, NO_WEEK, 1, 1, frozenset(), frozenset())


def every_day(service_id: str) -> Service:
    """A service of trips that name none that the feed has: better run too often than never."""
    last = dt.date.max.toordinal()
    return Service(service_id, (True,) * 7, 1, last, frozenset(), frozenset())


def _weekly(calendar: pl.DataFrame, notes: Notes) -> list[Service]:
    services: list[Service] = []
    wrong: list[int] = []
    for row in calendar.iter_rows(named=True):
        first, last = ordinal_of_date(row["start_date"]), ordinal_of_date(row["end_date"])
        if first is None or last is None:
            wrong.append(row[ROW])
            continue
        week = tuple(row.get(day) == "1" for day in WEEKDAYS)
        services.append(Service(row["service_id"], week, first, last, frozenset(), frozenset()))
    notes.add_rows("unusable", "calendar.txt", "start_date or end_date is none", wrong)
    return services
