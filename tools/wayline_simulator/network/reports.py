"""Pure: what a bus reports of its place now and then, and where it really was."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.geo import metres_per_degree
from wayline_simulator.network.ride import Ride
from wayline_simulator.network.streets import LANE_M, beside, headings_at
from wayline_simulator.noise import gauss_markov

Floats = NDArray[np.float64]

WANDER_STD_M, WANDER_S = 4.0, 120.0
WHITE_STD_M = 2.0
"""Of a position: a receiver in streets, and the box's rounding."""
SPEED_STD_MPS, HEADING_STD_DEG = 0.3, 4.0
STANDING_MPS = 0.5
"""Slower than this a box repeats the heading that it had."""
JITTER_S = 2.0
LOST_SHARE = 0.02
"""Of the reports, on the way to the agency."""


class Track(NamedTuple):
    """Where a bus was; shape (n,) each. Times are whole seconds after midnight."""

    times_s: Floats
    lats_deg: Floats
    lons_deg: Floats
    headings_deg: Floats
    speeds_mps: Floats
    alongs_m: Floats
    stages: NDArray[np.intp]
    """Which stage of the ride."""


class Reports(NamedTuple):
    """What arrives of a bus; shape (n,) each."""

    times_s: Floats
    lats_deg: Floats
    lons_deg: Floats
    headings_deg: Floats
    speeds_mps: Floats
    stages: NDArray[np.intp]


def track_of(ride: Ride) -> Track:
    """Every second of a ride."""
    parts = []
    for number, stage in enumerate(ride.stages):
        times_s = np.arange(np.ceil(stage.begins_s), np.ceil(stage.ends_s), dtype=np.float64)
        alongs_m, speeds_mps = stage.motion.at(times_s)
        lats_deg, lons_deg = beside(stage.street, alongs_m, LANE_M)
        headings_deg = headings_at(stage.street, alongs_m)
        stages = np.full(len(times_s), number)
        parts.append((times_s, lats_deg, lons_deg, headings_deg, speeds_mps, alongs_m, stages))
    return Track(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def reports_of(track: Track, every_s: float, random: np.random.Generator) -> Reports:
    """A report every so many seconds, somewhat unevenly; some are lost."""
    error_m = gauss_markov((len(track.times_s), 2), 1.0, WANDER_STD_M, WANDER_S, random)
    error_m += random.normal(0.0, WHITE_STD_M, error_m.shape)
    heading_errors_deg = random.normal(0.0, HEADING_STD_DEG, len(track.times_s))
    speed_errors_mps = random.normal(0.0, SPEED_STD_MPS, len(track.times_s))
    rows = np.arange(random.uniform(0.0, every_s), len(track.times_s), every_s)
    rows = rows + random.uniform(0.0, min(JITTER_S, every_s / 2.0), len(rows))
    rows = np.unique(np.minimum(rows, len(track.times_s) - 1).astype(np.intp))
    rows = rows[random.random(len(rows)) >= LOST_SHARE]
    north_m, east_m = metres_per_degree(float(track.lats_deg[0]))
    moving = track.speeds_mps >= STANDING_MPS
    last_moving = np.maximum.accumulate(np.where(moving, np.arange(len(moving)), 0))
    headings_deg = (track.headings_deg + heading_errors_deg)[last_moving] % 360.0
    speeds_mps = np.where(moving, np.maximum(track.speeds_mps + speed_errors_mps, 0.0), 0.0)
    return Reports(
        track.times_s[rows],
        track.lats_deg[rows] + error_m[rows, 0] / north_m,
        track.lons_deg[rows] + error_m[rows, 1] / east_m,
        headings_deg[rows],
        speeds_mps[rows],
        track.stages[rows],
    )
