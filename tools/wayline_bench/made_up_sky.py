"""Pure: a made-up sky of GPS satellites over Munich, as a u-blox receiver writes it."""

import math
from typing import NamedTuple

from pyproj import Transformer

from wayline.satellites.earth import EARTH_RATE_RADPS, SPEED_OF_LIGHT_MPS
from wayline_bench.made_up_ubx import Orbit, Signal, orbit, rawx, sfrbx

WEEK = 2_400
TOE_S = 352_800.0
"""Of all ephemerides: a Thursday morning in January 2026."""
START_S = TOE_S + 900.0
ECEF = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
OWN_M: tuple[float, float, float] = ECEF.transform(11.6, 48.1, 570.0)
MASK_DEG = 10.0
L1_HZ = 1_575.42e6


class Seen(NamedTuple):
    """A satellite above the receiver."""

    orbit: Orbit
    elevation_deg: float


def sky(
    tow_s: float = START_S, week: int = WEEK, toe_s: float = TOE_S, mask_deg: float = MASK_DEG
) -> list[Seen]:
    """Of 32 satellites those above a mask."""
    up = [each / math.hypot(*OWN_M) for each in OWN_M]
    seen = []
    for prn in range(1, 33):
        each = orbit(prn, week, toe_s)
        ray = [a - b for a, b in zip(each.place_m(tow_s), OWN_M, strict=True)]
        rise = sum(a * b for a, b in zip(ray, up, strict=True)) / math.hypot(*ray)
        seen.append(Seen(each, math.degrees(math.asin(rise))))
    return [each for each in seen if each.elevation_deg > mask_deg]


def flight_m(satellite: Orbit, tow_s: float) -> float:
    """What a signal received at a second of the week has travelled, the turn of the earth in it."""
    flight_s = 0.07
    for _ in range(4):
        x, y, z = satellite.place_m(tow_s - flight_s)
        angle = EARTH_RATE_RADPS * flight_s
        turned = (
            x * math.cos(angle) + y * math.sin(angle),
            y * math.cos(angle) - x * math.sin(angle),
            z,
        )
        flight_s = math.dist(turned, OWN_M) / SPEED_OF_LIGHT_MPS
    return flight_s * SPEED_OF_LIGHT_MPS


def signal(satellite: Orbit, tow_s: float, clock_m: float = 0.0) -> Signal:
    """What a receiver in empty space would measure, its own clock ahead by so many metres."""
    later_m, earlier_m = (pseudorange_m(satellite, tow_s + each) for each in (0.5, -0.5))
    doppler_hz = (earlier_m - later_m) * L1_HZ / SPEED_OF_LIGHT_MPS
    return Signal(satellite.prn, pseudorange_m(satellite, tow_s) + clock_m, doppler_hz)


def pseudorange_m(satellite: Orbit, tow_s: float) -> float:
    """What a signal has travelled, less the satellite's clock's lead."""
    travelled_m = flight_m(satellite, tow_s)
    lead_s = satellite.lead_s(tow_s - travelled_m / SPEED_OF_LIGHT_MPS)
    return travelled_m - lead_s * SPEED_OF_LIGHT_MPS


def navigation(satellites: list[Seen]) -> bytes:
    """What all of them broadcast of themselves."""
    return b"".join(sfrbx(each.orbit) for each in satellites)


def epoch(
    satellites: list[Seen], tow_s: float, *, week: int = WEEK, clock_m: float = 0.0, state: int = 1
) -> bytes:
    """One RXM-RAWX."""
    signals = [signal(each.orbit, tow_s, clock_m) for each in satellites]
    return rawx(week, tow_s, signals, state=state)


def recording(seconds: int = 20, start_s: float = START_S) -> bytes:
    """A log: an epoch, the navigation messages, and an epoch a second after them."""
    satellites = sky()
    first = epoch(satellites, start_s - 1.0)
    epochs = [epoch(satellites, start_s + n) for n in range(seconds)]
    return first + navigation(satellites) + b"".join(epochs)
