"""What a modern receiver says at 10 Hz, made up: four constellations, GST, high precision."""

import datetime as dt
import random
from collections.abc import Iterator
from functools import reduce
from operator import xor

RATE_HZ = 10
START = dt.datetime(2026, 6, 1, 8, 0, 0, tzinfo=dt.UTC)
EPOCH_NS = 1_000_000_000 // RATE_HZ
CONSTELLATIONS = {
    "GP": (1, range(2, 32, 3)),
    "GL": (2, range(65, 88, 4)),
    "GA": (3, range(1, 36, 6)),
}
"""By talker: the system id in GSA, and the satellites in view."""


def instant_ns(epoch: int) -> int:
    """Unix time that the sentences of an epoch tell."""
    return round(START.timestamp()) * 1_000_000_000 + epoch * EPOCH_NS


def epoch_lines(epoch: int) -> list[str]:
    """RMC VTG GGA, a GSA a constellation, their GSV, GST: 14 sentences of a drive due north."""
    at = START + dt.timedelta(microseconds=epoch * EPOCH_NS // 1000)
    time = f"{at:%H%M%S}.{at.microsecond // 10_000:02d}"
    noise = random.Random(epoch)  # noqa: S311 - noise, not a secret
    place = f"48{10.0 + epoch * 0.0007 % 40.0:010.7f},N,011{30.0 + noise.gauss(0, 1e-4):010.7f},E"
    speed_knots, course = 23.0 + noise.gauss(0, 0.2), f"{noise.uniform(0.0, 3.0):.2f}"
    bodies = [
        f"GNRMC,{time},A,{place},{speed_knots:.3f},{course},{at:%d%m%y},,,D,V",
        f"GNVTG,{course},T,,M,{speed_knots:.3f},N,{speed_knots * 1.852:.3f},K,D",
        f"GNGGA,{time},{place},2,12,0.62,{520.0 + noise.gauss(0, 0.3):.1f},M,46.3,M,,0131",
        *_in_use(),
        *_in_view(noise),
        f"GNGST,{time},21,,,,{noise.uniform(0.8, 1.2):.2f},{noise.uniform(0.6, 1.0):.2f},1.7",
    ]
    return [f"${body}*{reduce(xor, body.encode()):02X}" for body in bodies]


def _in_use() -> Iterator[str]:
    for system_id, numbers in CONSTELLATIONS.values():
        used = [f"{number:02d}" for number in numbers][:8]
        yield f"GNGSA,A,3,{','.join(used + [''] * (12 - len(used)))},1.18,0.62,1.00,{system_id}"


def _in_view(noise: random.Random) -> Iterator[str]:
    for talker, (_, numbers) in CONSTELLATIONS.items():
        satellites = [
            f"{number:02d},{number * 7 % 80:02d},{number * 37 % 360:03d},{noise.randint(28, 48)}"
            for number in numbers
        ]
        pages = [satellites[start : start + 4] for start in range(0, len(satellites), 4)]
        for number, page in enumerate(pages, 1):
            yield f"{talker}GSV,{len(pages)},{number},{len(satellites):02d},{','.join(page)},1"
