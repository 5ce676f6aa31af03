"""A scripted shuttle on a loop in Swarthmore: what its six services would put on the bus."""

import math
from collections.abc import Iterator

from wayline.messages import (
    Arrivals,
    FusionStatus,
    GpsFix,
    Health,
    Horizon,
    HorizonPoint,
    Message,
    Pose,
    PoseMode,
    Progress,
    SensorSlope,
    StopArrival,
)
from wayline.route import Route, make_route
from wayline.services import SERVICES
from wayline.stops import StopPlace

SPEED_MPS = 8.0
SECOND_NS = 1_000_000_000
VERTICES = (
    (39.90634, -75.35023),
    (39.90565, -75.34617),
    (39.90574, -75.34392),
    (39.90580, -75.34349),
    (39.90605, -75.34364),
    (39.90839, -75.34632),
    (39.91056, -75.34906),
    (39.91073, -75.34912),
    (39.91028, -75.34924),
    (39.90815, -75.34980),
    (39.90685, -75.35011),
    (39.90634, -75.35023),
)
STOPS = (
    StopPlace("s1", "College Avenue", 39.90600, -75.34823, 10.0),
    StopPlace("s2", "Railway Station", 39.90580, -75.34349, 10.0),
    StopPlace("s3", "Whittier Place", 39.90840, -75.34632, 10.0),
    StopPlace("s4", "North Gate", 39.91073, -75.34912, 10.0),
    StopPlace("s5", "Crum Woods", 39.90815, -75.34980, 10.0),
)


SLOPES = (
    SensorSlope(sensor="gps_altitude", source="gps-ingest", slope_pct=-1.25, slope_std_pct=0.61),
    SensorSlope(sensor="barometer", slope_pct=2.04, slope_std_pct=0.22),
)


def shuttle_route() -> Route:
    """The loop with five stops."""
    return make_route(
        "shuttle",
        route_id="avl",
        name="Campus loop",
        loop=True,
        vertices=VERTICES,
        speeds_mps=None,
        stops=STOPS,
    )


class Shuttle:
    """Drives the loop at a constant speed, without GPS in `outage` seconds of its drive."""

    def __init__(self, start_ns: int, *, outage: range = range(0), has_can: bool = True) -> None:
        self.route = shuttle_route()
        self.start_ns, self.outage, self.has_can = start_ns, outage, has_can

    def messages(self, step: int) -> Iterator[tuple[Message, str]]:
        """What is put on the bus at a tenth of a second since the start."""
        t_ns, distance_m = self.start_ns + step * SECOND_NS // 10, SPEED_MPS * step / 10.0
        yield self._pose(t_ns, distance_m, step), "fusion"
        if step % 10 == 0:
            yield self._fix(t_ns, distance_m, step), "gps-ingest"
            yield self._status(t_ns, step), "fusion"
            yield self._progress(t_ns, distance_m), "eta"
            yield self._arrivals(t_ns, distance_m), "eta"
            yield self._horizon(t_ns, distance_m), "slope-map"

    def health(self, t_ns: int) -> Iterator[tuple[Health, str]]:
        """Every service's health."""
        for number, service in enumerate(SERVICES):
            yield (
                Health(
                    t_ns=t_ns,
                    service=service,
                    version="0.1.0",
                    started_ns=self.start_ns,
                    out_rate_hz=(10.0, 92.0, 11.0, 2.0, 1.0, 0.0, 0.0)[number],
                    lag_ms_p50=1.0 + number,
                    lag_ms_p99=4.0 + 2 * number,
                ),
                service,
            )

    def place(self, distance_m: float) -> tuple[float, float, float]:
        """Latitude, longitude and heading on the loop."""
        line = self.route.line
        within_m = distance_m % self.route.length_m
        leg = line.leg_at(within_m)
        share = (within_m - float(line.distances_m[leg])) / float(line.legs_m[leg])
        lat_deg = line.lats_deg[leg] + share * (line.lats_deg[leg + 1] - line.lats_deg[leg])
        lon_deg = line.lons_deg[leg] + share * (line.lons_deg[leg + 1] - line.lons_deg[leg])
        return float(lat_deg), float(lon_deg), float(line.headings_deg[leg])

    def _is_blind(self, step: int) -> bool:
        return step // 10 in self.outage

    def _mode(self, step: int) -> PoseMode:
        if self._is_blind(step):
            return "dead_reckoning"
        return "fused" if self.has_can else "gps"

    def _pose(self, t_ns: int, distance_m: float, step: int) -> Pose:
        lat_deg, lon_deg, heading_deg = self.place(distance_m)
        blind_s = (step / 10.0 - self.outage.start) if self._is_blind(step) else 0.0
        along_m, across_m = 2.0 + 0.10 * blind_s, 1.4 + 0.25 * blind_s
        angle_rad = math.radians(heading_deg)
        east_m2 = (along_m * math.sin(angle_rad)) ** 2 + (across_m * math.cos(angle_rad)) ** 2
        north_m2 = (along_m * math.cos(angle_rad)) ** 2 + (across_m * math.sin(angle_rad)) ** 2
        return Pose(
            t_ns=t_ns,
            mode=self._mode(step),
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            alt_m=58.0,
            heading_deg=heading_deg,
            speed_mps=SPEED_MPS,
            grade_pct=grade_pct(distance_m),
            grade_std_pct=0.4,
            distance_m=distance_m,
            east_std_m=math.sqrt(east_m2),
            north_std_m=math.sqrt(north_m2),
            east_north_cov_m2=(along_m**2 - across_m**2) * math.sin(2.0 * angle_rad) / 2.0,
            heading_std_deg=1.5,
        )

    def _fix(self, t_ns: int, distance_m: float, step: int) -> GpsFix:
        lat_deg, lon_deg, _ = self.place(distance_m)
        if self._is_blind(step):
            return GpsFix(t_ns=t_ns, valid=False)
        return GpsFix(
            t_ns=t_ns,
            valid=True,
            lat_deg=lat_deg + 3e-5 * math.sin(step),
            lon_deg=lon_deg + 4e-5 * math.cos(step),
            mode=3,
            fix="dgps",
            satellites=9,
            hdop=0.9,
        )

    def _status(self, t_ns: int, step: int) -> FusionStatus:
        outage_s = step / 10.0 - self.outage.start if self._is_blind(step) else 0.0
        return FusionStatus(t_ns=t_ns, calibration="calibrated", outage_s=outage_s, slopes=SLOPES)

    def _progress(self, t_ns: int, distance_m: float) -> Progress:
        lat_deg, lon_deg, _ = self.place(distance_m)
        return Progress(
            t_ns=t_ns,
            route_id="avl",
            distance_m=distance_m % self.route.length_m,
            lap=int(distance_m // self.route.length_m),
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            cross_track_m=0.4,
            distance_std_m=2.0,
            on_route=True,
            speed_mps=SPEED_MPS,
        )

    def _arrivals(self, t_ns: int, distance_m: float) -> Arrivals:
        stops = []
        for stop in self.route.stops:
            ahead_m = (stop.distance_m - distance_m) % self.route.length_m
            in_s = ahead_m / SPEED_MPS
            arrival_ns = t_ns + round(in_s * SECOND_NS)
            stops.append(
                StopArrival(
                    stop_id=stop.stop_id,
                    name=stop.name,
                    distance_m=ahead_m,
                    arrival_ns=arrival_ns,
                    early_ns=arrival_ns - round((1 + 0.08 * in_s) * SECOND_NS),
                    late_ns=arrival_ns + round((2 + 0.15 * in_s) * SECOND_NS),
                )
            )
        return Arrivals(t_ns=t_ns, route_id="avl", stale=False, stops=tuple(stops))

    def _horizon(self, t_ns: int, distance_m: float) -> Horizon:
        points = tuple(
            HorizonPoint(
                distance_m=20.0 * index,
                grade_pct=grade_pct(distance_m + 20.0 * index) if index not in GAP else None,
                grade_std_pct=0.25 + 0.01 * index if index not in GAP else None,
                runs=4 if index not in GAP else 0,
            )
            for index in range(76)
        )
        return Horizon(t_ns=t_ns, road_id="avl", position_m=distance_m, points=points)


GAP = range(44, 50)
"""Bins that nobody has driven."""


def grade_pct(distance_m: float) -> float:
    """A hilly loop."""
    return 3.1 * math.sin(distance_m / 180.0) + 1.2 * math.sin(distance_m / 47.0)
