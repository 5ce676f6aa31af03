"""Pure: a made-up loop road with stops, and what a vehicle that drives on it has put on the bus.

A vehicle without CAN: gps-ingest tells a fix and its health once a second, fusion a pose (1 Hz, or
10 Hz as of a vehicle with CAN), once a second its status and its health. What nobody on a server
reads (sky, gyro, odometer) stays on the vehicle.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from wayline import __version__
from wayline.geo import LocalPlane, wrap_360
from wayline.messages import FusionStatus, GpsFix, Health, Message, Pose, Verdict
from wayline.route import Route, make_route
from wayline.stops import StopPlace

ORIGIN = LocalPlane(48.1, 11.5)
ROUTE_ID = "ring"
LEGS = 180
STOPS = 18
SPEED_MPS = 9.0
GRADE_PCT = 1.5
GPS, FUSION = "gps-ingest", "fusion"
TOLD_HZ = 1.0
"""All but poses."""


class Said(NamedTuple):
    """A message and the service that puts it on the bus."""

    source: str
    message: Message


def ring() -> Route:
    """A closed road of some 8 km with bends of all radii and a stop every 450 m."""
    turns_rad = np.linspace(0.0, 2.0 * np.pi, LEGS + 1)
    radii_m = 1200.0 + 250.0 * np.cos(3.0 * turns_rad)
    plane_m = zip(radii_m * np.sin(turns_rad), radii_m * np.cos(turns_rad), strict=True)
    vertices = [ORIGIN.to_geodetic(float(east_m), float(north_m)) for east_m, north_m in plane_m]
    vertices[-1] = vertices[0]
    stops = [
        StopPlace(f"stop-{number}", f"Stop {number}", *vertices[number * LEGS // STOPS], 15.0)
        for number in range(STOPS)
    ]
    return make_route(
        "the bench's ring",
        route_id=ROUTE_ID,
        name="Ring",
        loop=True,
        vertices=vertices,
        speeds_mps=[SPEED_MPS] * LEGS,
        stops=stops,
    )


class Vehicle:
    """A vehicle that goes round at SPEED_MPS; `start_m` is where on the line it is at first."""

    def __init__(self, route: Route, start_m: float, start_ns: int) -> None:
        self._route, self._start_m, self._start_ns = route, start_m, start_ns

    def say(self, t_ns: int, *, pose_only: bool = False) -> Iterator[Said]:
        """What its services put on the bus at an instant, in order."""
        travelled_m = (t_ns - self._start_ns) * 1e-9 * SPEED_MPS
        along_m = (self._start_m + travelled_m) % self._route.length_m
        lat_deg, lon_deg, heading_deg = self._route.line.point_at(along_m)
        heading_deg = wrap_360(heading_deg)
        pose = _pose(t_ns, lat_deg, lon_deg, heading_deg, travelled_m)
        if pose_only:
            yield Said(FUSION, pose)
            return
        yield Said(GPS, _fix(t_ns, lat_deg, lon_deg, heading_deg))
        yield Said(FUSION, pose)
        yield Said(FUSION, _status(t_ns))
        yield Said(GPS, _health(t_ns, self._start_ns, GPS))
        yield Said(FUSION, _health(t_ns, self._start_ns, FUSION))


def _fix(t_ns: int, lat_deg: float, lon_deg: float, course_deg: float) -> GpsFix:
    return GpsFix(
        t_ns=t_ns,
        valid=True,
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        alt_m=520.3,
        geoid_sep_m=46.1,
        speed_mps=SPEED_MPS,
        course_deg=course_deg,
        mode=3,
        fix="gps",
        satellites=11,
        hdop=0.8,
        pdop=1.5,
        vdop=1.2,
    )


def _pose(
    t_ns: int, lat_deg: float, lon_deg: float, heading_deg: float, travelled_m: float
) -> Pose:
    return Pose(
        t_ns=t_ns,
        mode="gps",
        lat_deg=lat_deg,
        lon_deg=lon_deg,
        alt_m=520.0 + 1e-9 * (t_ns % 1_000_000_007),
        heading_deg=heading_deg,
        speed_mps=SPEED_MPS,
        yaw_rate_degps=0.4318279364,
        grade_pct=GRADE_PCT,
        distance_m=travelled_m,
        east_std_m=2.1738291823,
        north_std_m=2.2817263817,
        east_north_cov_m2=0.1928374655,
        heading_std_deg=1.3746152738,
        speed_std_mps=0.1746352819,
        alt_std_m=4.2817364519,
        grade_std_pct=0.6817263548,
    )


def _status(t_ns: int) -> FusionStatus:
    sensors = ("gps-ingest.position", "gps-ingest.speed", "gps-ingest.course")
    verdicts = tuple(
        Verdict(sensor=sensor, t_ns=t_ns, accepted=True, nis=1.1827364519, threshold=13.8155105579)
        for sensor in sensors
    )
    return FusionStatus(
        t_ns=t_ns, gps_latency_s=0.2, gps_latency_std_s=0.05, calibration="none", verdicts=verdicts
    )


def _health(t_ns: int, started_ns: int, service: str) -> Health:
    return Health(
        t_ns=t_ns,
        service=service,
        version=__version__,
        started_ns=started_ns,
        in_rate_hz=2.0,
        out_rate_hz=2.0,
        lag_ms_p50=121.8273645,
        lag_ms_p99=198.2736455,
    )
