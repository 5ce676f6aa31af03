"""A hilly road whose grade is known, and what the sensors of a vehicle on it report."""

from collections.abc import Callable, Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline.geo import metres_per_degree
from wayline.inputs import Flush, Tick
from wayline.line import Line
from wayline.messages import Barometer, GpsFix, Pose
from wayline.tuning import Tuning
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import DrivenRun, FinishedRun
from wayline_slope_map.run import smoothed_runs

Floats = NDArray[np.float64]

LAT_DEG, LON_DEG = 55.9, 9.8
SECOND_NS = 1_000_000_000
START_NS = 1_700_000_000 * SECOND_NS
WAVES = ((3.0, 900.0, 0.0), (2.0, 370.0, 1.0), (0.7, 170.0, 2.0))
"""Amplitude in percent, wavelength in metres, phase."""


def true_grade_pct(distance_m: Floats) -> Floats:
    waves_pct = [a * np.sin(2.0 * np.pi * distance_m / length + c) for a, length, c in WAVES]
    total_pct: Floats = np.sum(waves_pct, axis=0)
    return total_pct


def true_alt_m(distance_m: Floats) -> Floats:
    waves_m = [
        a / 100.0 * length / (2.0 * np.pi) * np.cos(2.0 * np.pi * distance_m / length + c)
        for a, length, c in WAVES
    ]
    alt_m: Floats = 100.0 - np.sum(waves_m, axis=0)
    return alt_m


def bending_east(distance_m: Floats) -> tuple[Floats, Floats]:
    """East and north of a road that runs east in gentle bends."""
    return distance_m, 150.0 * (1.0 - np.cos(distance_m / 800.0))


def ring(circumference_m: float) -> Callable[[Floats], tuple[Floats, Floats]]:
    """A circular road, driven clockwise from its north."""
    radius_m = circumference_m / (2.0 * np.pi)
    return lambda d: (radius_m * np.sin(d / radius_m), radius_m * np.cos(d / radius_m))


def drive(
    *,
    seed: int,
    start_ns: int = START_NS,
    length_m: float = 6000.0,
    speed_mps: float = 15.0,
    path: Callable[[Floats], tuple[Floats, Floats]] = bending_east,
    grade_of: Callable[[Floats], Floats] = lambda distance_m: distance_m,
    backwards: bool = False,
    barometer: bool = True,
    barometer_step_pa: float = 5.0,
    gps_std_m: float = 4.0,
    gps_lag_s: float = 0.0,
) -> list[msgspec.Struct]:
    """Messages as slope-map hears them, in order of arrival; fixes come 0.3 s late.

    The GPS altitude errs by a Gauss-Markov process (80 s) and 0.3 m white, the barometer by an
    offset, a random walk and 0.4 m white. `grade_of` maps the distance along the path to the
    one that the altitude is taken at (for a ring). GPS altitudes are the road's of `gps_lag_s` ago.
    """
    rng = np.random.default_rng(seed)
    times_s = np.arange(0.0, length_m / speed_mps, 0.1)
    travelled_m = times_s * speed_mps
    along_m = length_m - travelled_m if backwards else travelled_m
    lat_deg, lon_deg, heading_deg = _placed(path, along_m, backwards=backwards)
    wander_m = rng.normal(0.0, 1.0, 2) * (0.2, 0.2)
    alt_m = true_alt_m(grade_of(along_m))
    late_m = np.interp(times_s - gps_lag_s, times_s, alt_m)
    gps_m = late_m[::10] + _gauss_markov(rng, len(times_s[::10]), gps_std_m, 80.0)
    gps_m += rng.normal(0.0, 0.3, len(gps_m))
    pressure_pa = _pressures_pa(rng, alt_m[::10], barometer_step_pa)
    messages: list[msgspec.Struct] = []
    for i, t_s in enumerate(times_s):
        t_ns = start_ns + round(t_s * 10) * SECOND_NS // 10
        messages.append(
            Pose(
                t_ns=t_ns,
                mode="fused",
                lat_deg=float(lat_deg[i] + wander_m[0] * 1e-5),
                lon_deg=float(lon_deg[i] + wander_m[1] * 1e-5),
                heading_deg=float(heading_deg[i]),
                speed_mps=speed_mps,
                distance_m=float(travelled_m[i]),
                east_std_m=2.0,
                north_std_m=2.0,
            )
        )
        if i % 10 == 0:
            if barometer:
                messages.append(Barometer(t_ns=t_ns, pressure_pa=float(pressure_pa[i // 10])))
            messages.append(Tick(t_ns))
        if i % 10 == 3:
            fix = GpsFix(
                t_ns=t_ns - 3 * SECOND_NS // 10,
                valid=True,
                lat_deg=float(lat_deg[i]),
                lon_deg=float(lon_deg[i]),
                alt_m=float(gps_m[i // 10]),
                v_std_m=gps_std_m,
                mode=3,
            )
            messages.append(fix)
    messages.append(Flush(t_ns))
    return messages


def core(
    profiles: Sequence[RoadProfile] = (), route: Line | None = None, tuning: Tuning | None = None
) -> SlopeMapCore:
    """A core that knows nothing but what is given; a route's id is 7."""
    roads, tuning = KnownRoads(profiles), tuning or Tuning()
    if route is not None:
        roads.follow(route, "7", loop=False, bin_m=tuning.map_bin_m)
    return SlopeMapCore(roads, tuning, "car")


def driven_of(core: SlopeMapCore, messages: Sequence[msgspec.Struct]) -> list[DrivenRun]:
    """The driven runs that a core makes of messages."""
    outputs = [output for message in messages for output in core.handle(message, "test")]
    return [output for output in outputs if isinstance(output, DrivenRun)]


def runs_of(core: SlopeMapCore, messages: Sequence[msgspec.Struct]) -> list[FinishedRun]:
    """What a core's driven runs come to."""
    return [run for driven in driven_of(core, messages) for run in smoothed_runs(driven)]


def _placed(
    path: Callable[[Floats], tuple[Floats, Floats]], along_m: Floats, *, backwards: bool
) -> tuple[Floats, Floats, Floats]:
    east_m, north_m = path(along_m)
    ahead_east_m, ahead_north_m = path(along_m + (-0.1 if backwards else 0.1))
    heading_deg = np.degrees(np.arctan2(ahead_east_m - east_m, ahead_north_m - north_m)) % 360.0
    north_m_per_deg, east_m_per_deg = metres_per_degree(LAT_DEG)
    return LAT_DEG + north_m / north_m_per_deg, LON_DEG + east_m / east_m_per_deg, heading_deg


def _gauss_markov(rng: np.random.Generator, count: int, std: float, time_s: float) -> Floats:
    keep = np.exp(-1.0 / time_s)
    values = np.empty(count)
    values[0] = rng.normal(0.0, std)
    for i in range(1, count):
        values[i] = keep * values[i - 1] + rng.normal(0.0, std * np.sqrt(1.0 - keep**2))
    return values


def _pressures_pa(rng: np.random.Generator, alt_m: Floats, step_pa: float) -> Floats:
    """Linear in altitude, 11.9 Pa a metre, which the standard atmosphere is to 1 % here."""
    drift_m = rng.normal(0.0, 30.0) + np.cumsum(rng.normal(0.0, 0.08, len(alt_m)))
    noisy_m = alt_m + drift_m + rng.normal(0.0, 0.4, len(alt_m))
    pressures_pa = 101_325.0 * (1.0 - noisy_m / 44_330.77) ** (1.0 / 0.190_263)
    rounded: Floats = np.round(pressures_pa / step_pa) * step_pa
    return rounded
