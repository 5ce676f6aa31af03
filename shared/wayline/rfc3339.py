"""Pure: instants as HTTP shows them, RFC 3339 in UTC with milliseconds (SPEC section 5)."""

import datetime as dt

EPOCH = dt.datetime(1970, 1, 1, tzinfo=dt.UTC)


def rfc3339(t_ns: int) -> str:
    """An instant in Unix nanoseconds as text, cut (not rounded) to the millisecond."""
    instant = EPOCH + dt.timedelta(milliseconds=t_ns // 1_000_000)
    # three times as fast as strftime, of which an answer would need a hundred
    return instant.isoformat(timespec="milliseconds").removesuffix("+00:00") + "Z"
