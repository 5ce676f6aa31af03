"""Pure: the streets of a simulated network, and the way of each line along them, there and back."""

import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wayline.geo import WGS84, LocalPlane
from wayline.line import Line
from wayline_simulator.network.model import LINES, NetworkModel, Part, randomness

Floats = NDArray[np.float64]

ORIGIN = LocalPlane(50.11, 8.68)
TRUNK_M, BRANCH_M = 5_000.0, 4_500.0
TRUNK_DEG, BRANCHES_DEG = 20.0, (-15.0, 75.0)
"""Which way they lead; their legs wander about it by TURN_DEG."""
TURN_DEG = 25.0
LEGS_M = (250.0, 700.0)
STOP_EVERY_M = 450.0
KERB_M = 5.0
"""Of a stop from the street's middle, on the right."""
LANE_M = 2.0
LIGHT_SHARE = 0.5
"""Of the stretches between stops that have a light."""


class NetworkStop(NamedTuple):
    """A stop of one way of a line."""

    stop_id: str
    name: str
    lat_deg: float
    lon_deg: float
    along_m: float
    is_timepoint: bool


class Way(NamedTuple):
    """A line in one direction."""

    line_id: str
    direction_id: int
    """0 leads from the trunk's end to the branch's."""
    street: Line
    stops: tuple[NetworkStop, ...]
    lights_m: tuple[float, ...]
    fork_m: float
    """Where trunk and branch meet."""

    @property
    def way_id(self) -> str:
        """A name of its own: line and direction."""
        return f"{self.line_id}{self.direction_id}"


def make_ways(model: NetworkModel) -> tuple[Way, ...]:
    """Both directions of every line."""
    random = randomness(model, Part.STREETS)
    trunk = _street(np.zeros(2), TRUNK_DEG, TRUNK_M, random)
    trunk_lights = _lights_m(TRUNK_M, random)
    ways = []
    for line_id, towards_deg in zip(LINES, BRANCHES_DEG, strict=True):
        branch = _street(trunk[-1], towards_deg, BRANCH_M, random)
        lights_m = [*trunk_lights, *(TRUNK_M + at_m for at_m in _lights_m(BRANCH_M, random))]
        points = np.concatenate((trunk, branch[1:]))
        ways.append(_way(line_id, 0, points, lights_m))
        length_m = TRUNK_M + BRANCH_M
        ways.append(_way(line_id, 1, points[::-1], [length_m - at_m for at_m in lights_m[::-1]]))
    return tuple(ways)


def _street(
    start_m: Floats, towards_deg: float, length_m: float, random: np.random.Generator
) -> Floats:
    """Corners of a street in metres east and north, shape (n, 2)."""
    points, left_m = [start_m], length_m
    while left_m > 0.0:
        leg_m = min(random.uniform(*LEGS_M), left_m)
        bearing_rad = math.radians(towards_deg + random.uniform(-TURN_DEG, TURN_DEG))
        step_m = leg_m * np.array([math.sin(bearing_rad), math.cos(bearing_rad)])
        points.append(points[-1] + step_m)
        left_m -= leg_m
    return np.array(points)


def _lights_m(length_m: float, random: np.random.Generator) -> list[float]:
    """Halfway between stops, at some of them."""
    middles_m = np.arange(STOP_EVERY_M / 2.0, length_m, STOP_EVERY_M)
    return [float(at_m) for at_m in middles_m if random.random() < LIGHT_SHARE]


def _way(line_id: str, direction_id: int, points_m: Floats, lights_m: list[float]) -> Way:
    places = np.array([ORIGIN.to_geodetic(*point) for point in points_m.tolist()])
    street = Line(places[:, 0], places[:, 1])
    # metres of the plane and of the line differ by some 1e-5
    scale = street.length_m / (TRUNK_M + BRANCH_M)
    fork_m = (TRUNK_M if direction_id == 0 else BRANCH_M) * scale
    return Way(
        line_id,
        direction_id,
        street,
        tuple(_stops(line_id, direction_id, street, fork_m)),
        tuple(at_m * scale for at_m in lights_m),
        fork_m,
    )


def _stops(line_id: str, direction_id: int, street: Line, fork_m: float) -> list[NetworkStop]:
    """Numbered from the trunk's end; those on the trunk are every line's."""
    alongs_m = np.linspace(0.0, street.length_m, round(street.length_m / STOP_EVERY_M) + 1)
    last = len(alongs_m) - 1
    found = []
    for at, along_m in enumerate(alongs_m.tolist()):
        number = at if direction_id == 0 else last - at
        on_trunk = along_m < fork_m if direction_id == 0 else along_m > fork_m
        name = f"{'T' if on_trunk else line_id}{number}"
        is_end = at in {0, last}
        side = "" if is_end else f"-{'out' if direction_id == 0 else 'in'}"
        kerb_m = 0.0 if is_end else KERB_M
        lats_deg, lons_deg = beside(street, np.array([along_m]), kerb_m)
        place = lats_deg.item(), lons_deg.item()
        is_timepoint = is_end or number in _timepoints(last)
        found.append(NetworkStop(f"{name}{side}", f"Stop {name}", *place, along_m, is_timepoint))
    return found


def _timepoints(last: int) -> set[int]:
    return {last // 4, last // 2, 3 * last // 4}


def beside(street: Line, alongs_m: Floats, right_m: float) -> tuple[Floats, Floats]:
    """Latitudes and longitudes of places so far to the right of a street, shape (n,) each."""
    legs = _legs_at(street, alongs_m)
    headings_deg = street.headings_deg[legs]
    lons_deg, lats_deg, backs_deg = WGS84.fwd(
        street.lons_deg[legs],
        street.lats_deg[legs],
        headings_deg,
        alongs_m - street.distances_m[legs],
    )
    right_deg = np.asarray(backs_deg) - 90.0
    lons_deg, lats_deg, _ = WGS84.fwd(lons_deg, lats_deg, right_deg, np.full(len(legs), right_m))
    return np.asarray(lats_deg), np.asarray(lons_deg)


def headings_at(street: Line, alongs_m: Floats) -> Floats:
    """Direction of travel in degrees, shape (n,)."""
    return street.headings_deg[_legs_at(street, alongs_m)]


def _legs_at(street: Line, alongs_m: Floats) -> NDArray[np.intp]:
    legs = np.searchsorted(street.distances_m, alongs_m, side="right") - 1
    return np.clip(legs, 0, len(street.legs_m) - 1)


def segments(way: Way) -> list[tuple[str, str]]:
    """Between consecutive stops, by their ids: lines that share a street share them."""
    return list(itertools.pairwise(stop.stop_id for stop in way.stops))
