"""Pure: what a vehicle tells its receiver of the carrier, how wrong that is, and what it claims."""

import math
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from wayline_evaluation.estimates import Floats
from wayline_evaluation.tracking.loop import SAMPLES_HZ
from wayline_evaluation.tracking.motion import (
    WAVELENGTH_M,
    Motions,
    line_of_sight_hz,
    smooth_process,
)


class AidModel(msgspec.Struct, frozen=True, kw_only=True):
    """What dead reckoning knows, and when it says so. Velocity only: no acceleration is told."""

    interval_s: float = 0.1
    """The rate of `aiding`."""
    carried_on: bool = True
    """A receiver goes on as the last two aids differ; else it holds the last one."""
    latency_s: float = 0.03
    """From the pose's instant to the loop: message, bus, line."""
    speed_std_mps: float = 0.04
    """Of poses in the simulated town, under way (`wayline evaluate accuracy`)."""
    speed_time_s: float = 2.0
    """For so long the wheels' error stays there: rounding, slip."""
    heading_std_deg: float = 0.45
    """Of poses there in outages of GPS."""
    heading_time_s: float = 15.0
    clock_interval_s: float = 1.0
    """The drift is told by the strong satellites' Dopplers, once an epoch."""
    clock_std_hz: float = 0.2


def held(model: AidModel) -> AidModel:
    """The aid, a receiver doing nothing but to hold it."""
    return msgspec.structs.replace(model, carried_on=False)


def as_printed(model: AidModel) -> AidModel:
    """The aid as in papers/001, whose sensors and loops run in one processor.

    It comes every 10 ms, and is a mean over as long.
    """
    return msgspec.structs.replace(model, interval_s=0.01, latency_s=0.01, carried_on=False)


def doubtful(model: AidModel, heading_std_deg: float) -> AidModel:
    """The aid, saying that its heading is so unsure, and being so."""
    return msgspec.structs.replace(model, heading_std_deg=heading_std_deg)


class Wrong(msgspec.Struct, frozen=True, kw_only=True):
    """What else may be wrong with an aid, without its std saying so."""

    heading_deg: float = 0.0
    """Off all the time."""
    spike_mps: float = 0.0
    """A gyro's spike turns the velocity by so much to the side..."""
    spike_at_s: float = 20.0
    spike_time_s: float = 5.0
    """...and courses take it out again, to 1 / e in this."""


RIGHT = Wrong()
SLOWEST_MPS = 1.0
"""A heading means nothing at a crawl."""
TYRES_MPS2 = 10.0
"""As `acceleration_max_mps2` has it."""


class Aid(NamedTuple):
    """Shapes (samples, runs)."""

    moved_hz: Floats
    """By the vehicle's motion."""
    clocks_hz: Floats
    """By the receiver's clock."""
    std_hz: Floats
    """One sigma of both, as the aid claims it."""

    @property
    def doppler_hz(self) -> Floats:
        """What the loop is told to expect."""
        both_hz: Floats = self.moved_hz + self.clocks_hz
        return both_hz


def aid_of(
    motions: Motions, model: AidModel, random: np.random.Generator, wrong: Wrong = RIGHT
) -> Aid:
    """What the vehicles say, held until they say it again."""
    samples, runs = motions.speeds_mps.shape
    speeds_mps = motions.speeds_mps + model.speed_std_mps * smooth_process(
        samples, runs, model.speed_time_s, 2, random
    )
    heading_rad = math.radians(model.heading_std_deg)
    headings_rad = motions.headings_rad + heading_rad * smooth_process(
        samples, runs, model.heading_time_s, 2, random
    )
    headings_rad += _wrong_rad(wrong, motions.speeds_mps)
    moved_hz = line_of_sight_hz(motions, speeds_mps, headings_rad)
    clocks_hz = motions.clocks_hz + model.clock_std_hz * random.standard_normal((1, runs))
    at_hand = _carried if model.carried_on else _held
    return Aid(
        moved_hz=at_hand(moved_hz, model.interval_s, model),
        clocks_hz=_held(clocks_hz, model.clock_interval_s, model),
        std_hz=_held(_std_hz(motions, model), model.interval_s, model),
    )


def _wrong_rad(wrong: Wrong, speeds_mps: Floats) -> Floats:
    since_s = (np.arange(len(speeds_mps)) / SAMPLES_HZ - wrong.spike_at_s)[:, np.newaxis]
    fading = np.where(since_s < 0.0, 0.0, np.exp(-np.maximum(since_s, 0.0) / wrong.spike_time_s))
    spike_rad = wrong.spike_mps * fading / np.maximum(np.abs(speeds_mps), SLOWEST_MPS)
    turned_rad: Floats = math.radians(wrong.heading_deg) + spike_rad
    return turned_rad


def _std_hz(motions: Motions, model: AidModel) -> Floats:
    """By the stds of speed, heading and clock; what an acceleration makes of the age is not in."""
    ahead = motions.headings_rad - motions.azimuths_rad
    level = np.cos(motions.elevations_rad) / WAVELENGTH_M
    by_speed_hz = level * np.cos(ahead) * model.speed_std_mps
    by_heading_hz = level * np.sin(ahead) * motions.speeds_mps * math.radians(model.heading_std_deg)
    std_hz: Floats = np.sqrt(by_speed_hz**2 + by_heading_hz**2 + model.clock_std_hz**2)
    return std_hz


def _held(values: Floats, interval_s: float, model: AidModel) -> Floats:
    """As a receiver has it: the last one of a grid that has come; before it the first."""
    last, _ = _grid(len(values), interval_s, model)
    return values[last]


def _carried(values: Floats, interval_s: float, model: AidModel) -> Floats:
    """Going on from the last one that has come as it differs from the one before.

    What differs by more than tyres can make is no vehicle's motion, and does not go on.
    """
    last, every = _grid(len(values), interval_s, model)
    changes_hzps = (values[last] - values[np.maximum(last - every, 0)]) / (every / SAMPLES_HZ)
    changes_hzps[np.abs(changes_hzps) > TYRES_MPS2 / WAVELENGTH_M] = 0.0
    ages_s = (np.arange(len(values)) - last)[:, np.newaxis] / SAMPLES_HZ
    carried: Floats = values[last] + ages_s * changes_hzps
    return carried


def _grid(samples: int, interval_s: float, model: AidModel) -> tuple[NDArray[np.intp], int]:
    """Which sample is the last told at each, and how many lie between two that are."""
    every, late = round(interval_s * SAMPLES_HZ), round(model.latency_s * SAMPLES_HZ)
    return np.maximum((np.arange(samples) - late) // every * every, 0), every
