"""Pure: on which days a service runs, and what instant a time of the timetable is."""

import datetime as dt
from zoneinfo import ZoneInfo

import msgspec

SECOND_NS = 1_000_000_000
NOON_S = 12 * 3600


class Service(msgspec.Struct, frozen=True, array_like=True):
    """A set of days, each an ordinal (1 is 1 January of year 1)."""

    service_id: str
    weekdays: tuple[bool, ...]
    """Monday first; none where only exceptions make the days."""
    first_day: int
    last_day: int
    added: frozenset[int]
    removed: frozenset[int]

    def runs_on(self, day: dt.date) -> bool:
        """Whether trips of this service set out on a day."""
        ordinal = day.toordinal()
        if ordinal in self.removed:
            return False
        if ordinal in self.added:
            return True
        within = self.first_day <= ordinal <= self.last_day
        return within and self.weekdays[day.weekday()]

    @property
    def ends(self) -> int:
        """The last day on which it may run; 0 where there is none."""
        regular = self.last_day if any(self.weekdays) else 0
        return max([regular, *self.added], default=0)

    @property
    def begins(self) -> int:
        """The first day on which it may run; a day beyond all where there is none."""
        regular = self.first_day if any(self.weekdays) else dt.date.max.toordinal()
        return min([regular, *self.added])


def instant_ns(day: dt.date, seconds: float, zone: ZoneInfo) -> int:
    """Unix time of a timetable's time on a service day.

    GTFS counts from noon minus twelve hours, so that a bus at 08:00 leaves at eight by the clock
    on the wall on the days when summer time begins and ends, too.
    """
    noon = dt.datetime.combine(day, dt.time(12), zone)
    return round((noon.timestamp() - NOON_S + seconds) * SECOND_NS)


def seconds_of(day: dt.date, t_ns: int, zone: ZoneInfo) -> float:
    """The inverse of `instant_ns`: the timetable's time of an instant on a service day."""
    return (t_ns - instant_ns(day, 0.0, zone)) / SECOND_NS


def service_days(t_ns: int, zone: ZoneInfo, longest_s: float) -> list[dt.date]:
    """The service days that an instant may belong to, as trips go on past midnight: latest first.

    `longest_s` is the latest time of the timetable.
    """
    today = dt.datetime.fromtimestamp(t_ns / SECOND_NS, zone).date()
    before = int(longest_s // 86_400) + 1
    return [today - dt.timedelta(days=each) for each in range(before + 1)]
