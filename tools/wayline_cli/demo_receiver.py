"""Pure: what the demo car's receiver writes: GGA, RMC and GSA once a second, errors included."""

import datetime as dt
import math
from collections.abc import Iterator
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from wayline.geo import metres_per_degree
from wayline_cli.demo_motion import Motion

Floats = NDArray[np.float64]

ERROR_STD_M = 1.4
"""Per axis, so 2 m in the plane; altitude is twice as bad."""
ERROR_TIME_S = 30.0
"""Correlation time of the errors: they wander as satellites and reflections do."""
SPEED_STD_MPS = 0.08
COURSE_STD_DEG = 0.4
COURSE_SPEED_MIN_MPS = 0.5
"""Slower, the receiver knows no course."""
TUNNEL_S = (93.0, 118.0)
"""Without a view of the sky from the first to before the second."""
LATENCY_S = 0.12
"""From the instant of a fix until its first sentence; the others follow."""
SENTENCE_S = 0.02
GEOID_SEP_M = -33.6
SATELLITES = (3, 6, 9, 11, 14, 17, 19, 22, 28)
DILUTIONS = (1.7, 0.9, 1.4)
"""PDOP, HDOP, VDOP"""
KNOTS_PER_MPS = 3600.0 / 1852.0


def receiver_log(motion: Motion, start_s: int, random: np.random.Generator) -> Iterator[str]:
    """Lines "<epoch s> <sentence>"; `motion` has one instant a second, `start_s` is Unix time."""
    seen = with_errors(motion, random)
    for index, time_s in enumerate(seen.times_s):
        now = dt.datetime.fromtimestamp(start_s + time_s, dt.UTC)
        hidden = TUNNEL_S[0] <= time_s < TUNNEL_S[1]
        bodies = blind_epoch(now) if hidden else epoch(now, seen, index)
        for number, body in enumerate(bodies):
            arrival_s = start_s + time_s + LATENCY_S + number * SENTENCE_S
            yield f"{arrival_s:.3f} {sentence(body)}"


def with_errors(motion: Motion, random: np.random.Generator) -> Motion:
    """The motion as the receiver measures it; errors end as they begin, for laps without a jump."""
    count = len(motion.times_s)
    north_m, east_m, up_m = (wandering(count, ERROR_STD_M, random) for _ in range(3))
    metres = [metres_per_degree(lat_deg) for lat_deg in motion.lats_deg]
    north_m_per_deg, east_m_per_deg = np.array(metres).T
    courses_deg = motion.headings_deg + random.normal(0.0, COURSE_STD_DEG, count)
    # standing still is seen as such
    noise_mps = random.normal(0.0, SPEED_STD_MPS, count) * (motion.speeds_mps > 0.0)
    return motion._replace(
        lats_deg=motion.lats_deg + north_m / north_m_per_deg,
        lons_deg=motion.lons_deg + east_m / east_m_per_deg,
        alts_m=motion.alts_m + 2.0 * up_m,
        headings_deg=courses_deg % 360.0,
        speeds_mps=np.abs(motion.speeds_mps + noise_mps),
    )


def wandering(count: int, std: float, random: np.random.Generator) -> Floats:
    """First-order Gauss-Markov noise of ERROR_TIME_S, one value a second, going round a circle.

    The same white noise is filtered twice in a row; in the second round the start is forgotten.
    """
    kept = math.exp(-1.0 / ERROR_TIME_S)
    white = random.normal(0.0, std * math.sqrt(1.0 - kept * kept), count)
    values, value = [], 0.0
    for step in [*white, *white]:
        value = kept * value + step
        values.append(value)
    return np.array(values[count:])


def epoch(now: dt.datetime, seen: Motion, index: int) -> tuple[str, str, str]:
    """GGA, RMC and GSA of one fix, without `$` and checksum."""
    clock, date = clock_and_date(now)
    lat = degrees_minutes(seen.lats_deg[index], 2, "NS")
    lon = degrees_minutes(seen.lons_deg[index], 3, "EW")
    speed_mps = seen.speeds_mps[index]
    moving = speed_mps >= COURSE_SPEED_MIN_MPS
    course = f"{round(seen.headings_deg[index], 1) % 360.0:.1f}" if moving else ""
    pdop, hdop, vdop = DILUTIONS
    used = ",".join(f"{prn:02d}" for prn in SATELLITES) + "," * (12 - len(SATELLITES))
    return (
        f"GPGGA,{clock},{lat},{lon},1,{len(SATELLITES):02d},{hdop},"
        f"{seen.alts_m[index]:.1f},M,{GEOID_SEP_M},M,,",
        f"GPRMC,{clock},A,{lat},{lon},{speed_mps * KNOTS_PER_MPS:.2f},{course},{date},,,A",
        f"GPGSA,A,3,{used},{pdop},{hdop},{vdop}",
    )


def blind_epoch(now: dt.datetime) -> tuple[str, str, str]:
    """The same without a fix."""
    clock, date = clock_and_date(now)
    return (
        f"GPGGA,{clock},,,,,0,00,99.9,,M,,M,,",
        f"GPRMC,{clock},V,,,,,,,{date},,,N",
        "GPGSA,A,1,,,,,,,,,,,,,99.9,99.9,99.9",
    )


def clock_and_date(now: dt.datetime) -> tuple[str, str]:
    """UTC as hhmmss.ss and ddmmyy."""
    return now.strftime("%H%M%S.00"), now.strftime("%d%m%y")


def degrees_minutes(angle_deg: float, degree_digits: int, signs: str) -> str:
    """An angle as NMEA has it: 3954.36821,N"""
    hundred_thousandths = round(abs(angle_deg) * 60e5)
    degrees, rest = divmod(hundred_thousandths, 60 * 100_000)
    minutes = f"{rest / 1e5:08.5f}"
    return f"{degrees:0{degree_digits}d}{minutes},{signs[int(angle_deg < 0.0)]}"


def sentence(body: str) -> str:
    """A body between `$` and its checksum."""
    checksum = reduce(lambda sum_, letter: sum_ ^ letter, body.encode("ascii"), 0)
    return f"${body}*{checksum:02X}"
