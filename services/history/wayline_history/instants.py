"""Pure: the instants that questions name, and the stretch of time between them."""

import datetime as dt
from typing import Annotated, NamedTuple

import msgspec
from msgspec import Meta

from wayline.messages import EARLIEST_NS, LATEST_NS
from wayline.query_error import QueryError
from wayline.rfc3339 import rfc3339

HOUR_NS = 3_600_000_000_000
DAY_NS = 24 * HOUR_NS
_EPOCH = dt.datetime(1970, 1, 1, tzinfo=dt.UTC)

Instant = Annotated[
    str,
    Meta(
        max_length=40,
        description="RFC 3339, e.g. 2026-11-22T08:00:00Z, a date, or Unix seconds",
        examples=["2026-11-22T08:00:00Z"],
    ),
]


class Stretch(NamedTuple):
    """From an instant on and before another, Unix ns."""

    from_ns: int
    to_ns: int


def instant_ns(text: str, name: str) -> int:
    """An instant in Unix ns; without a zone it is UTC. Raises QueryError (422), naming `name`."""
    try:
        t_ns = round(float(text) * 1e9)
    except (ValueError, OverflowError):
        t_ns = _told_ns(text, name)
    if not EARLIEST_NS <= t_ns <= LATEST_NS:
        raise QueryError(422, f"{text!r} is not between 1980 and 2100", parameter=name)
    return t_ns


def _told_ns(text: str, name: str) -> int:
    # a plus sign that nobody escaped comes as a space
    told = text.replace(" ", "+") if "T" in text else text
    try:
        instant = dt.datetime.fromisoformat(told)
    except ValueError:
        detail = f"{text!r} is no time; write e.g. 2026-11-22T08:00:00Z"
        raise QueryError(422, detail, parameter=name) from None
    zoned = instant if instant.tzinfo else instant.replace(tzinfo=dt.UTC)
    return (zoned - _EPOCH) // dt.timedelta(microseconds=1) * 1_000


def stretch_of(
    from_: str | msgspec.UnsetType,
    to: str | msgspec.UnsetType,
    now_ns: int,
    *,
    days_max: int | None,
) -> Stretch:
    """What `from` and `to` ask for: by default the day before `to`, and up to now.

    Raises QueryError (422) where that makes no sense or is more than may be asked for at once.
    """
    if to is not msgspec.UNSET:
        to_ns = instant_ns(to, "to")
    elif from_ is msgspec.UNSET:
        to_ns = now_ns
    else:
        to_ns = min(instant_ns(from_, "from") + DAY_NS, max(now_ns, EARLIEST_NS))
    from_ns = to_ns - DAY_NS if from_ is msgspec.UNSET else instant_ns(from_, "from")
    if from_ns >= to_ns:
        detail = f"is not before to, which is {rfc3339(to_ns)}"
        raise QueryError(422, detail, parameter="from")
    if days_max is not None and to_ns - from_ns > days_max * DAY_NS:
        days = (to_ns - from_ns) / DAY_NS
        detail = (
            f"{days:,.0f} days are more than the {days_max} that are told at once; ask in parts"
        )
        raise QueryError(422, detail, parameter="from")
    return Stretch(from_ns, to_ns)
