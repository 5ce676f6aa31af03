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
CRYSTAL_MPS = 1e4
"""No receiver's clock gains more, 33 ppm: it was set by a millisecond between two epochs."""
PSEUDORANGE_STD_M = 10.0
"""Of a receiver that claims none, among houses."""


class Offset(NamedTuple):
    """By how much a system's pseudoranges are longer than its ranges, by the receiver's clock."""

    t_ns: int
    metres: float
    variance: float


class Epoch(NamedTuple):
    """What was measured at an instant and what was expected, a row each satellite."""

    t_ns: int
    satellites: list[RawSatellite]
    heard: Heard
    antenna: Antenna
    expected: Expected


class Learned(msgspec.Struct, frozen=True):
    """What epochs have told."""

    drift: ClockDrift | None = None
    offsets: Mapping[str, Offset] = {}
    """By system: each has a time of its own."""
    doubt: NoiseScale = NoiseScale()
    """Factor on the variance that the pose claims for its velocity along lines of sight."""


def learned(before: Learned, epoch: Epoch) -> Learned:
    """With what one more epoch tells of the clock and of the aid."""
    drift, doubt, offsets = before.drift, before.doubt, _offsets(epoch)
    shared: Shared | None
    dopplers_hz = _column([each.doppler_hz for each in epoch.satellites])
    told = ~np.isnan(dopplers_hz)
    if told.any():
        heard, seen = epoch.heard, epoch.expected
        stds_hz = _column([each.doppler_std_hz for each in epoch.satellites], DOPPLER_STD_HZ)
        noise = np.square(stds_hz / heard.hz_per_mps)[told]
        off_mps = dopplers_hz / heard.hz_per_mps - (seen.rates_mps - heard.clock_drifts_mps)
        variances = epoch.antenna.velocity_variances
        shared = shared_part(off_mps[told], noise, seen.by_axes[told], variances)
        doubt = _doubted(doubt, off_mps[told] - shared.value, noise, seen.rate_variances[told])
    else:
        shared = _drift_of_offsets(before.offsets, offsets)
    if shared is not None and abs(shared.value) <= CRYSTAL_MPS:
        t_ns = epoch.t_ns
        drift = ClockDrift.first(t_ns, shared) if drift is None else drift.told(t_ns, shared)
    return Learned(drift, {**before.offsets, **offsets}, doubt)


def _column(values: list[float | None], unknown: float = math.nan) -> Floats:
    return np.array([unknown if value is None else value for value in values], dtype=np.float64)


def _doubted(doubt: NoiseScale, off_mps: Floats, noise: Floats, claimed: Floats) -> NoiseScale:
    """What is left of single satellites is the velocity's error, seen along their lines."""
    for square, own, by_pose in zip(np.square(off_mps), noise, claimed, strict=True):
        doubt = doubt.learned(float(square), float(own), float(by_pose), 1.0)
    return doubt


def _offsets(epoch: Epoch) -> dict[str, Offset]:
    satellites, seen = epoch.satellites, epoch.expected
    pseudoranges_m = _column([each.pseudorange_m for each in satellites])
    stds_m = _column([each.pseudorange_std_m for each in satellites], PSEUDORANGE_STD_M)
    off_m = pseudoranges_m + epoch.heard.clock_biases_m - seen.ranges_m
    place = np.full(3, epoch.antenna.place_std_m**2)
    offsets = {}
    for system in dict.fromkeys(each.system for each in satellites):
        rows = np.array([each.system == system for each in satellites]) & ~np.isnan(off_m)
        if rows.any():
            noise = np.square(stds_m[rows])
            shared = shared_part(off_m[rows], noise, seen.by_axes[rows], place)
            offsets[system] = Offset(epoch.t_ns, shared.value, shared.variance)
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
