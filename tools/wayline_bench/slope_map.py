"""A made-up slope map of any length, and a drive of 50 km for `bench slope`."""

import math
from collections.abc import Iterator

import numpy as np

from wayline.drive import Vehicle
from wayline.geo import LocalPlane
from wayline.inputs import Flush
from wayline.messages import Barometer, GpsFix, Message, Odometer, Pose, Torque
from wayline.tuning import Tuning
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.profile import RoadProfile
from wayline_slope_map.records import DrivenRun
from wayline_slope_map.roads import Road
from wayline_slope_map.sums import BinEstimate

START_NS = 1_750_000_000_000_000_000
ORIGIN = LocalPlane(48.1, 11.5)
BIN_M = 20.0
ROAD_M = 50_000.0
APART_M = 200.0
"""Between roads, which run north beside each other."""
BEND_M, BEND_LENGTH_M = 40.0, 900.0
VERTEX_M = 50.0
SPEED_MPS = 20.0
TURNS_PER_M = 3.0
TRUCK = Vehicle(mass_kg=20_000.0, drag_coefficient=0.6, frontal_area_m2=9.0)
HILL, HILL_LENGTH_M = 0.04, 400.0
GRAVITY_MPS2 = 9.81
STEP_NS = 100_000_000


def made_up_map(length_m: float) -> list[RoadProfile]:
    """Roads of ROAD_M each, known in one direction, that come to a length together."""
    bins = {
        1: {
            index: BinEstimate(2.0 * math.sin(index), 0.2, 0.1, 500.0 + index % 7, 4, START_NS)
            for index in range(int(ROAD_M / BIN_M))
        }
    }
    return [RoadProfile(_road(number), bins) for number in range(round(length_m / ROAD_M))]


def _road(number: int) -> Road:
    north_m = np.arange(0.0, ROAD_M + VERTEX_M, VERTEX_M)
    east_m = number * APART_M + BEND_M * np.sin(north_m / BEND_LENGTH_M)
    points = tuple(
        ORIGIN.to_geodetic(east, north)
        for east, north in zip(east_m.tolist(), north_m.tolist(), strict=True)
    )
    return Road(f"road-{number}", BIN_M, loop=False, is_route=False, points=points)


def place_on(number: int, north_m: float) -> tuple[float, float, float]:
    """Latitude, longitude and heading of a place on the road of this number."""
    east_m = number * APART_M + BEND_M * math.sin(north_m / BEND_LENGTH_M)
    heading_rad = math.atan(BEND_M / BEND_LENGTH_M * math.cos(north_m / BEND_LENGTH_M))
    return *ORIGIN.to_geodetic(east_m, north_m), math.degrees(heading_rad) % 360.0


def poses(number: int, length_m: float, start_ns: int = START_NS) -> Iterator[Pose]:
    """A vehicle that drives a road of the map at ten poses a second."""
    for count in range(int(length_m / SPEED_MPS * 10.0)):
        travelled_m = SPEED_MPS * count / 10.0
        lat_deg, lon_deg, heading_deg = place_on(number, travelled_m)
        yield Pose(
            t_ns=start_ns + count * STEP_NS,
            mode="fused",
            lat_deg=lat_deg,
            lon_deg=lon_deg,
            heading_deg=heading_deg,
            speed_mps=SPEED_MPS,
            distance_m=travelled_m,
            east_std_m=2.0,
            north_std_m=2.0,
        )


def driven_run(length_m: float) -> DrivenRun:
    """What a truck with GPS, barometer and torque has collected of a road over hills."""
    core = SlopeMapCore(KnownRoads(), Tuning(), "bench", TRUCK)
    given = [each for pose in poses(0, length_m) for each in (*_sensed(pose), pose)]
    for message in given:
        core.handle(message, "bench")
    (run,) = core.handle(Flush(given[-1].t_ns), "bench")
    if not isinstance(run, DrivenRun):
        raise AssertionError("a drive has come to no run")
    return run


def _sensed(pose: Pose) -> Iterator[Message]:
    """Torque and wheels with each pose, altitude and pressure every second."""
    slope = HILL * math.sin(pose.distance_m / HILL_LENGTH_M)
    alt_m = 500.0 - HILL * HILL_LENGTH_M * math.cos(pose.distance_m / HILL_LENGTH_M)
    yield _torque(pose.t_ns, slope)
    yield Odometer(t_ns=pose.t_ns, speed_mps=SPEED_MPS)
    if pose.t_ns % 1_000_000_000 == 0:
        yield Barometer(
            t_ns=pose.t_ns, pressure_pa=101_325.0 * (1.0 - alt_m / 44_330.77) ** (1 / 0.190_263)
        )
        yield GpsFix(
            t_ns=pose.t_ns,
            valid=True,
            lat_deg=pose.lat_deg,
            lon_deg=pose.lon_deg,
            alt_m=round(alt_m, 1),
            v_std_m=3.0,
            mode=3,
        )


def _torque(t_ns: int, slope: float) -> Torque:
    """What the truck's engine pulls at an even speed."""
    air_n = 0.5 * 1.2 * TRUCK.drag_coefficient * TRUCK.frontal_area_m2 * SPEED_MPS**2
    force_n = TRUCK.mass_kg * GRAVITY_MPS2 * (slope + TRUCK.rolling_coefficient) + air_n
    efficiency = TRUCK.driveline_efficiency
    return Torque(
        t_ns=t_ns,
        engine_torque_nm=force_n
        / TURNS_PER_M
        * (1.0 / efficiency if force_n > 0.0 else efficiency),
        engine_speed_rpm=SPEED_MPS * TURNS_PER_M * 30.0 / math.pi,
        brake=False,
    )
