"""Pure: drives a vehicle along a course from rest to rest."""

from collections.abc import Sequence

import msgspec
import numpy as np

from wayline_simulator.ceiling import ceiling_mps
from wayline_simulator.course import Course, Floats
from wayline_simulator.drive_train import RPM_PER_RADPS
from wayline_simulator.driver import DriverModel
from wayline_simulator.foot import Foot, pedals
from wayline_simulator.journey import MOTION_STEP_S, Motion
from wayline_simulator.loads import LoadChange, masses_kg, with_loads
from wayline_simulator.road_load import GRAVITY_MPS2, road_load
from wayline_simulator.rollout import Records, Rollout
from wayline_simulator.traffic import flow_share, planned_stops, queues
from wayline_simulator.tyres import locked, rolling_radius_m, slip, spinning_mps
from wayline_simulator.vehicle import VehicleModel
from wayline_simulator.weather import Weather


def drive(
    course: Course,
    vehicle: VehicleModel,
    driver: DriverModel,
    weather: Weather,
    random: np.random.Generator,
    *,
    loads: Sequence[LoadChange] = (),
) -> Motion:
    """How the vehicle drives the whole course. Raises InputError where it cannot climb it."""
    share = flow_share(course, driver, random)
    jams = queues(course, driver, random)
    stops = planned_stops(course, driver, jams, random)
    masses = masses_kg(course.distances_m, vehicle.mass_kg, loads)
    load = road_load(course, vehicle, weather, random, masses)
    ceiling = ceiling_mps(course, vehicle, driver, share, jams)
    foot = Foot(pedals(vehicle, driver), ceiling.tolist())
    rollout = Rollout(course, vehicle, load, foot)
    rollout.stand(driver.wait_start_s, parked=True)
    changed = {each.distance_m: each.mass_kg for each in loads}
    for stop in with_loads(stops, loads):
        rollout.go_to(stop)
        rollout.stand(stop.wait_s, parked=stop.parked)
        if stop.distance_m in changed:
            rollout.load(msgspec.structs.replace(vehicle, mass_kg=changed[stop.distance_m]))
    records = rollout.records()
    masses = masses_kg(records.path_m, vehicle.mass_kg, loads)
    return _motion(records, masses, vehicle, driver, weather, random)


def _motion(  # noqa: PLR0917 -- who drives what, where and when
    records: Records,
    masses: Floats,
    vehicle: VehicleModel,
    driver: DriverModel,
    weather: Weather,
    random: np.random.Generator,
) -> Motion:
    times_s = MOTION_STEP_S * np.arange(len(records.path_m), dtype=np.float64)
    gear = records.gear.astype(np.int8)
    brake, clutch = records.brake > 0.0, records.clutch > 0.0
    rolling_radps = _rolling_radps(records, masses, times_s, vehicle, weather, random)
    spinning_radps = (
        spinning_mps(records.speeds_mps, driver.spin_probability, random) / vehicle.wheel_radius_m
    )
    stuck = locked(records.speeds_mps, brake, driver.lock_probability, random)
    ratios = np.array([np.nan, *vehicle.gearbox.ratios, vehicle.gearbox.reverse_ratio])[gear]
    # the engine follows the rolling wheels: in a slip event the driver opens the clutch or a
    # differential shares it out
    turning_rpm = rolling_radps * ratios * vehicle.gearbox.final_drive_ratio * RPM_PER_RADPS
    return Motion(
        times_s=times_s,
        path_m=records.path_m,
        speeds_mps=records.speeds_mps,
        wheel_radps=np.where(stuck, 0.0, rolling_radps + spinning_radps),
        engine_torque_nm=records.engine_torque_nm,
        engine_speed_rpm=np.where(clutch, records.engine_speed_rpm, turning_rpm),
        gear=gear,
        gear_ratio=ratios,
        brake=brake,
        clutch=clutch,
        drive_force_n=records.drive_force_n,
        brake_force_n=records.brake_force_n,
        resistance_n=records.resistance_n,
    )


def _rolling_radps(  # noqa: PLR0917 -- as `_motion`
    records: Records,
    masses: Floats,
    times_s: Floats,
    vehicle: VehicleModel,
    weather: Weather,
    random: np.random.Generator,
) -> Floats:
    """Turning rate of the driven wheels with the slip of what they push and brake."""
    tyres = vehicle.tyres
    radius_m = rolling_radius_m(
        tyres,
        nominal_m=vehicle.wheel_radius_m,
        mass_kg=masses,
        inflation=1.0 + tyres.pressure_std * random.standard_normal(),
        temperature_c=weather.temperature_c,
        times_s=times_s,
        speeds_mps=records.speeds_mps,
    )
    force_n = records.drive_force_n - vehicle.driven_share * records.brake_force_n
    load_n = vehicle.driven_share * masses * GRAVITY_MPS2
    return records.speeds_mps / radius_m * (1.0 + slip(tyres, force_n, load_n))
