"""Raw measurements beside a made-up drive, of satellites that turn along with the Earth."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from wayline.messages import GpsFix, GpsRaw, Message, RawSatellite
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS
from wayline.satellites.sight import ground_at, seen_from
from wayline_bench.made_up_drive import ORIGIN

SATELLITES = 12
DISTANCE_M = 2.2e7
LOWEST_DEG, HIGHEST_DEG = 15.0, 80.0
HEIGHT_M = 560.0
CLOCK_M = 50_000.0
CARRIER_HZ = 1_575.42e6
CN0_DBHZ = 45.0
STD_M = 3.0

Floats = NDArray[np.float64]


def places_m() -> Floats:
    """Spread over the sky of the drive's origin; Earth-fixed, shape (satellites, 3)."""
    ground = ground_at(ORIGIN.lat_deg, ORIGIN.lon_deg, HEIGHT_M)
    heights = np.radians(np.linspace(LOWEST_DEG, HIGHEST_DEG, SATELLITES))
    # by the golden angle no two stand behind each other
    around = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(SATELLITES)
    flat = np.cos(heights)
    directions = np.column_stack((flat * np.sin(around), flat * np.cos(around), np.sin(heights)))
    return np.asarray(ground.place_m + DISTANCE_M * directions @ ground.axes)


def with_ranges(messages: Iterator[Message]) -> Iterator[Message]:
    """The same drive, its fixes replaced by what its receiver measured of each satellite.

    They come at their own time: what a late one costs, fusion's own bench tells.
    """
    places, held = places_m(), list[Message]()
    for message in messages:
        if not isinstance(message, GpsFix):
            held.append(message)
            continue
        later = [each for each in held if each.t_ns > message.t_ns]
        yield from held[: len(held) - len(later)]
        yield _epoch(message, places)
        held = later


def _epoch(fix: GpsFix, places: Floats) -> GpsRaw:
    ground = ground_at(fix.lat_deg or 0.0, fix.lon_deg or 0.0, HEIGHT_M)
    sight = seen_from(ground, places, np.zeros_like(places))
    course_rad, speed_mps = math.radians(fix.course_deg or 0.0), fix.speed_mps or 0.0
    going = np.array([math.sin(course_rad), math.cos(course_rad), 0.0])
    rates_mps = -speed_mps * sight.directions @ going
    satellites = [
        _satellite(number, place, range_m, rate_mps)
        for number, (place, range_m, rate_mps) in enumerate(
            zip(places.tolist(), sight.ranges_m.tolist(), rates_mps.tolist(), strict=True), start=1
        )
    ]
    return GpsRaw(t_ns=fix.t_ns, satellites=tuple(satellites))


def _satellite(
    number: int, place_m: Sequence[float], range_m: float, rate_mps: float
) -> RawSatellite:
    x_m, y_m, z_m = place_m
    return RawSatellite(
        system="gps",
        prn=number,
        pseudorange_m=range_m + CLOCK_M,
        pseudorange_std_m=STD_M,
        doppler_hz=-rate_mps * CARRIER_HZ / SPEED_OF_LIGHT_MPS,
        carrier_hz=CARRIER_HZ,
        cn0_dbhz=CN0_DBHZ,
        x_m=x_m,
        y_m=y_m,
        z_m=z_m,
        vx_mps=0.0,
        vy_mps=0.0,
        vz_mps=0.0,
    )
