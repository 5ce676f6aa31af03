"""A recorded drive's motion under the satellites of its sky, as the study's loops meet it."""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from wayline.errors import InputError
from wayline.messages import GpsSky, Pose
from wayline_evaluation.estimates import Estimates, Floats, estimates_of
from wayline_evaluation.replays import read_topic
from wayline_evaluation.tracking.loop import SAMPLES_HZ
from wayline_evaluation.tracking.motion import Motions, clock_walks_hz
from wayline_replay.replay import replay

MOVING_MPS = 3.0
"""A stretch is taken if the vehicle is on average so fast."""
LOWEST_DEG = 15.0


class Driven(NamedTuple):
    """What a drive tells the study."""

    drive: str
    estimates: Estimates
    """Of poses whose place, heading and speed are known."""
    satellites: Sequence[tuple[float, float, float]]
    """Unix time, elevation and azimuth (degrees) of every one that was used."""


class Stretches(NamedTuple):
    """Motions, with what the poses claim of them."""

    motions: Motions
    speed_std_mps: float
    heading_std_deg: float
    """Medians."""


def read_driven(folder: Path) -> Driven:
    """Replay a drive. Raises InputError without poses that tell heading and speed, or a sky."""
    with tempfile.TemporaryDirectory(prefix="wayline-evaluate-") as temporary:
        out = Path(temporary)
        replay(folder, out)
        poses, skies = read_topic(out, Pose), read_topic(out, GpsSky)
    moving = [pose for pose in poses if pose.heading_deg is not None and pose.speed_mps is not None]
    satellites = [
        (sky.t_ns * 1e-9, satellite.elevation_deg, satellite.azimuth_deg)
        for sky in skies
        for satellite in sky.satellites
        if satellite.elevation_deg is not None
        and satellite.azimuth_deg is not None
        and satellite.elevation_deg >= LOWEST_DEG
    ]
    if not moving:
        mend = "name a drive with GPS that moves"
        raise InputError(str(folder), "no pose of it tells heading and speed", mend)
    if not satellites:
        mend = "name a drive whose receiver tells its sky (GSV), or none for random motion"
        raise InputError(str(folder), "tells no satellite's elevation and azimuth", mend)
    return Driven(str(folder), estimates_of(moving), satellites)


def stretches_of(
    driven: Driven,
    seconds: float,
    runs: int,
    *,
    clock_hz_per_sqrt_s: float,
    random: np.random.Generator,
) -> Stretches:
    """Stretches of the drive drawn at random, under a satellite each that was there then.

    Raises InputError if the vehicle never moves for so long.
    """
    estimates = driven.estimates
    starts_s = _starts_s(estimates, seconds)
    if len(starts_s) == 0:
        mend = f"name a drive that moves for {seconds:g} s, or give fewer --seconds"
        raise InputError(driven.drive, f"no {seconds:g} s of it without a hole are under way", mend)
    chosen_s = starts_s[random.integers(0, len(starts_s), runs)]
    samples = round(seconds * SAMPLES_HZ)
    times_s = chosen_s + np.arange(samples)[:, np.newaxis] / SAMPLES_HZ
    headings_rad = np.unwrap(np.radians(estimates.headings_deg))
    elevations_deg, azimuths_deg = _under(driven, chosen_s + 0.5 * seconds, random)
    motions = Motions(
        speeds_mps=CubicSpline(estimates.times_s, estimates.speeds_mps)(times_s),
        headings_rad=CubicSpline(estimates.times_s, headings_rad)(times_s),
        elevations_rad=np.radians(elevations_deg),
        azimuths_rad=np.radians(azimuths_deg),
        clocks_hz=clock_walks_hz(clock_hz_per_sqrt_s, samples, runs, random),
    )
    return Stretches(
        motions,
        float(np.nanmedian(estimates.speed_stds_mps)),
        float(np.nanmedian(estimates.heading_stds_deg)),
    )


def _starts_s(estimates: Estimates, seconds: float) -> Floats:
    """From which poses on the vehicle is under way for so long, without a hole."""
    times_s = estimates.times_s
    ends = np.searchsorted(times_s, times_s + seconds)
    whole = ends < len(times_s)
    begins = np.flatnonzero(whole)
    ends = ends[whole]
    driven_m = np.concatenate(
        ([0.0], np.cumsum(np.abs(estimates.speeds_mps[1:]) * np.diff(times_s)))
    )
    gaps = np.concatenate(([0], np.cumsum(np.diff(times_s) > 1.5)))
    fast = driven_m[ends] - driven_m[begins] >= MOVING_MPS * seconds
    starts_s: Floats = times_s[begins[fast & (gaps[ends] == gaps[begins])]]
    return starts_s


def _under(driven: Driven, middles_s: Floats, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Elevations and azimuths (degrees) of one satellite each, of the sky nearest in time."""
    table = np.array(driven.satellites)
    skies_s = np.unique(table[:, 0])
    picked = np.empty((len(middles_s), 2))
    for row, middle_s in enumerate(middles_s):
        nearest_s = skies_s[np.argmin(np.abs(skies_s - middle_s))]
        seen = table[table[:, 0] == nearest_s, 1:]
        picked[row] = seen[random.integers(0, len(seen))]
    return picked[:, 0], picked[:, 1]
