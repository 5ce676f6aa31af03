"""Pure: what eta keeps: what vehicles took, and how what was forecast of them came."""

import msgspec

from wayline.core import Record
from wayline.messages import Disruption
from wayline_eta.scores import Sums

DAY_NS = 86_400_000_000_000
SCORED_DAYS_MAX = 90
"""So long scores are kept, before the newest."""


class Taken(msgspec.Struct, frozen=True):
    """What one vehicle took for a leg, and at the stop where that ends."""

    t_ns: int
    """Of the arrival at the stop."""
    leg: str | None
    """The leg's key; None where the vehicle was not seen all the way from a stop."""
    plan: str
    """Whose plan the leg has: a route, or a line of a timetable."""
    planned_s: float
    travel_s: float
    stop: str
    """The key of the stop, or of the wait for its time there (`legs`)."""
    dwell_s: float
    """0 where it passed; of a wait how long after its time it left, negative before it."""
    disruption: Disruption | None = None
    """What the vehicle met on the way or at the stop: it teaches nothing of what is usual."""


class Known(msgspec.Struct, frozen=True):
    """What all that was taken has taught of one quantity: a `Forgetful` under its key."""

    key: str
    weight: float
    mean: float
    square: float


class Came(msgspec.Struct, frozen=True):
    """A forecast whose arrival has come."""

    made_ns: int
    stop: str
    """The key of the stop."""
    plan: str
    span: int
    """Of the minutes ahead, and whether it was learned, see `ranges`."""
    off: float
    """By how many half widths of its range the arrival was late; negative: early."""


class Learned(Record, frozen=True, kw_only=True):
    """What a vehicle's leaving a stop has taught."""

    taken: Taken
    came: tuple[Came, ...] = ()


class Scored(Record, frozen=True, kw_only=True):
    """How good a vehicle's predictions on one route were whose arrivals came within a minute."""

    t_ns: int
    """The minute's end; it names the minute."""
    route_id: str
    sums: Sums


class ScoredDay(msgspec.Struct, frozen=True):
    """How good all vehicles' predictions on one route were on one day."""

    day: int
    """Since 1970, UTC."""
    route_id: str
    sums: Sums


def day_of(t_ns: int) -> int:
    """Days since 1970, UTC."""
    return t_ns // DAY_NS
