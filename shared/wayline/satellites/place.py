"""Pure: roughly where a receiver is, from the pseudoranges of one epoch alone.

Enough to know where satellites stand in its sky and what the air does to their signals: a kilometre
changes neither by more than a hundredth of a degree and some millimetres.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.messages import RawSatellite
from wayline.satellites.earth import SPEED_OF_LIGHT_MPS, Vector, turned

ROUNDS = 12
"""From the earth's centre; a tenth is enough for most."""
SETTLED_M = 1.0
MISFIT_MAX_M = 1_000.0
RADIUS_MIN_M, RADIUS_MAX_M = 6.33e6, 6.40e6
"""Of places that vehicles drive at, from the earth's centre."""


class Ranged(NamedTuple):
    """A satellite whose place and pseudorange are known, its clock's lead taken in."""

    system: str
    place_m: Vector
    pseudorange_m: float


def ranged(satellite: RawSatellite) -> Ranged | None:
    """A satellite of a message; None where place or pseudorange are not told."""
    told = (satellite.x_m, satellite.y_m, satellite.z_m, satellite.pseudorange_m)
    x_m, y_m, z_m, pseudorange_m = told
    if x_m is None or y_m is None or z_m is None or pseudorange_m is None:
        return None
    lead_m = satellite.clock_bias_m or 0.0
    return Ranged(satellite.system, Vector(x_m, y_m, z_m), pseudorange_m + lead_m)


def rough_place_m(satellites: Sequence[Ranged]) -> Vector | None:
    """Where the pseudoranges of one epoch meet, ECEF in m, by least squares (Gauss-Newton).

    Each system has a clock of its own. None where too few are told, or where they do not meet
    within a kilometre of each other on the earth's surface.
    """
    systems = sorted({each.system for each in satellites})
    if len(satellites) < 3 + len(systems):
        return None
    clocks = np.array([[each.system == system for system in systems] for each in satellites], float)
    told_m = np.array([each.pseudorange_m for each in satellites])
    solved = np.zeros(3 + len(systems))
    for _ in range(ROUNDS):
        rays_m = np.array([_seen_m(each, solved) for each in satellites]) - solved[:3]
        ranges_m = np.linalg.norm(rays_m, axis=1)
        if not ranges_m.all():
            return None
        misfits_m = told_m - ranges_m - clocks @ solved[3:]
        design = np.hstack((-rays_m / ranges_m[:, np.newaxis], clocks))
        step, _, rank, _ = np.linalg.lstsq(design, misfits_m, rcond=None)
        solved += step
        if rank < design.shape[1]:
            return None
        if np.linalg.norm(step[:3]) < SETTLED_M:
            is_there = RADIUS_MIN_M < np.linalg.norm(solved[:3]) < RADIUS_MAX_M
            is_met = float(np.abs(misfits_m).max()) < MISFIT_MAX_M
            return Vector(*solved[:3].tolist()) if is_there and is_met else None
    return None


def _seen_m(satellite: Ranged, solved: NDArray[np.float64]) -> Vector:
    """A satellite's place in the frame of the reception."""
    flight_m = float(np.linalg.norm(np.array(satellite.place_m) - solved[:3]))
    return turned(satellite.place_m, flight_m / SPEED_OF_LIGHT_MPS)
