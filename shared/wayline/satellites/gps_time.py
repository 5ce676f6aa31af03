"""Pure: GPS time, which counts weeks since 1980 and knows no leap seconds."""

from bisect import bisect_right

SECOND_NS = 1_000_000_000
WEEK_S = 604_800
GPS_EPOCH_UNIX_S = 315_964_800
"""1980-01-06 00:00 UTC."""
LEAPS_UNIX_S = (
    *(362_793_600, 394_329_600, 425_865_600, 489_024_000, 567_993_600, 631_152_000),
    *(662_688_000, 709_948_800, 741_484_800, 773_020_800, 820_454_400, 867_715_200),
    *(915_148_800, 1_136_073_600, 1_230_768_000, 1_341_100_800, 1_435_708_800, 1_483_228_800),
)
"""Since when GPS time is a second further ahead of UTC (IERS Bulletin C; the last one of 2017)."""


def leap_s(unix_s: float) -> int:
    """Seconds by which GPS time is ahead of UTC at a Unix time."""
    return bisect_right(LEAPS_UNIX_S, unix_s)


def unix_ns(week: int, tow_s: float, leaps_s: int | None = None) -> int:
    """Unix time in ns of a GPS week and seconds of it.

    `leaps_s`: by how much GPS time is ahead of UTC, as a receiver tells it; else by the table.
    """
    ahead_s = week * WEEK_S + GPS_EPOCH_UNIX_S
    if leaps_s is None:
        leaps_s = leap_s(ahead_s + tow_s - leap_s(ahead_s + tow_s))
    return (ahead_s - leaps_s) * SECOND_NS + round(tow_s * SECOND_NS)


def week_and_tow_s(t_ns: int) -> tuple[int, float]:
    """GPS week and seconds of it of a Unix time in ns."""
    gps_ns = t_ns + (leap_s(t_ns / SECOND_NS) - GPS_EPOCH_UNIX_S) * SECOND_NS
    week, within_ns = divmod(gps_ns, WEEK_S * SECOND_NS)
    return week, within_ns / SECOND_NS
