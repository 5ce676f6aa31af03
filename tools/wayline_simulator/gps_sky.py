"""Pure: which satellites a receiver hears among houses and trees, and how well they fix it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline_simulator.constellation import SKY_STEP_S, Heavens, System, heavens
from wayline_simulator.course import Surroundings
from wayline_simulator.journey import Floats, Truth
from wayline_simulator.noise import gauss_markov

Singles = NDArray[np.float32]

VIEW_STEP_S = 1.0
"""Receivers weigh anew which satellites to use about once a second."""
STRENGTH_LOW_DBHZ, STRENGTH_RISE_DBHZ = 26.0, 20.0
"""Carrier to noise at the horizon, and how much more at the zenith: 46 dB-Hz there is usual of a
patch antenna, which hears little at the horizon. With two systems 18 satellites are used under an
open sky, 12 among trees; css-164 uses 12 on average."""
USE_DBHZ, LOSE_DBHZ = 30.0, 25.0
"""A signal is used from the first on until it falls below the second, so that the set does not
flicker. A judgement: receivers track down to 20 dB-Hz but weigh such signals to nothing."""
HEARD_DBHZ = 15.0
"""Weaker is not reported."""
EDGE_RAD = np.radians(3.0)
"""Behind the edge of a roof a signal fades over this angle: diffraction."""
HOUSE_M = 25.0
"""Length of a facade."""
HOUSES = 4096
HOUSES_SEED = 4
"""Houses stand where they stood in the run before: they are no part of a drive's randomness."""
DILUTION_MAX = 99.99
CHUNK = 2000
"""Instants whose matrices are held in memory at once."""
ALTITUDE_WEIGHT = 1e4
"""An altitude that is held counts like so many ranges."""


class Scene(NamedTuple):
    """What kind of place does to signals; judgements, from GSV sentences of Munich's streets."""

    height_m: float = 0.0
    """Of the houses above the antenna, on average."""
    half_width_m: float = 10.0
    end_deg: float = 0.0
    """Elevation of what closes the street."""
    loss_db: float = 25.0
    """Of a signal behind a house: reflected ones come through."""
    canopy_db: float = 0.0
    """Of leaves, straight from below; more at an angle."""
    fading_db: float = 2.0
    fading_time_s: float = 8.0


SCENES = {
    Surroundings.OPEN: Scene(),
    Surroundings.TREES: Scene(canopy_db=2.5, fading_db=3.0, end_deg=5.0),
    Surroundings.STREET: Scene(height_m=8.0, end_deg=8.0, loss_db=18.0, fading_db=2.5),
    Surroundings.CANYON: Scene(height_m=20.0, end_deg=12.0, loss_db=12.0, fading_db=3.5),
}
CANOPY_SIN_MIN = 0.35
"""Lower rays leave the row of trees before they cross more leaves."""


class View(NamedTuple):
    """What a receiver hears once a second. Shapes (n, satellites) or (n,) or (satellites,)."""

    azimuths_deg: Singles
    elevations_deg: Singles
    strengths_dbhz: Singles
    """0: not heard."""
    used: NDArray[np.bool_]
    clear: NDArray[np.bool_]
    """Nothing stands between: else what is heard comes by way of a wall."""
    systems: NDArray[np.intp]
    prns: NDArray[np.intp]
    mode: NDArray[np.int8]
    """1 no fix possible, 2 with an altitude that is held, 3."""
    hdop: Floats
    vdop: Floats
    pdop: Floats


def view_of(
    truth: Truth,
    start_s: float,
    *,
    systems: tuple[System, ...],
    mask_deg: float,
    pdop_max: float,
    random: np.random.Generator,
) -> View:
    """What is heard along a journey; `truth` once every VIEW_STEP_S, `start_s` its Unix zero."""
    rows = (np.arange(len(truth.times_s)) * VIEW_STEP_S / SKY_STEP_S).astype(np.intp)
    coarse = slice(None, None, round(SKY_STEP_S / VIEW_STEP_S))
    sky = heavens(
        start_s + truth.times_s[coarse], truth.lats_deg[coarse], truth.lons_deg[coarse], systems
    )
    azimuths = sky.azimuths_rad.astype(np.float32)[rows]
    elevations = sky.elevations_rad.astype(np.float32)[rows]
    strengths, clear = _strengths(truth, azimuths, elevations, random)
    strengths[strengths < HEARD_DBHZ] = 0.0
    used = latched(strengths > USE_DBHZ, strengths < LOSE_DBHZ)
    used &= elevations > np.radians(mask_deg)
    mode, dilutions = _geometry(used, azimuths, elevations, sky)
    mode[dilutions[:, 2] > pdop_max] = 1
    dilutions[mode == 2, 1:] = DILUTION_MAX
    return View(
        azimuths_deg=np.degrees(azimuths),
        elevations_deg=np.degrees(elevations),
        strengths_dbhz=strengths,
        used=used,
        clear=clear,
        systems=sky.systems,
        prns=sky.prns,
        mode=mode,
        hdop=dilutions[:, 0],
        vdop=dilutions[:, 1],
        pdop=dilutions[:, 2],
    )


def latched(on: NDArray[np.bool_], off: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """A switch along the first axis that stays as it is where neither is true; off at first."""
    places = np.arange(1, len(on) + 1, dtype=np.int32)[:, np.newaxis]
    last_on = np.maximum.accumulate(np.where(on, places, 0), axis=0)
    last_off = np.maximum.accumulate(np.where(off, places, 0), axis=0)
    return last_on > last_off


def _strengths(
    truth: Truth, azimuths: Singles, elevations: Singles, random: np.random.Generator
) -> tuple[Singles, NDArray[np.bool_]]:
    """Carrier to noise, 0 where nothing gets through, and whether the way is clear.

    What fades, fades each signal apart.
    """
    rise = np.sin(np.maximum(elevations, 0.0))
    strengths = (STRENGTH_LOW_DBHZ + STRENGTH_RISE_DBHZ * rise).astype(np.float32)
    fading_time_s = Scene().fading_time_s
    fading = gauss_markov(strengths.shape, VIEW_STEP_S, 1.0, fading_time_s, random).astype(
        np.float32
    )
    clear = np.ones(strengths.shape, dtype=np.bool_)
    for kind, scene in SCENES.items():
        here = truth.surroundings == kind
        strengths[here] -= scene.canopy_db / np.maximum(rise[here], CANOPY_SIN_MIN)
        strengths[here] += scene.fading_db * fading[here]
        roof = _roof_rad(scene, truth, azimuths, here)
        behind = np.clip((roof - elevations[here]) / EDGE_RAD, 0.0, 1.0)
        strengths[here] -= scene.loss_db * behind.astype(np.float32)
        clear[here] = roof <= elevations[here]
    strengths[(elevations < 0.0) | (truth.surroundings >= Surroundings.BRIDGE)[:, np.newaxis]] = 0.0
    return strengths, clear


def _roof_rad(
    scene: Scene, truth: Truth, azimuths: Singles, here: NDArray[np.bool_]
) -> NDArray[np.floating]:
    """Elevation of the obstruction in the direction of every satellite."""
    beside = np.sin(azimuths[here] - np.radians(truth.headings_deg[here])[:, np.newaxis])
    heights = np.random.default_rng(HOUSES_SEED).gamma(6.0, 1.0 / 6.0, (HOUSES, 2))
    house = (truth.path_m[here] / HOUSE_M).astype(np.intp) % HOUSES
    factor = np.where(beside > 0.0, heights[house, :1], heights[house, 1:])
    walls = np.arctan(scene.height_m * factor * np.abs(beside) / scene.half_width_m)
    return np.maximum(walls, np.radians(scene.end_deg))


def _geometry(
    used: NDArray[np.bool_], azimuths: Singles, elevations: Singles, sky: Heavens
) -> tuple[NDArray[np.int8], Floats]:
    """Mode and HDOP, VDOP, PDOP of least squares with one clock a constellation."""
    clocks = np.eye(int(sky.systems.max()) + 1)[sky.systems]
    heard = used @ clocks
    ranges, unknown_clocks = heard.sum(axis=1), (heard > 0.0).sum(axis=1)
    mode = np.where(ranges >= 3 + unknown_clocks, 3, np.where(ranges >= 2 + unknown_clocks, 2, 1))
    mode[ranges < 3] = 1
    parts = [
        _dilutions(used[rows], azimuths[rows], elevations[rows], clocks, mode[rows] == 2)
        for first in range(0, len(used), CHUNK)
        for rows in [slice(first, first + CHUNK)]
    ]
    dilutions = np.concatenate(parts)
    dilutions[mode == 1] = DILUTION_MAX
    return mode.astype(np.int8), dilutions


def _dilutions(
    used: NDArray[np.bool_],
    azimuths: Singles,
    elevations: Singles,
    clocks: Floats,
    altitude_held: NDArray[np.bool_],
) -> Floats:
    """HDOP, VDOP, PDOP, shape (n, 3)."""
    level = np.cos(elevations)
    rays = np.stack(
        (level * np.sin(azimuths), level * np.cos(azimuths), np.sin(elevations)), axis=-1
    )
    design = np.concatenate((rays, np.broadcast_to(clocks, (len(used), *clocks.shape))), axis=2)
    design = design * used[:, :, np.newaxis]
    normal = np.swapaxes(design, 1, 2) @ design
    diagonal = np.arange(normal.shape[1])
    # a clock without a satellite must not make the matrix singular
    normal[:, diagonal, diagonal] += np.where(normal[:, diagonal, diagonal] == 0.0, 1.0, 1e-9)
    normal[:, 2, 2] += ALTITUDE_WEIGHT * altitude_held
    variances = np.maximum(np.diagonal(np.linalg.inv(normal), axis1=1, axis2=2), 0.0)
    level_variance = variances[:, 0] + variances[:, 1]
    squares = np.column_stack((level_variance, variances[:, 2], level_variance + variances[:, 2]))
    return np.asarray(np.minimum(np.sqrt(squares), DILUTION_MAX))
