"""Drives of known motion along lines of known shape, for the tests of eta."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from wayline.geo import LocalPlane
from wayline.inputs import Tick
from wayline.line import Line
from wayline.messages import Arrivals, Pose, Progress
from wayline.route import Route, make_route
from wayline.stops import StopPlace
from wayline_eta.core import EtaCore

TOWN = LocalPlane(39.9, -75.35)
START_NS = 1_700_000_000_000_000_000
SECOND_NS = 1_000_000_000

Metres = tuple[float, float]

SQUARE: list[Metres] = [(0, 0), (0, 500), (500, 500), (500, 0), (0, 0)]
SPUR: list[Metres] = [(0, 0), (1000, 0), (1000, 400), (1000, 0), (2000, 0)]


def line_of(points_m: Sequence[Metres]) -> Line:
    places = np.array([TOWN.to_geodetic(east_m, north_m) for east_m, north_m in points_m])
    return Line(places[:, 0], places[:, 1])


def route_of(
    points_m: Sequence[Metres],
    *,
    route_id: str = "r",
    speed_mps: float = 10.0,
    stops_m: Sequence[float] = (),
    dwell_s: float = 0.0,
) -> Route:
    """A route through points (east, north) with stops at distances along it."""
    line = line_of(points_m)
    stops = []
    for number, stop_m in enumerate(stops_m):
        lat_deg, lon_deg, _ = line.point_at(stop_m)
        stops.append(StopPlace(f"s{number}", f"Stop {number}", lat_deg, lon_deg, dwell_s))
    return make_route(
        "test",
        route_id=route_id,
        name=route_id,
        loop=points_m[0] == points_m[-1],
        vertices=[(float(a), float(b)) for a, b in zip(line.lats_deg, line.lons_deg, strict=True)],
        speeds_mps=[speed_mps] * len(line.legs_m),
        stops=stops,
    )


def poses(
    points_m: Sequence[Metres],
    speeds_mps: Iterable[float],
    *,
    noise_m: float = 0.0,
    seed: int = 1,
    start_m: float = 0.0,
    laps: bool = False,
    headed: bool = True,
    travelled_m: float = 0.0,
    start_ns: int = START_NS,
) -> list[tuple[Pose, float]]:
    """One pose a second and the true distance along the line, at one speed a second.

    The noise is correlated over about 10 s, as that of a receiver.
    """
    line, random = line_of(points_m), np.random.default_rng(seed)
    error_m, along_m, made = random.normal(0.0, noise_m, 2), start_m, []
    for second, speed_mps in enumerate(speeds_mps):
        lat_deg, lon_deg, heading_deg = line.point_at(along_m % line.length_m if laps else along_m)
        east_m, north_m = TOWN.to_plane(lat_deg, lon_deg)
        lat_deg, lon_deg = TOWN.to_geodetic(east_m + error_m[0], north_m + error_m[1])
        pose = Pose(
            t_ns=start_ns + second * SECOND_NS,
            mode="fused",
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            heading_deg=heading_deg if headed else None,
            speed_mps=speed_mps,
            distance_m=travelled_m,
            east_std_m=max(noise_m, 0.5),
            north_std_m=max(noise_m, 0.5),
        )
        made.append((pose, along_m))
        along_m += speed_mps if laps else min(speed_mps, line.length_m - along_m)
        travelled_m += speed_mps
        error_m = 0.9 * error_m + random.normal(0.0, noise_m * np.sqrt(1 - 0.9**2), 2)
    return made


@dataclass(frozen=True)
class Told:
    """What the core said at one second."""

    true_m: float
    progress: Progress
    arrivals: Arrivals


def follow(core: EtaCore, drive: Sequence[tuple[Pose, float]]) -> list[Told]:
    """Feed poses, each followed by the tick of its instant."""
    told = []
    for pose, true_m in drive:
        assert core.handle(pose, "fusion") == ()
        outputs = core.handle(Tick(pose.t_ns), "clock")
        answers = [output for output in outputs if isinstance(output, Progress | Arrivals)]
        if not answers:
            continue
        progress, arrivals = answers
        assert isinstance(progress, Progress)
        assert isinstance(arrivals, Arrivals)
        assert progress.t_ns == arrivals.t_ns == pose.t_ns
        told.append(Told(true_m, progress, arrivals))
    return told
