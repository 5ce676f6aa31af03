"""Torque in the map: the slope of a run by torque alone and beside the altimeters."""

import math
from collections.abc import Iterator

import msgspec
import numpy as np
import pytest

from unit.slope_map.hilly_road import LAT_DEG, LON_DEG, Floats, core, drive, runs_of, true_grade_pct
from wayline.drive import Vehicle
from wayline.geo import metres_per_degree
from wayline.messages import Odometer, Pose, Torque
from wayline.tuning import Tuning, VerticalSensor
from wayline_slope_map.core import SlopeMapCore
from wayline_slope_map.known_roads import KnownRoads
from wayline_slope_map.records import FinishedRun

CAR = Vehicle()
TURNS_PER_M = 8.0


def with_engine(messages: list[msgspec.Struct], *, mass: float = 1.0) -> Iterator[msgspec.Struct]:
    """At 15 m/s, with the torque that the true slope takes of a vehicle of so much of the mass."""
    for message in messages:
        if isinstance(message, Pose):
            slope = float(true_grade_pct(np.array(message.distance_m))) / 100.0
            force_n = mass * CAR.mass_kg * 9.81 * (slope + CAR.rolling_coefficient)
            force_n += 0.5 * 1.2 * CAR.drag_coefficient * CAR.frontal_area_m2 * 15.0**2
            through = 1.0 / CAR.driveline_efficiency if force_n > 0 else CAR.driveline_efficiency
            yield Torque(
                t_ns=message.t_ns,
                engine_torque_nm=through * force_n / TURNS_PER_M,
                engine_speed_rpm=15.0 * TURNS_PER_M * 30.0 / math.pi,
                brake=False,
                slope_pct=round(100.0 * slope, 1),
            )
            yield Odometer(t_ns=message.t_ns, speed_mps=15.0)
        yield message


def run_of(*, mass: float = 1.0, tuning: Tuning | None = None) -> FinishedRun:
    core = SlopeMapCore(KnownRoads(), tuning or Tuning(), "car", CAR)
    (run,) = runs_of(core, list(with_engine(drive(seed=3), mass=mass)))
    return run


def errors_pct(run: FinishedRun, sensor: str) -> Floats:
    """Against the grade at each bin's own place, which the road's way east tells."""
    bins = [each for each in run.bins if each.sensor == sensor]
    places = [run.road.line.point_at(run.road.centre_m(each.bin_index)) for each in bins]
    east_m = (np.array([place[1] for place in places]) - LON_DEG) * metres_per_degree(LAT_DEG)[1]
    truth_pct = true_grade_pct(east_m)
    return np.array([each.grade_pct for each in bins]) - truth_pct


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def test_torque_makes_the_map_better_than_the_altimeters_alone() -> None:
    (without,) = runs_of(core(), drive(seed=3))
    assert rms(errors_pct(run_of(), "fused")) < 0.5 * rms(errors_pct(without, "fused"))


def test_a_mass_that_is_15_percent_off_is_seen_through() -> None:
    assert rms(errors_pct(run_of(mass=1.15), "fused")) < 0.4


@pytest.mark.parametrize(
    ("sensors", "kept"),
    [
        (("torque",), {"torque", "fused"}),
        (("vehicle",), {"vehicle", "fused"}),
        (("gps", "torque"), {"gps", "torque", "fused"}),
    ],
)
def test_each_sensor_is_used_alone_or_with_others(
    sensors: tuple[VerticalSensor, ...], kept: set[str]
) -> None:
    run = run_of(tuning=Tuning(vertical_sensors=sensors))
    assert {each.sensor for each in run.bins} == kept
    assert rms(errors_pct(run, "fused")) < 0.9


def test_altitudes_that_a_receiver_filters_come_to_lie_where_they_belong() -> None:
    """As papers/004 saw them: 10 s late, which is 150 m of hills that come every 170 to 900 m."""
    core = SlopeMapCore(KnownRoads(), Tuning(), "car", CAR)
    (run,) = runs_of(core, list(with_engine(drive(seed=3, gps_lag_s=10.0))))
    assert rms(errors_pct(run, "gps")) < 1.3 * rms(errors_pct(run_of(), "gps"))
    assert rms(errors_pct(run, "fused")) < 1.3 * rms(errors_pct(run_of(), "fused"))
