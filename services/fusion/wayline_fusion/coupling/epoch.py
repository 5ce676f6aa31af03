"""Pure: what one epoch of a receiver tells of its clock, and of how good the aid was."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import msgspec
import numpy as np

from wayline.messages import RawSatellite
from wayline.noise_scale import NoiseScale
from wayline.satellites.clock import ClockDrift, Shared, shared_part
from wayline.satellites.doppler import Antenna, Expected, Floats
from wayline_fusion.coupling.heard import Heard

DOPPLER_STD_HZ = 1.0
"""Of a receiver that claims none: 0.2 m/s."""
PSEUDORANGE_STD_M = 10.0
"""Of a receiver that claims none, among houses."""


class Offset(NamedTuple):
    """By how much a system's pseudoranges are longer than its ranges, by the receiver's clock."""

    t_ns: int
    metres: float
    variance: float


class Learned(msgspec.Struct, frozen=True):
    """What epochs have told."""

    drift: ClockDrift | None = None
    offsets: Mapping[str, Offset] = {}
    """By system: each has a time of its own."""
    doubt: NoiseScale = NoiseScale()
    """Factor on the variance that the pose claims for its velocity along lines of sight."""


def learned(
    before: Learned,
    t_ns: int,
    satellites: list[RawSatellite],
    heard: Heard,
    antenna: Antenna,
    expected: Expected,
) -> Learned:
    """With an epoch's satellites, one row each of `heard` and of what was expected of them."""
    drift, doubt = before.drift, before.doubt
    dopplers_hz = _column([each.doppler_hz for each in satellites])
    told = ~np.isnan(dopplers_hz)
    shared: Shared | None
    offsets = _offsets(t_ns, satellites, heard, antenna, expected)
    if told.any():
        stds_hz = _column([each.doppler_std_hz for each in satellites], DOPPLER_STD_HZ)
        noise = np.square(stds_hz / heard.hz_per_mps)[told]
        off_mps = dopplers_hz / heard.hz_per_mps - (expected.rates_mps - heard.clock_drifts_mps)
        by_axes = expected.by_axes[told]
        shared = shared_part(off_mps[told], noise, by_axes, antenna.velocity_variances)
        doubt = _doubted(doubt, off_mps[told] - shared.value, noise, expected.rate_variances[told])
    else:
        shared = _drift_of_offsets(before.offsets, offsets)
    if shared is not None:
        drift = ClockDrift.first(t_ns, shared) if drift is None else drift.told(t_ns, shared)
    return Learned(drift, {**before.offsets, **offsets}, doubt)


def _column(values: list[float | None], unknown: float = math.nan) -> Floats:
    return np.array([unknown if value is None else value for value in values], dtype=np.float64)


def _doubted(doubt: NoiseScale, off_mps: Floats, noise: Floats, claimed: Floats) -> NoiseScale:
    """What is left of single satellites is the velocity's error, seen along their lines."""
    for square, own, by_pose in zip(np.square(off_mps), noise, claimed, strict=True):
        doubt = doubt.learned(float(square), float(own), float(by_pose), 1.0)
    return doubt


def _offsets(
    t_ns: int, satellites: list[RawSatellite], heard: Heard, antenna: Antenna, expected: Expected
) -> dict[str, Offset]:
    pseudoranges_m = _column([each.pseudorange_m for each in satellites])
    stds_m = _column([each.pseudorange_std_m for each in satellites], PSEUDORANGE_STD_M)
    off_m = pseudoranges_m + heard.clock_biases_m - expected.ranges_m
    place = np.full(3, antenna.place_std_m**2)
    offsets = {}
    for system in dict.fromkeys(each.system for each in satellites):
        rows = np.array([each.system == system for each in satellites]) & ~np.isnan(off_m)
        if rows.any():
            shared = shared_part(
                off_m[rows], np.square(stds_m[rows]), expected.by_axes[rows], place
            )
            offsets[system] = Offset(t_ns, shared.value, shared.variance)
    return offsets


def _drift_of_offsets(before: Mapping[str, Offset], now: Mapping[str, Offset]) -> Shared | None:
    """By how much offsets have grown, of a receiver that tells no Doppler."""
    grown = []
    for system, offset in now.items():
        earlier = before.get(system)
        if earlier is not None and offset.t_ns > earlier.t_ns:
            seconds = (offset.t_ns - earlier.t_ns) * 1e-9
            variance = (offset.variance + earlier.variance) / seconds**2
            grown.append(((offset.metres - earlier.metres) / seconds, variance))
    return Shared(*min(grown, key=lambda each: each[1])) if grown else None
