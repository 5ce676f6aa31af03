"""Raw measurements of a closed-form drive under satellites on circular orbits."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pyproj import Transformer

from builders import at
from unit.fusion.drives import ORIGIN, Truth
from wayline.messages import GpsRaw, Message, RawSatellite

LIGHT_MPS = 299_792_458.0
EARTH_RADPS = 7.292_115_146_7e-5
ORBIT_M = 26_560_000.0
ORBIT_RADPS = 2.0 * math.pi / 43_082.0
HEIGHT_M = 60.0
LOWEST_DEG = 10.0
CARRIER_HZ = 1_575_420_000.0
TO_ECEF = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
Vector = NDArray[np.float64]


class Receiver(NamedTuple):
    """What is wrong with it, and with the signals."""

    clock_m: float = 120_000.0
    drift_mps: float = 40.0
    jump_m: Mapping[float, float] = {}
    """Of the clock, by the second from which on it holds."""
    wander_mps: float = 0.0
    """How far the drift swings, in two minutes."""
    offsets_m: Mapping[str, float] = {"gps": 0.0, "glonass": -400.0}
    range_std_m: float = 1.0
    rate_std_mps: float = 0.05
    has_doppler: bool = True
    longer_m: Mapping[tuple[str, int], float] = {}
    """Reflections: satellite by satellite."""


def orbiting(system: str, prn: int, seconds: float) -> tuple[Vector, Vector]:
    """Place and motion, Earth-fixed, by planes of four satellites each."""
    plane, slot = divmod(prn, 4)
    shift = 0.35 if system == "glonass" else 0.0
    node_rad, tilt_rad = 2.0 * math.pi * plane / 6.0 + shift, math.radians(56.0)
    along_rad = 2.0 * math.pi * slot / 4.0 + 0.5 * plane + shift + ORBIT_RADPS * seconds

    def place(ahead_s: float) -> Vector:
        angle_rad = along_rad + ORBIT_RADPS * ahead_s
        flat = np.array([math.cos(angle_rad), math.sin(angle_rad) * math.cos(tilt_rad)])
        turn_rad = node_rad - EARTH_RADPS * (seconds + ahead_s)
        sin, cos = math.sin(turn_rad), math.cos(turn_rad)
        x, y = cos * flat[0] - sin * flat[1], sin * flat[0] + cos * flat[1]
        return ORBIT_M * np.array([x, y, math.sin(angle_rad) * math.sin(tilt_rad)])

    return place(0.0), (place(0.5) - place(-0.5))


def epochs_of(
    truths: Sequence[Truth], receiver: Receiver, every_s: float = 1.0, seed: int = 1
) -> Iterator[GpsRaw]:
    """All satellites above the horizon."""
    rng = np.random.default_rng(seed)
    step = round(every_s / (truths[1].seconds - truths[0].seconds))
    for truth in truths[::step]:
        yield epoch_of(truth, receiver, rng)


def epoch_of(truth: Truth, receiver: Receiver, rng: np.random.Generator) -> GpsRaw:
    seen = (
        _seen(system, prn, truth, receiver, rng)
        for system in receiver.offsets_m
        for prn in range(1, 25)
    )
    return GpsRaw(t_ns=at(truth.seconds), satellites=tuple(each for each in seen if each))


def _place(truth: Truth) -> tuple[Vector, Vector]:
    """Place and motion of the antenna, Earth-fixed."""
    lat_deg, lon_deg = ORIGIN.to_geodetic(truth.east_m, truth.north_m)
    here_m = np.array(TO_ECEF.transform(lon_deg, lat_deg, HEIGHT_M))
    return here_m, _motion(truth, lat_deg, lon_deg)


def _motion(truth: Truth, lat_deg: float, lon_deg: float) -> Vector:
    lat, lon = math.radians(lat_deg), math.radians(lon_deg)
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    north = np.array(
        [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)]
    )
    heading = math.radians(truth.heading_deg)
    return truth.speed_mps * (math.sin(heading) * east + math.cos(heading) * north)


def _seen(
    system: str, prn: int, truth: Truth, receiver: Receiver, rng: np.random.Generator
) -> RawSatellite | None:
    seconds = truth.seconds
    here_m, motion_mps = _place(truth)
    travelled_s = 0.075
    for _ in range(4):
        place_m, going_mps = orbiting(system, prn, seconds - travelled_s)
        turn_rad = EARTH_RADPS * travelled_s
        line_m = _turned(place_m, turn_rad) - here_m
        travelled_s = float(np.linalg.norm(line_m)) / LIGHT_MPS
    line = line_m / np.linalg.norm(line_m)
    elevation_deg = math.degrees(math.asin(float(line @ here_m) / float(np.linalg.norm(here_m))))
    if elevation_deg < LOWEST_DEG:
        return None
    rate_mps = float(line @ (_turned(going_mps, turn_rad) - motion_mps))
    clock_m, drift_mps = _clock(receiver, seconds)
    longer_m = receiver.longer_m.get((system, prn), 0.0)
    pseudorange_m = travelled_s * LIGHT_MPS + clock_m + receiver.offsets_m[system] + longer_m
    doppler_hz = -(rate_mps + drift_mps + rng.normal(0.0, receiver.rate_std_mps))
    doppler_hz *= CARRIER_HZ / LIGHT_MPS
    return RawSatellite(
        system=system,
        prn=prn,
        pseudorange_m=pseudorange_m + rng.normal(0.0, receiver.range_std_m),
        doppler_hz=doppler_hz if receiver.has_doppler else None,
        carrier_hz=CARRIER_HZ,
        cn0_dbhz=45.0,
        **dict(zip(("x_m", "y_m", "z_m"), place_m.tolist(), strict=True)),
        **dict(zip(("vx_mps", "vy_mps", "vz_mps"), going_mps.tolist(), strict=True)),
    )


def _turned(vector: Vector, angle_rad: float) -> Vector:
    sin, cos = math.sin(angle_rad), math.cos(angle_rad)
    x, y, z = vector
    return np.array([cos * x + sin * y, cos * y - sin * x, z])


def _clock(receiver: Receiver, seconds: float) -> tuple[float, float]:
    """Bias and drift at an instant."""
    jumped_m = sum(each for since_s, each in receiver.jump_m.items() if seconds >= since_s)
    phase = 2.0 * math.pi * seconds / 120.0
    wandered_m = receiver.wander_mps * 120.0 / (2.0 * math.pi) * (1.0 - math.cos(phase))
    drift_mps = receiver.drift_mps + receiver.wander_mps * math.sin(phase)
    return receiver.clock_m + receiver.drift_mps * seconds + wandered_m + jumped_m, drift_mps


def with_epochs(messages: Iterable[Message], epochs: Iterable[GpsRaw]) -> list[Message]:
    """Both in order of time; at the same instant the vehicle's sensors first."""
    return sorted([*messages, *epochs], key=lambda each: each.t_ns)
