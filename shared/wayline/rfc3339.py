"""Pure: instants as HTTP shows them, RFC 3339 in UTC with milliseconds (SPEC section 5)."""

import datetime as dt

EPOCH = dt.datetime(1970, 1, 1)
"""In UTC, but without a zone: isoformat would write it as +00:00."""


def rfc3339(t_ns: int) -> str:
    """An instant in Unix nanoseconds as text, cut (not rounded) to the millisecond."""
    # half the time of strftime; an answer needs it some sixty times
    seconds, rest_ns = divmod(t_ns, 1_000_000_000)
    instant = EPOCH + dt.timedelta(0, seconds, rest_ns // 1000)
    return instant.isoformat(timespec="milliseconds") + "Z"
