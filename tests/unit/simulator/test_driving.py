"""Drives a vehicle along a course: where it stands, how fast it goes, how it feels."""

import msgspec
import numpy as np
import pytest

from unit.simulator.courses import HALTS, STEADY, driven, hills, hilly, laid, level, ramp
from wayline.errors import InputError
from wayline_simulator.course import Halt
from wayline_simulator.driver import DriverModel, drawn
from wayline_simulator.journey import MOTION_STEP_S, Floats, Motion
from wayline_simulator.vehicle import VEHICLES
from wayline_simulator.weather import Weather


def accelerations_mps2(motion: Motion) -> Floats:
    return np.diff(motion.speeds_mps) / MOTION_STEP_S


def standing_s(motion: Motion, place_m: float) -> float:
    there = (motion.speeds_mps == 0.0) & (np.abs(motion.path_m - place_m) < 1e-6)
    return MOTION_STEP_S * np.count_nonzero(there)


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_a_drive_begins_and_ends_at_rest_at_the_courses_ends(vehicle: str) -> None:
    """From 0 to the course's length, never past it and never back."""
    journey = hilly(vehicle)
    motion = journey.motion
    assert motion.path_m[0] == 0.0
    assert motion.path_m[-1] == journey.course.length_m
    assert np.all(np.diff(motion.path_m) >= 0.0)
    assert motion.speeds_mps[0] == motion.speeds_mps[-1] == 0.0


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_path_is_the_integral_of_speed(vehicle: str) -> None:
    """Speeds along the surface, their horizontal share summed, give the path to a centimetre."""
    journey = hilly(vehicle)
    motion = journey.motion
    truth = journey.at(motion.times_s)
    ground_mps = np.abs(truth.speeds_mps)
    gone_m = np.sum((ground_mps[1:] + ground_mps[:-1]) / 2.0) * MOTION_STEP_S
    assert gone_m == pytest.approx(journey.course.length_m, abs=0.01)


def test_it_stands_at_every_stop_for_the_dwell() -> None:
    """Exactly at the stop, from a standstill three metres before as well."""
    motion = driven(laid(level(4000.0), halts=HALTS))
    for halt in HALTS:
        assert standing_s(motion, halt.distance_m) == pytest.approx(halt.dwell_s, abs=0.1)


def test_the_engine_idles_before_and_after_a_drive() -> None:
    """In neutral, with the waits that the driver's table gives."""
    driver = msgspec.structs.replace(STEADY, wait_start_s=7.0, wait_end_s=4.0)
    motion = driven(laid(level(500.0)), driver=driver)
    assert standing_s(motion, 0.0) == pytest.approx(7.0, abs=0.1)
    assert standing_s(motion, 500.0) == pytest.approx(4.0, abs=0.1)
    assert motion.gear[0] == 0
    assert motion.engine_speed_rpm[0] == VEHICLES["car"].engine.idle_rpm
    assert np.isnan(motion.gear_ratio[0])


def test_red_lights_are_waited_at_and_green_ones_passed() -> None:
    """Of 40 lights at a chance of one half, 10 to 30 are red (3 sigma), never longer than given."""
    halts = [Halt(150.0 * number, "light", 10.0) for number in range(1, 41)]
    driver = msgspec.structs.replace(STEADY, red_probability=0.5)
    motion = driven(laid(level(6200.0), halts=halts), driver=driver)
    waits_s = [standing_s(motion, halt.distance_m) for halt in halts]
    assert 10 <= np.count_nonzero(waits_s) <= 30
    assert max(waits_s) <= 10.1


def test_it_reverses_between_turns() -> None:
    """Reverse gear exactly where the course goes backwards, slowly, and standing at both turns,
    though the course names one 40 cm off and the other not at all.
    """
    backwards = level(120.0)
    backwards[160:180] = 1.0
    halts = (Halt(79.6, "turn", 2.0), Halt(110.0, "park", 12.0))
    motion = driven(laid(level(120.0), halts=halts, backwards=backwards))
    moving = motion.speeds_mps > 0.0
    behind = (motion.path_m > 80.0 - 1e-9) & (motion.path_m < 90.0 - 1e-9)
    assert np.array_equal(motion.gear[moving] == -1, behind[moving])
    assert motion.speeds_mps[behind].max() <= STEADY.reverse_mps + 0.05
    assert standing_s(motion, 80.0) == pytest.approx(1.5, abs=0.1)
    assert standing_s(motion, 90.0) == pytest.approx(1.5, abs=0.1)


def test_a_parked_vehicle_idles_without_a_foot_on_the_brake() -> None:
    """For the time that is given, in neutral; at a stop the foot stays on the brake."""
    halts = (Halt(50.0, "park", 12.0), Halt(100.0, "stop", 12.0))
    motion = driven(laid(level(150.0), halts=halts))
    assert standing_s(motion, 50.0) == pytest.approx(12.0, abs=0.1)
    assert not motion.brake[(motion.path_m == 50.0) & (motion.speeds_mps == 0.0)].any()
    assert motion.brake[(motion.path_m == 100.0) & (motion.speeds_mps == 0.0)][1:-1].all()
    assert not motion.gear[(motion.path_m == 50.0) & (motion.speeds_mps == 0.0)][1:-1].any()


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_lower_limits_and_bends_are_met_in_time(vehicle: str) -> None:
    """Within 2 km/h of the limit from its first metre on, and sideways as the driver likes."""
    limits_mps = np.where(np.arange(6001) < 3000, 25.0, 10.0)
    bend = np.zeros(6001)
    bend[4500:4700] = 1.0 / 30.0
    motion = driven(laid(level(3000.0), limit_mps=limits_mps, curvature_per_m=bend), vehicle)
    sample = (motion.path_m / 0.5).astype(int)
    assert np.all(motion.speeds_mps <= limits_mps[sample] + 0.56)
    lateral_mps2 = motion.speeds_mps**2 * bend[sample]
    liked_mps2 = STEADY.lateral_mps2 * VEHICLES[vehicle].comfort_share
    assert 0.8 * liked_mps2 < lateral_mps2.max() < 1.1 * liked_mps2


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_nobody_is_thrown_about(vehicle: str) -> None:
    """Comfortable accelerations; jerk above 15 m/s3 only where a stop ends."""
    motion = hilly(vehicle).motion
    acceleration_mps2 = accelerations_mps2(motion)
    driver, share = DriverModel(), VEHICLES[vehicle].comfort_share
    assert acceleration_mps2.max() < 1.05 * driver.acceleration_mps2 * share
    assert acceleration_mps2.min() > -1.4 * driver.braking_mps2 * share
    jerk_mps3 = np.diff(acceleration_mps2) / MOTION_STEP_S
    halting = (motion.speeds_mps[1:-1] == 0.0) | (motion.speeds_mps[2:] == 0.0)
    assert np.abs(jerk_mps3[~halting]).max() < 15.0


@pytest.mark.parametrize("grade", [-0.05, -0.03, 0.03, 0.05, 0.06, 0.07])
@pytest.mark.parametrize("vehicle", VEHICLES)
def test_gears_and_brakes_do_not_chatter(vehicle: str, grade: float) -> None:
    """On an even slope at most one more shift, and the foot comes to the brake once at most."""
    motion = driven(laid(ramp(4000.0, grade, 500.0)), vehicle)
    even = (motion.path_m > 2000.0) & (motion.path_m < 3500.0)
    assert np.count_nonzero(np.diff(motion.gear[even])) <= 1
    assert np.count_nonzero(np.diff(motion.brake[even])) <= 1


def test_a_laden_truck_loses_speed_on_a_steep_hill() -> None:
    """40 t with 309 kW climb 6 % at about 309 kW x 0.93 / (40 t g (0.06 + 0.006)) = 11 m/s."""
    motion = driven(laid(ramp(6000.0, 0.06, 2000.0), limit_mps=25.0), "truck")
    assert motion.speeds_mps[motion.path_m < 2000.0].max() > 22.0
    steady = (motion.path_m > 4500.0) & (motion.path_m < 5500.0)
    assert 8.0 < motion.speeds_mps[steady].mean() < 11.0
    assert np.ptp(motion.gear[steady]) == 0


def test_a_truck_needs_its_brakes_downhill() -> None:
    """The overrun alone does not hold 40 t on 6 %; the brakes do, near the limit."""
    motion = driven(laid(ramp(4000.0, -0.06, 500.0), limit_mps=14.0), "truck")
    steady = (motion.path_m > 2000.0) & (motion.path_m < 3500.0)
    assert motion.brake[steady].all()
    assert motion.engine_torque_nm[steady].max() < 0.0
    assert motion.speeds_mps[steady].max() < 14.5


def test_a_hill_that_is_too_steep_is_an_error() -> None:
    """A truck in front of 30 % is refused with the place, not driven for ever."""
    with pytest.raises(InputError, match=r"course at \d+ m: too steep"):
        driven(laid(ramp(1000.0, 0.30, 200.0)), "truck")


def test_traffic_costs_time() -> None:
    """The same road with the same driver takes longer in a crowd, and has stops that it had not.

    In the mean of five days: queues come by chance.
    """
    course = laid(level(8000.0))
    empty = driven(course)
    crowd = msgspec.structs.replace(STEADY, traffic_density=1.0)
    crowded = [driven(course, driver=crowd, seed=seed) for seed in range(5)]
    assert np.mean([each.times_s[-1] for each in crowded]) > 1.2 * empty.times_s[-1]
    assert sum(np.count_nonzero(np.diff(each.speeds_mps > 0.0)) > 2 for each in crowded) >= 3


def test_the_same_seed_gives_the_same_motion() -> None:
    """Bit by bit; another seed gives another."""
    course = laid(hills(2000.0))
    first, again, other = (
        driven(course, driver=DriverModel(), weather=Weather(), seed=seed) for seed in (1, 1, 2)
    )
    assert first.wheel_radps.tobytes() == again.wheel_radps.tobytes()
    assert first.path_m.tobytes() == again.path_m.tobytes()
    assert first.path_m.tobytes() != other.path_m.tobytes()


def test_drivers_differ_from_run_to_run() -> None:
    """Pace with the given spread: of 400 drawn, the std is within 15 % (4 sigma)."""
    random = np.random.default_rng(1)
    paces = [drawn(DriverModel(pace_std=0.04), random).pace for _ in range(400)]
    assert np.std(paces) == pytest.approx(0.04, rel=0.15)
