"""Pure: a planned route: its line, its planned speeds and its stops."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wayline.errors import InputError
from wayline.line import Line
from wayline.messages import LIST_MAX, TEXT_MAX
from wayline.stops import Stop, StopPlace, place_stops

Floats = NDArray[np.float64]

DEFAULT_SPEED_MPS = 8.0
"""For a route without planned speeds: what a town bus averages between its stops."""
CLOSED_WITHIN_M = 0.5
"""How near a loop's last vertex must be to its first."""

LEG_MAX_M = 500_000.0
"""Between two vertices; a longer one has a mistake in an end, as an exchanged latitude."""


class Route:
    """A directed line with one planned speed a leg, and stops in order of travel.

    `speeds_mps` has shape (legs,), all positive. A loop's line ends where it begins. Distances
    are metres along the line from its start, planned times seconds from there without dwells.
    """

    def __init__(
        self,
        *,
        route_id: str,
        name: str,
        loop: bool,
        line: Line,
        speeds_mps: Floats,
        stops: Sequence[Stop],
    ) -> None:
        self.route_id, self.name, self.loop, self.line = route_id, name, loop, line
        self.speeds_mps = np.asarray(speeds_mps, dtype=np.float64)
        if len(self.speeds_mps) != len(line.legs_m) or not np.all(self.speeds_mps > 0.0):
            raise ValueError("a route needs one positive speed a leg")
        self.stops = tuple(stops)

    @property
    def length_m(self) -> float:
        """Length of the line."""
        return self.line.length_m

    @cached_property
    def planned_times_s(self) -> Floats:
        """Planned time from the start to every vertex, shape (legs + 1,)."""
        return np.concatenate(([0.0], np.cumsum(self.line.legs_m / self.speeds_mps)))

    @property
    def duration_s(self) -> float:
        """Planned time from start to end, without dwells."""
        return float(self.planned_times_s[-1])

    @cached_property
    def stop_distances_m(self) -> Floats:
        """Where the stops lie along the line, shape (stops,)."""
        return np.array([stop.distance_m for stop in self.stops], dtype=np.float64)

    @cached_property
    def stop_dwells_s(self) -> Floats:
        """How long the vehicle is planned to stand at each stop, shape (stops,)."""
        return np.array([stop.dwell_s for stop in self.stops], dtype=np.float64)

    @cached_property
    def has_each_stop_once(self) -> bool:
        """Whether no stop is served twice on a way from the start to the end."""
        return len({stop.stop_id for stop in self.stops}) == len(self.stops)

    def time_at(self, distances_m: Floats) -> Floats:
        """Planned time to distances; on a loop they go on over the end (a lap and 5 m, say)."""
        if not self.loop:
            return np.interp(distances_m, self.line.distances_m, self.planned_times_s)
        laps, within_m = np.divmod(distances_m, self.length_m)
        within_s = np.interp(within_m, self.line.distances_m, self.planned_times_s)
        return laps * self.duration_s + within_s

    def distance_at(self, time_s: float) -> float:
        """The inverse of `time_at` for one time: where the plan is after so many seconds."""
        laps, within_s = divmod(time_s, self.duration_s) if self.loop else (0.0, time_s)
        within_m = np.interp(within_s, self.planned_times_s, self.line.distances_m)
        return laps * self.length_m + float(within_m)

    def speed_at(self, distance_m: float) -> float:
        """Planned speed at a distance along the line."""
        return float(self.speeds_mps[self.line.leg_at(distance_m)])


def make_route(
    where: str,
    *,
    route_id: str,
    name: str,
    loop: bool,
    vertices: Sequence[tuple[float, float]],
    speeds_mps: Sequence[float] | None,
    stops: Sequence[StopPlace],
) -> Route:
    """A route from (latitude, longitude) vertices in degrees, checked, its stops placed in order.

    Missing speeds become DEFAULT_SPEED_MPS; legs without length are dropped with their speed.
    Raises InputError, naming `where`, for what no vehicle could drive.
    """
    if len(vertices) < 2:
        raise InputError(
            where, f"the line has {len(vertices)} point(s)", "a route needs two or more"
        )
    lats_deg, lons_deg = np.array(vertices, dtype=np.float64).T
    speeds = _leg_speeds(where, len(vertices) - 1, speeds_mps)
    # degrees may differ where places do not: at a pole, at both ends of the longitudes
    moves = Line(lats_deg, lons_deg).legs_m > 0.0
    if not moves.any():
        raise InputError(where, "all points of the line are one", "a route needs two or more")
    kept = np.concatenate(([True], moves))
    line = Line(lats_deg[kept], lons_deg[kept])
    _check_legs(where, line)
    _check_texts(where, route_id, stops)
    if loop:
        _check_closed(where, line)
    placed = place_stops(where, line, stops, loop=loop)
    return Route(
        route_id=route_id, name=name, loop=loop, line=line, speeds_mps=speeds[moves], stops=placed
    )


def _check_texts(where: str, route_id: str, stops: Sequence[StopPlace]) -> None:
    """Of what messages carry; readers would drop them all for one text or list beyond its bound."""
    texts = {
        "route_id": [route_id],
        "stop_id": [stop.stop_id for stop in stops],
        "stop's name": [stop.name for stop in stops],
    }
    for what, found in texts.items():
        longest = max(found, key=len, default="")
        if len(longest) > TEXT_MAX:
            said = f"the {what} {longest[:20]!r}... has {len(longest)} characters"
            raise InputError(where, said, f"use at most {TEXT_MAX}")
    if len(stops) > LIST_MAX:
        raise InputError(where, f"has {len(stops):,} stops", f"use at most {LIST_MAX:,} a route")


def _leg_speeds(where: str, legs: int, speeds_mps: Sequence[float] | None) -> Floats:
    if speeds_mps is None:
        return np.full(legs, DEFAULT_SPEED_MPS)
    if len(speeds_mps) != legs:
        raise InputError(
            where, f"{len(speeds_mps)} speeds_mps for {legs} legs", "give one speed a leg"
        )
    speeds = np.array(speeds_mps, dtype=np.float64)
    wrong = np.flatnonzero(~(np.isfinite(speeds) & (speeds > 0.0)))
    if len(wrong):
        raise InputError(
            where,
            f"speed {speeds[wrong[0]]:g} of leg {wrong[0] + 1} is not positive",
            "give every leg a speed above 0 in m/s",
        )
    return speeds


def _check_legs(where: str, line: Line) -> None:
    leg = int(line.legs_m.argmax())
    if line.legs_m[leg] > LEG_MAX_M:
        ends = " to ".join(f"{line.lats_deg[at]:g}, {line.lons_deg[at]:g}" for at in (leg, leg + 1))
        raise InputError(
            where,
            f"a leg of {line.legs_m[leg] / 1000.0:,.0f} km (latitude, longitude {ends})",
            "correct that point, or exchange its latitude and longitude",
        )


def _check_closed(where: str, line: Line) -> None:
    gap_m = Line(line.lats_deg[[-1, 0]], line.lons_deg[[-1, 0]]).length_m
    if gap_m > CLOSED_WITHIN_M:
        raise InputError(
            where,
            f"a loop that ends {gap_m:.1f} m from its first vertex",
            "repeat the first vertex at the end or set loop to false",
        )
