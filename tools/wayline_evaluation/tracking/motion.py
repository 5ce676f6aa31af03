"""Pure: how vehicles move under satellites, drawn at random, 100 times a second."""

import math
from typing import NamedTuple

import msgspec
import numpy as np
from scipy.signal import lfilter

from wayline.satellites.earth import SPEED_OF_LIGHT_MPS
from wayline_evaluation.estimates import Floats
from wayline_evaluation.tracking.loop import SAMPLES_HZ

WAVELENGTH_M = SPEED_OF_LIGHT_MPS / 1_575.42e6
"""Of L1."""
SETTLED_TIMES = 20.0
"""Correlation times after which a process has forgotten how it began."""


class MotionModel(msgspec.Struct, frozen=True, kw_only=True):
    """Random acceleration, as large as under way in the simulated town."""

    speed_mps: float = 12.0
    speed_std_mps: float = 3.0
    speed_time_s: float = 2.5
    """With it the acceleration is 0.7 m/s2 and the jerk 0.5 m/s3, one sigma: what is seen there."""
    lateral_std_mps2: float = 0.8
    """What is seen there."""
    lateral_time_s: float = 1.5
    lowest_deg: float = 15.0
    """Elevations of satellites are spread evenly over the sky above it."""
    clock_hz_per_sqrt_s: float = 0.43
    """Random walk of a temperature-compensated crystal, h-2 = 3.8e-21."""


LOW_DYNAMICS = MotionModel(speed_std_mps=1.0, speed_time_s=5.0, lateral_std_mps2=0.2)
"""As figure 9 has them: a straight road, an even speed; accelerations of 0.1 and 0.2 m/s2."""


class Motions(NamedTuple):
    """Vehicles and a satellite each; shapes (samples, runs) and (runs,), radians."""

    speeds_mps: Floats
    headings_rad: Floats
    elevations_rad: Floats
    azimuths_rad: Floats
    clocks_hz: Floats
    """What the receiver's own clock adds, shape (samples, runs)."""


def smooth_process(
    samples: int, runs: int, time_s: float, poles: int, random: np.random.Generator
) -> Floats:
    """Gauss-Markov processes of some order, stationary with a std of 1, shape (samples, runs).

    With equal poles at 1 / `time_s`; `poles` - 1 derivatives exist.
    """
    settling = math.ceil(SETTLED_TIMES * time_s * SAMPLES_HZ)
    decay = math.exp(-1.0 / (time_s * SAMPLES_HZ))
    impulse = np.zeros(settling)
    impulse[0] = 1.0
    response, driven = impulse, random.standard_normal((settling + samples, runs))
    for _ in range(poles):
        response = lfilter([1.0], [1.0, -decay], response)
        driven = lfilter([1.0], [1.0, -decay], driven, axis=0)
    made: Floats = driven[settling:] / math.sqrt(float(response @ response))
    return made


def random_motions(
    model: MotionModel, samples: int, runs: int, random: np.random.Generator
) -> Motions:
    """Speeds with a jerk, turns with a jerk, and a satellite anywhere above the mask."""
    speeds_mps = model.speed_mps + model.speed_std_mps * smooth_process(
        samples, runs, model.speed_time_s, 3, random
    )
    lateral_mps2 = model.lateral_std_mps2 * smooth_process(
        samples, runs, model.lateral_time_s, 2, random
    )
    turns_rad = np.cumsum(lateral_mps2 / model.speed_mps / SAMPLES_HZ, axis=0)
    first_rad = random.uniform(0.0, 2.0 * math.pi, runs)
    elevations_deg, azimuths_deg = spread_deg(runs, model.lowest_deg, random)
    return Motions(
        speeds_mps=speeds_mps,
        headings_rad=first_rad + turns_rad,
        elevations_rad=np.radians(elevations_deg),
        azimuths_rad=np.radians(azimuths_deg),
        clocks_hz=clock_walks_hz(model.clock_hz_per_sqrt_s, samples, runs, random),
    )


def spread_deg(runs: int, lowest_deg: float, random: np.random.Generator) -> tuple[Floats, Floats]:
    """Elevations above a mask and azimuths, spread evenly over the sky, degrees."""
    lowest = math.sin(math.radians(lowest_deg))
    elevations_deg = np.degrees(np.arcsin(random.uniform(lowest, 1.0, runs)))
    return elevations_deg, random.uniform(0.0, 360.0, runs)


def clock_walks_hz(
    hz_per_sqrt_s: float, samples: int, runs: int, random: np.random.Generator
) -> Floats:
    """Frequencies of clocks that begin at 0, shape (samples, runs)."""
    steps_hz = random.standard_normal((samples, runs)) * hz_per_sqrt_s / math.sqrt(SAMPLES_HZ)
    steps_hz[0] = 0.0
    walks_hz: Floats = np.cumsum(steps_hz, axis=0)
    return walks_hz


def line_of_sight_hz(motions: Motions, speeds_mps: Floats, headings_rad: Floats) -> Floats:
    """Doppler by a vehicle's speed towards its satellite, shape (samples, runs).

    A satellite's own motion is left out: its ephemeris tells it to a hundredth of a Hz, and its
    change is so slow (0.5 Hz/s, no jerk) that any loop of second order follows it.
    """
    towards = np.cos(motions.elevations_rad) * np.cos(headings_rad - motions.azimuths_rad)
    doppler_hz: Floats = speeds_mps * towards / WAVELENGTH_M
    return doppler_hz


def doppler_hz(motions: Motions) -> Floats:
    """Of the signals as they come: motion and clock, shape (samples, runs)."""
    moved_hz = line_of_sight_hz(motions, motions.speeds_mps, motions.headings_rad)
    signal_hz: Floats = moved_hz + motions.clocks_hz
    return signal_hz
