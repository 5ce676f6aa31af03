"""A drive with bends, made up: 100 Hz gyro, 10 Hz odometer, 1 Hz fixes, as they arrive."""

import math
import random
from collections.abc import Iterator
from itertools import count

import msgspec

from wayline.geo import LocalPlane, wrap_360
from wayline.grid import TickGrid
from wayline.messages import GpsFix, Gyro, Message, Odometer

GYRO_NS = 10_000_000
STEP_NS = 100_000_000
"""Of the odometer and of the grid of poses."""
FIX_LATE_NS = 200_000_000
"""A receiver tells a second's fix so much after it."""
ORIGIN = LocalPlane(48.1, 11.5)
GYRO_BIAS_DEGPS = -0.4
ODOMETER_SCALE = 0.99


def drive(start_ns: int, odometer_phase_ns: int) -> Iterator[Message]:
    """Messages for ever, in order of arrival; the odometer speaks so long after the grid."""
    noise = random.Random(7)  # noqa: S311 - noise, not a secret
    east_m, north_m, heading_deg = 0.0, 0.0, 30.0
    fix: GpsFix | None = None
    for number in count():
        since_ns = number * GYRO_NS
        t_ns, seconds = start_ns + since_ns, since_ns * 1e-9
        speed_mps, rate_degps = 15.0 + 5.0 * math.sin(seconds / 20.0), 6.0 * math.sin(seconds / 9.0)
        yield Gyro(t_ns=t_ns, yaw_rate_degps=rate_degps + GYRO_BIAS_DEGPS + noise.gauss(0.0, 0.05))
        if (since_ns - odometer_phase_ns) % STEP_NS == 0:
            measured_mps = round(speed_mps / ODOMETER_SCALE + noise.gauss(0.0, 0.05), 2)
            yield Odometer(t_ns=t_ns, speed_mps=measured_mps)
        if since_ns % 1_000_000_000 == 0:
            place_m = (east_m + noise.gauss(0.0, 1.0), north_m + noise.gauss(0.0, 1.0))
            fix = _fix(t_ns, place_m, speed_mps, heading_deg)
        if fix is not None and t_ns == fix.t_ns + FIX_LATE_NS:
            yield fix
        heading = math.radians(heading_deg)
        east_m += speed_mps * math.sin(heading) * GYRO_NS * 1e-9
        north_m += speed_mps * math.cos(heading) * GYRO_NS * 1e-9
        heading_deg += rate_degps * GYRO_NS * 1e-9


def with_ticks(messages: Iterator[Message]) -> Iterator[msgspec.Struct]:
    """What a core that keeps the grid of poses is given: the ticks too."""
    grid = TickGrid(STEP_NS)
    for message in messages:
        yield from grid.before(message.t_ns)
        yield message
        yield from grid.at(message.t_ns)


def _fix(t_ns: int, place_m: tuple[float, float], speed_mps: float, heading_deg: float) -> GpsFix:
    lat_deg, lon_deg = ORIGIN.to_geodetic(*place_m)
    return GpsFix(
        t_ns=t_ns,
        valid=True,
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        alt_m=520.0,
        speed_mps=speed_mps,
        course_deg=wrap_360(heading_deg),
        mode=3,
        fix="gps",
        satellites=12,
        hdop=0.8,
    )
