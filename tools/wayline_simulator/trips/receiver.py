"""Pure: a receiver of papers/003's years, once a second: holes, and fixes of few satellites.

A SiRF Star II keeps telling a position when it sees too few satellites or sees them badly. The
paper's means of such fixes (speeds 4.4 mph off, trips 50 to 98 miles too long) set what is a
judgement here; the noise under an open sky is that of the simulator's consumer preset.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.geo import WGS84
from wayline_simulator.journey import Floats, Truth
from wayline_simulator.noise import gauss_markov

Flags = NDArray[np.bool_]
Counts = NDArray[np.int64]

WHITE_STD_M, WANDER_STD_M, WANDER_S = 0.8, 2.5, 120.0
VELOCITY_STD_MPS = 0.1
REST_STD_MPS = 0.05
"""Of the speed, at rest."""
COURSE_MIN_MPS = 0.5
"""Slower, the receiver tells the last course."""

HOLES_PER_KM = 0.04
HOLE_M = (50.0, 1_000.0)
BAD_EVERY_S, BAD_LASTING_S = 300.0, 12.0
"""Between stretches of few satellites, and how long one lasts, on the average."""
BAD_BESIDE_HOLE_S = 3
"""Satellites go one by one and come so."""
BAD_POSITION_STD_M, BAD_POSITION_S = 40.0, 5.0
WILD_SHARE = 0.04
"""Of the fixes of few satellites: the solution has jumped to another place of the Earth."""
WILD_KM_LOG10 = (-0.5, 2.3)
"""300 m to 200 km, each magnitude as likely; adds some 50 miles to a trip of the average length."""
BAD_SPEED_STD_MPS, BAD_SPEED_BIAS_STD_MPS = 1.5, 2.0
"""4.4 mph between them (papers/003, table 1)."""


class Fixes(NamedTuple):
    """What is told at n whole seconds, shape (n,) each."""

    times_s: Floats
    lats_deg: Floats
    lons_deg: Floats
    speeds_mps: Floats
    courses_deg: Floats
    satellites: Counts
    hdop: Floats
    pdop: Floats


def fixes_of(truth: Truth, random: np.random.Generator) -> Fixes:
    """What such a receiver tells of a journey that is known once a second."""
    count = len(truth.times_s)
    blind = holes(truth.path_m, random)
    bad = _beside(blind, BAD_BESIDE_HOLE_S) | _stretches(count, random)
    errors_m = _position_errors_m(bad, random)
    lons_deg, lats_deg, _ = WGS84.fwd(
        truth.lons_deg,
        truth.lats_deg,
        np.degrees(np.arctan2(*errors_m.T)),
        np.linalg.norm(errors_m, axis=1),
    )
    speeds_mps, courses_deg = _motion(truth, bad, random)
    satellites, pdop = _sky(bad, random)
    told = Fixes(
        times_s=truth.times_s,
        lats_deg=np.asarray(lats_deg),
        lons_deg=np.asarray(lons_deg),
        speeds_mps=speeds_mps,
        courses_deg=courses_deg,
        satellites=satellites,
        hdop=0.6 * pdop,
        pdop=pdop,
    )
    return Fixes(**{name: column[~blind] for name, column in told._asdict().items()})


def holes(path_m: Floats, random: np.random.Generator) -> Flags:
    """Seconds without a fix: under bridges and between walls, never at either end of the trip."""
    blind = np.zeros(len(path_m), dtype=bool)
    length_m = float(path_m[-1])
    for _ in range(random.poisson(HOLES_PER_KM * length_m / 1_000.0)):
        long_m = random.uniform(*HOLE_M)
        if long_m < 0.5 * length_m:
            begin_m = random.uniform(0.1 * length_m, 0.9 * length_m - long_m)
            blind |= (path_m > begin_m) & (path_m < begin_m + long_m)
    return blind


def _beside(flags: Flags, steps: int) -> Flags:
    """So many steps before and after the flags."""
    window = np.ones(2 * steps + 1)
    return np.convolve(flags, window, mode="same") > 0.5


def _stretches(count: int, random: np.random.Generator) -> Flags:
    """Good and bad by turns, good at first."""
    state = np.zeros(count, dtype=bool)
    at = 0
    while at < count:
        at += 1 + int(random.exponential(BAD_EVERY_S))
        lasting = 1 + int(random.exponential(BAD_LASTING_S))
        state[at : at + lasting] = True
        at += lasting
    return state


def _position_errors_m(bad: Flags, random: np.random.Generator) -> Floats:
    """East and north, shape (n, 2)."""
    shape = len(bad), 2
    errors_m = gauss_markov(shape, 1.0, WANDER_STD_M, WANDER_S, random)
    errors_m += random.normal(0.0, WHITE_STD_M, shape)
    loose_m = gauss_markov(shape, 1.0, BAD_POSITION_STD_M, BAD_POSITION_S, random)
    wild = random.random(len(bad)) < WILD_SHARE
    away_m = 1e3 * 10.0 ** random.uniform(*WILD_KM_LOG10, len(bad))
    where_rad = random.uniform(0.0, 2.0 * np.pi, len(bad))
    loose_m[wild] += (away_m * np.array([np.sin(where_rad), np.cos(where_rad)])).T[wild]
    return np.where(bad[:, np.newaxis], errors_m + loose_m, errors_m)


def _motion(truth: Truth, bad: Flags, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Speeds and courses, by Doppler."""
    count = len(bad)
    std_mps = np.where(truth.speeds_mps > 0.1, VELOCITY_STD_MPS, REST_STD_MPS)
    noise_mps = std_mps * random.standard_normal(count)
    bias_mps = gauss_markov(count, 1.0, BAD_SPEED_BIAS_STD_MPS, BAD_LASTING_S, random)
    bias_mps += random.normal(0.0, BAD_SPEED_STD_MPS, count)
    speeds_mps = np.abs(np.abs(truth.speeds_mps) + noise_mps + np.where(bad, bias_mps, 0.0))
    off_rad = random.normal(0.0, VELOCITY_STD_MPS, count) / np.maximum(speeds_mps, COURSE_MIN_MPS)
    moving = speeds_mps >= COURSE_MIN_MPS
    last = np.maximum.accumulate(np.where(moving, np.arange(count), 0))
    return speeds_mps, ((truth.courses_deg + np.degrees(off_rad)) % 360.0)[last]


def _sky(bad: Flags, random: np.random.Generator) -> tuple[Counts, Floats]:
    """Satellites in use and PDOP: of a bad fix at least one is beyond the paper's limits."""
    count = len(bad)
    seen = np.clip(np.round(7.0 + gauss_markov(count, 1.0, 1.2, 60.0, random)), 5.0, 11.0)
    pdop = np.clip(2.4 + gauss_markov(count, 1.0, 0.6, 60.0, random), 1.3, 5.0)
    few = bad & (random.random(count) < 0.7)
    poor = bad & ~few
    satellites = np.where(few, 3.0, np.where(poor, 4.0, seen)).astype(np.int64)
    return satellites, np.where(bad, random.uniform(8.5, 30.0, count), pdop)
