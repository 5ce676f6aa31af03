"""Pure: by how much pseudoranges and Dopplers are off, each satellite's apart."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.satellites.earth import SPEED_OF_LIGHT_MPS
from wayline_simulator.course import Surroundings
from wayline_simulator.gps import Fixes
from wayline_simulator.gps_model import GpsModel
from wayline_simulator.gps_sky import HOUSE_M
from wayline_simulator.journey import Floats, Truth
from wayline_simulator.noise import gauss_markov
from wayline_simulator.raw_model import RawModel

LIGHT_MS_M = SPEED_OF_LIGHT_MPS * 1e-3
NOISE_DBHZ = 45.0
"""Strength at which the models' stds hold."""
FACADES = 512
"""After so many houses the same facades come again."""


class RawErrors(NamedTuple):
    """Shapes (n, satellites), but what says otherwise."""

    code_m: Floats
    """Of pseudoranges, the clocks apart."""
    code_std_m: Floats
    """As the receiver claims: noise alone."""
    rate_mps: Floats
    """Of range rates, the clock's drift apart."""
    rate_std_mps: Floats
    clock_m: Floats
    """Of the receiver's clock, shape (n,)."""
    drift_mps: Floats
    """Shape (n,)."""
    offsets_m: Floats
    """Of each system's clock to the receiver's, shape (systems,)."""


def raw_errors(
    fixes: Fixes, truth: Truth, gps: GpsModel, model: RawModel, random: np.random.Generator
) -> RawErrors:
    """The errors at a receiver's epochs; `truth` at their timestamps."""
    strengths = fixes.view.strengths_dbhz[fixes.rows].astype(np.float64)
    step_s, shape = 1.0 / gps.rate_hz, strengths.shape
    looseness = 10.0 ** ((NOISE_DBHZ - strengths) / 20.0)
    code_std_m = model.code_std_m * looseness
    rate_std_mps = np.maximum(gps.velocity_std_mps, 1e-3) * looseness
    wander_m = gauss_markov(
        shape, step_s, gps.position_wander_std_m, gps.position_wander_time_s, random
    )
    echo_m, is_echo = _echoes_m(fixes, truth, model, random)
    mixed_m = gauss_markov(shape, step_s, 1.0, model.mixed_time_s, random)
    mixed_m *= _by_surroundings(truth, model.mixed_street_m, model.mixed_canyon_m)
    code_m = wander_m + code_std_m * random.standard_normal(shape)
    rate_mps = rate_std_mps * random.standard_normal(shape)
    rate_mps += is_echo * model.echo_doppler_std_mps * random.standard_normal(shape)
    clock_m, drift_mps = _clock(len(strengths), step_s, model, random)
    offsets_m = model.system_offset_std_m * random.standard_normal(len(gps.systems))
    offsets_m[0] = 0.0
    return RawErrors(
        code_m=code_m + np.where(is_echo, echo_m, mixed_m),
        code_std_m=code_std_m,
        rate_mps=rate_mps,
        rate_std_mps=rate_std_mps,
        clock_m=clock_m,
        drift_mps=drift_mps,
        offsets_m=offsets_m,
    )


def _echoes_m(
    fixes: Fixes, truth: Truth, model: RawModel, random: np.random.Generator
) -> tuple[Floats, NDArray[np.bool_]]:
    """The detours by way of the wall that is there, and whether a signal takes one.

    A facade sends a satellite's signal by one way as long as the vehicle is before it, so that who
    stands keeps an error; the detour is shorter for what comes from above.
    """
    is_echo = ~fixes.view.clear[fixes.rows]
    facades = random.gamma(2.0, 0.5, (FACADES, is_echo.shape[1]))
    here = facades[(truth.path_m / HOUSE_M).astype(np.intp) % FACADES]
    level = np.cos(np.radians(fixes.view.elevations_deg[fixes.rows].astype(np.float64)))
    mean_m = _by_surroundings(truth, model.echo_street_m, model.echo_canyon_m)
    return mean_m * here * level, is_echo


def _by_surroundings(truth: Truth, street_m: float, canyon_m: float) -> Floats:
    """Shape (n, 1); among trees and in the open nothing reflects but the road itself."""
    by_kind = np.zeros(len(Surroundings))
    by_kind[Surroundings.STREET], by_kind[Surroundings.CANYON] = street_m, canyon_m
    return np.asarray(by_kind[truth.surroundings][:, np.newaxis])


def _clock(
    count: int, step_s: float, model: RawModel, random: np.random.Generator
) -> tuple[Floats, Floats]:
    """Offset in m and drift in m/s of the receiver's clock."""
    drift_mps = model.clock_drift_std_mps * random.standard_normal()
    walk_mps = model.clock_drift_walk_mps * np.sqrt(step_s) * random.standard_normal(count)
    drifts_mps = drift_mps + np.cumsum(walk_mps)
    walk_m = model.clock_walk_m * np.sqrt(step_s) * random.standard_normal(count)
    start_m = random.uniform(-0.5, 0.5) * LIGHT_MS_M
    clock_m = start_m + np.cumsum(drifts_mps * step_s + walk_m)
    if model.clock_resets:
        clock_m = (clock_m + 0.5 * LIGHT_MS_M) % LIGHT_MS_M - 0.5 * LIGHT_MS_M
    return clock_m, drifts_mps
