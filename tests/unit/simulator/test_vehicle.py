"""A vehicle's physics: energy, torque against slope, wheels."""

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from unit.simulator.courses import CALM, HALTS, STEADY, driven, hills, hilly, laid, level, ramp
from wayline_simulator.driver import DriverModel
from wayline_simulator.energy import energy_balance
from wayline_simulator.journey import MOTION_STEP_S, Floats, Journey
from wayline_simulator.road_load import GRAVITY_MPS2
from wayline_simulator.tyres import rolling_radius_m
from wayline_simulator.vehicle import VEHICLES, VehicleModel, vehicle_table


def read_grades(journey: Journey, vehicle: VehicleModel, mass_kg: Floats | float) -> Floats:
    """What a reader of torque, speed and acceleration takes for the slope, resistances known."""
    motion, table = journey.motion, vehicle_table(vehicle, vehicle.mass_kg)
    loss = np.where(motion.engine_torque_nm > 0.0, 1.0, -1.0)
    force_n = (
        motion.engine_torque_nm
        * motion.gear_ratio
        * table.final_drive_ratio
        / table.wheel_radius_m
        * table.driveline_efficiency**loss
    )[:-1]
    acceleration_mps2 = np.diff(motion.speeds_mps) / MOTION_STEP_S
    left_n = force_n - motion.resistance_n[:-1] - mass_kg * acceleration_mps2
    return np.tan(np.arcsin(left_n / (vehicle.mass_kg * GRAVITY_MPS2)))


def rotating_kg(journey: Journey, vehicle: VehicleModel) -> Floats:
    """Mass with what rotates, while the clutch is closed."""
    turns = journey.motion.gear_ratio[:-1] * vehicle.gearbox.final_drive_ratio
    engine_kgm2 = vehicle.engine.inertia_kgm2 * turns**2
    return vehicle.mass_kg + (vehicle.wheel_inertia_kgm2 + engine_kgm2) / vehicle.wheel_radius_m**2


def pulling(journey: Journey) -> NDArray[np.bool_]:
    """Steps with the clutch closed, no brake, on the move."""
    motion = journey.motion
    return ~motion.clutch[:-1] & ~motion.brake[:-1] & (motion.speeds_mps[:-1] > 0.0)


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_energy_is_conserved(vehicle: str) -> None:
    """Drive work is what brakes, resistance, rotation and height took, to 0.1 % of it."""
    balance = energy_balance(hilly(vehicle), VEHICLES[vehicle])
    assert abs(balance.residual_share) < 1e-3
    assert balance.kinetic_j == pytest.approx(0.0, abs=1.0)


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_height_counts_in_the_energy(vehicle: str) -> None:
    """On a road that ends 50 m higher the height takes m g 50 m, from the course's altitudes."""
    course = laid(ramp(1500.0, 0.05, 450.0))
    journey = Journey(course, driven(course, vehicle))
    balance = energy_balance(journey, VEHICLES[vehicle])
    risen_m = course.alts_m[-1] - course.alts_m[0]
    assert risen_m == pytest.approx(50.0)
    assert balance.potential_j == pytest.approx(VEHICLES[vehicle].mass_kg * 9.81 * risen_m)
    assert abs(balance.residual_share) < 1e-3


def test_energy_is_conserved_in_reverse() -> None:
    """Backwards up a ramp, which is a grade that falls in the direction of the nose."""
    backwards = np.zeros(401)
    backwards[100:300] = 1.0
    course = laid(ramp(200.0, -0.08, 0.0), backwards=backwards)
    balance = energy_balance(Journey(course, driven(course)), VEHICLES["car"])
    assert abs(balance.residual_share) < 1e-3


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_the_driveline_always_costs(vehicle: str) -> None:
    """Of the crankshaft's work 5 to 20 % never reach the road: efficiency, clutch, overrun."""
    balance = energy_balance(hilly(vehicle), VEHICLES[vehicle])
    assert 0.05 < 1.0 - balance.drive_j / balance.crankshaft_j < 0.20


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_torque_gives_back_the_slope(vehicle: str) -> None:
    """With closed clutch and no brake the reader's formula is within 0.01 % of the grade."""
    journey = hilly(vehicle)
    middle_s = journey.motion.times_s[:-1] + 0.5 * MOTION_STEP_S
    grades = journey.at(middle_s).grades_pct / 100.0
    read = read_grades(journey, VEHICLES[vehicle], rotating_kg(journey, VEHICLES[vehicle]))
    error = (read - grades)[pulling(journey)]
    assert np.sqrt(np.mean(error**2)) < 1e-4


def test_a_reader_that_forgets_what_rotates_errs_a_little() -> None:
    """Rotating parts put the truck's slope off by some 0.1 %, the more the lower the gear."""
    journey, truck = hilly("truck"), VEHICLES["truck"]
    grades = journey.at(journey.motion.times_s[:-1] + 0.5 * MOTION_STEP_S).grades_pct / 100.0
    error = read_grades(journey, truck, truck.mass_kg) - grades
    low = journey.motion.gear[:-1] <= 6
    sure = pulling(journey)
    assert 1e-3 < np.sqrt(np.nanmean(error[sure & low] ** 2)) < 2e-2
    assert np.sqrt(np.mean(error[sure & ~low] ** 2)) < 2e-3


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_the_engine_stays_within_its_limits(vehicle: str) -> None:
    """Idle to red line; torque between its overrun and full load."""
    motion, engine = hilly(vehicle).motion, VEHICLES[vehicle].engine
    assert motion.engine_speed_rpm.min() >= 0.85 * engine.idle_rpm
    assert motion.engine_speed_rpm.max() <= engine.speeds_rpm[-1]
    assert motion.engine_torque_nm.max() <= max(engine.torques_nm)
    most_nm = engine.drag_nm + engine.exhaust_brake_nm
    drag_nm = most_nm + engine.drag_nm_per_rpm * motion.engine_speed_rpm
    assert np.all(motion.engine_torque_nm >= -1.02 * drag_nm)
    assert motion.engine_torque_nm.min() < -0.5 * drag_nm.min()


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_wheels_turn_with_the_engine_while_the_clutch_is_closed(vehicle: str) -> None:
    """Engine speed over wheel rate is the gear's ratio, slip or not."""
    motion = driven(laid(hills(2000.0)), vehicle)
    closed = ~motion.clutch & (motion.speeds_mps > 0.0)
    turns = motion.engine_speed_rpm[closed] * np.pi / 30.0 / motion.wheel_radps[closed]
    ratio = motion.gear_ratio[closed] * VEHICLES[vehicle].gearbox.final_drive_ratio
    assert np.abs(turns / ratio - 1.0).max() < 1e-9


def test_pushed_wheels_slip_by_a_few_per_mille() -> None:
    """Full load at low speed makes a truck's wheels turn more than they roll, by under 3 %."""
    motion = driven(laid(level(1500.0)), "truck", STEADY, CALM)
    rolled_m = motion.wheel_radps * VEHICLES["truck"].wheel_radius_m
    pushing = (motion.drive_force_n > 20_000.0) & (motion.speeds_mps > 1.0)
    coasting = (np.abs(motion.drive_force_n) < 3_000.0) & (motion.speeds_mps > 1.0) & ~motion.brake
    share = rolled_m / np.where(motion.speeds_mps > 0.0, motion.speeds_mps, 1.0)
    assert 0.003 < share[pushing].mean() - share[coasting].mean() < 0.03


def test_rolling_radius_grows_with_speed_and_pressure_and_shrinks_with_load() -> None:
    """Each by the share in the tyre's table, at the tyre's reference temperature."""
    tyres = msgspec.structs.replace(
        VEHICLES["car"].tyres, warming_kelvin=0.0, speed_share=0.0005, load_share=0.01
    )

    def radius_m(speed_mps: float, mass_kg: float, inflation: float) -> float:
        radii_m = rolling_radius_m(
            tyres,
            nominal_m=0.3,
            mass_kg=mass_kg,
            inflation=inflation,
            temperature_c=20.0,
            times_s=np.zeros(1),
            speeds_mps=np.array([speed_mps]),
        )
        return float(radii_m[0])

    assert radius_m(0.0, 1500.0, 1.0) == pytest.approx(0.3)
    assert radius_m(100.0 / 3.0, 1500.0, 1.0) == pytest.approx(0.3 * 1.002)
    assert radius_m(0.0, 1650.0, 1.0) == pytest.approx(0.3 * 0.999)
    assert radius_m(0.0, 1500.0, 0.75) == pytest.approx(0.3 * 0.997)


def test_tyres_grow_as_they_warm() -> None:
    """On a level road at a steady speed the wheel turns less after 20 minutes, by about 0.1 %."""
    motion = driven(laid(level(20_000.0), limit_mps=15.0))
    rates = [motion.wheel_radps[np.searchsorted(motion.times_s, at_s)] for at_s in (80.0, 1280.0)]
    assert 0.0005 < rates[0] / rates[1] - 1.0 < 0.0015


def test_wheels_spin_and_lock_as_often_as_they_are_told_to() -> None:
    """With certainty: in every launch wheels are faster, and in each braking they once stand."""
    snow = msgspec.structs.replace(STEADY, spin_probability=1.0, lock_probability=1.0)
    course = laid(level(4000.0), halts=HALTS)
    dry, wet = driven(course, driver=STEADY), driven(course, driver=snow)
    radius_m = VEHICLES["car"].wheel_radius_m
    assert ((wet.wheel_radps - dry.wheel_radps) * radius_m).max() > 0.45
    stuck = (wet.wheel_radps == 0.0) & (wet.speeds_mps > 1.0)
    assert np.all(wet.brake[stuck])
    assert 3 * 0.3 <= MOTION_STEP_S * np.count_nonzero(stuck) <= 4 * 1.0
    assert not np.any((dry.wheel_radps == 0.0) & (dry.speeds_mps > 1.0))


def test_wind_holds_back() -> None:
    """A headwind of 10 m/s at 22 m/s about doubles the air's force: (32 / 22)^2 = 2.1."""
    driver = DriverModel(wander_std=0.0, traffic_density=0.0)
    still = driven(laid(level(3000.0)), driver=driver)
    weather = msgspec.structs.replace(CALM, wind_mps=10.0, wind_from_deg=30.0)
    windy = driven(laid(level(3000.0)), driver=driver, weather=weather)
    rolling_n = 0.010 * 1500.0 * GRAVITY_MPS2
    air_n = [
        motion.resistance_n[motion.speeds_mps > 20.0].mean() - rolling_n
        for motion in (still, windy)
    ]
    assert air_n[1] / air_n[0] == pytest.approx(2.15, rel=0.15)


def test_the_vehicle_table_is_what_a_drive_file_takes() -> None:
    """With the mass that it is given, and full-load torque as 100 %."""
    table = vehicle_table(VEHICLES["truck"], 38_000.0)
    assert table.mass_kg == 38_000.0
    assert table.engine_reference_torque_nm == 2100.0
    assert len(table.gear_ratios) == 12
