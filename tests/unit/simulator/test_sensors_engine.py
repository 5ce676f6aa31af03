"""Torque, the slope made of it and air pressure err as their models say."""

import math
from dataclasses import replace
from typing import Any

import msgspec
import numpy as np
import pytest

from unit.simulator.journeys import ALT_M, WHEEL_RADIUS_M, course, cruise, journey, standing
from wayline.air import metres_per_pascal, pressure_altitude_m
from wayline.drive import Vehicle
from wayline.errors import InputError
from wayline_simulator import barometer, torque
from wayline_simulator.barometer import BarometerModel, BarometerSamples
from wayline_simulator.course import Surroundings
from wayline_simulator.journey import Floats, Journey
from wayline_simulator.reported_slope import INVALID_PCT, reported_slopes_pct
from wayline_simulator.torque import TorqueModel, TorqueSamples
from wayline_simulator.weather import Weather

CAR = Vehicle(
    mass_kg=1500.0,
    wheel_radius_m=WHEEL_RADIUS_M,
    final_drive_ratio=4.1,
    driveline_efficiency=1.0,
    rolling_coefficient=1e-9,
    drag_coefficient=1e-9,
    engine_reference_torque_nm=250.0,
)
"""What `journeys.journey` drives: no losses, no resistance."""
QUIET_ENGINE = TorqueModel(
    gain_std=0.0,
    gain_wander_std=0.0,
    offset_wander_std_pct=0.0,
    offset_std_pct=0.0,
    noise_pct=0.0,
    resolution_pct=1e-4,
    mass_error_std=0.0,
    slope_speed_noise_mps=0.0,
    slope_resolution_pct=1e-4,
)
QUIET_AIR = BarometerModel(
    offset_std_pa=0.0,
    wander_std_pa=0.0,
    noise_pa=0.0,
    resolution_pa=1e-3,
    airflow_coefficient=0.0,
    fan_step_pa=0.0,
    tunnel_pa=0.0,
)
CALM = Weather(wind_mps=0.0, temperature_c=15.0 - 0.0065 * ALT_M)
"""The standard atmosphere's."""
GRADE_TORQUE_NM = 1500.0 * 9.81 * math.sin(math.atan(0.05)) * WHEEL_RADIUS_M / 4.1
"""What 5 % ask of the engine."""


def pulled(drive: Journey, seed: int = 1, **fields: Any) -> TorqueSamples:
    model = msgspec.structs.replace(QUIET_ENGINE, **fields)
    device, random = np.random.default_rng(8), np.random.default_rng(seed)
    return torque.measure(drive, model, CAR, device=device, random=random)


def sloped(drive: Journey, assumed: Vehicle = CAR, **fields: Any) -> Floats:
    model = msgspec.structs.replace(QUIET_ENGINE, **fields)
    samples = pulled(drive, **fields)
    return reported_slopes_pct(drive, model, samples, assumed, np.random.default_rng(5))


def felt(drive: Journey, weather: Weather = CALM, seed: int = 1, **fields: Any) -> BarometerSamples:
    model = msgspec.structs.replace(QUIET_AIR, **fields)
    device, random = np.random.default_rng(8), np.random.default_rng(seed)
    return barometer.measure(drive, model, weather, device=device, random=random)


def test_torque_is_in_percent_of_the_reference() -> None:
    """On 5 % the engine gives what the grade takes."""
    samples = pulled(cruise(20.0, 20.0, grade=0.05))
    expected_pct = 100.0 * GRADE_TORQUE_NM / 250.0
    assert samples.torques_pct[2:-2] == pytest.approx(expected_pct, rel=1e-5)


def test_torque_has_its_gain_offset_and_noise() -> None:
    """Mean and std over 6000 samples, steps of 0.01 % adding nothing."""
    samples = pulled(
        cruise(20.0, 600.0, grade=0.05), gain_std=0.05, offset_std_pct=2.0, noise_pct=0.5
    )
    gain, offset_pct = np.random.default_rng(8).standard_normal(2) * (0.05, 2.0)
    errors = samples.torques_pct - GRADE_TORQUE_NM / 2.5 * (1.0 + gain) - offset_pct
    assert errors[2:-2].mean() == pytest.approx(0.0, abs=4 * 0.5 / math.sqrt(6000))
    assert errors[2:-2].std() == pytest.approx(0.5, rel=4 / math.sqrt(2 * 6000))


def test_an_engine_may_keep_its_overrun_to_itself() -> None:
    """Downhill one bus says less than 0, the other 0."""
    drive = cruise(20.0, 20.0, grade=-0.05)
    assert pulled(drive).torques_pct[5:-5].max() < -10.0
    assert not np.any(pulled(drive, overrun_reported=False).torques_pct)


def test_torque_gain_wanders_with_its_std_and_time() -> None:
    """300 correlation times know the std to 6 %."""
    samples = pulled(
        cruise(20.0, 3000.0, grade=0.05), gain_wander_std=0.02, gain_wander_time_s=10.0
    )
    gains = samples.torques_pct[2:-2] / (GRADE_TORQUE_NM / 2.5) - 1.0
    assert gains.std() == pytest.approx(0.02, rel=0.24)
    assert np.corrcoef(gains[100:], gains[:-100])[0, 1] == pytest.approx(math.exp(-1), abs=0.16)


def test_neutral_has_no_ratio_on_the_bus() -> None:
    """The motion's nan becomes the 0 that the database explains."""
    drive = standing(5.0)
    count = len(drive.motion.times_s)
    motion = replace(drive.motion, gear_ratio=np.full(count, np.nan), gear=np.zeros(count, np.int8))
    samples = pulled(Journey(drive.course, motion))
    assert not np.any(samples.gear_ratios)
    assert not np.any(samples.gears)


def test_a_vehicle_without_a_reference_torque_is_refused() -> None:
    """Percent of an unknown is the user's mistake, and is told as one."""
    vehicle = msgspec.structs.replace(CAR, engine_reference_torque_nm=None)
    with pytest.raises(InputError, match="engine_reference_torque_nm is missing"):
        torque.measure(
            standing(5.0),
            QUIET_ENGINE,
            vehicle,
            device=np.random.default_rng(1),
            random=np.random.default_rng(2),
        )


def test_the_assumed_mass_is_off_by_its_share() -> None:
    """400 vehicles know the std to 4 %."""
    model = msgspec.structs.replace(QUIET_ENGINE, mass_error_std=0.05)
    device = np.random.default_rng(3)
    masses = [torque.assumed_vehicle(CAR, model, device).mass_kg / 1500.0 for _ in range(400)]
    assert np.mean(masses) == pytest.approx(1.0, abs=4 * 0.05 / 20)
    assert np.std(masses) == pytest.approx(0.05, rel=0.15)


def test_the_reported_slope_is_the_roads_where_nothing_errs() -> None:
    """Up to 25 s of gaining speed and in the cruise after: the acceleration's share is off."""
    ramp = np.minimum(10.0 + 0.4 * np.arange(801) * 0.05, 20.0)
    slopes = sloped(journey(course(800.0, grade=0.05), ramp))
    assert slopes[50:245] == pytest.approx(5.0, abs=0.01)
    assert slopes[300:-5] == pytest.approx(5.0, abs=0.01)


def test_the_reported_slope_errs_by_what_the_mass_is_off() -> None:
    """A tenth too heavy makes a tenth less slope."""
    heavy = msgspec.structs.replace(CAR, mass_kg=1650.0)
    slopes = sloped(cruise(20.0, 40.0, grade=0.05), heavy)
    assert slopes[50:-5] == pytest.approx(5.0 / 1.1, abs=0.01)


def test_the_reported_slope_carries_the_torques_noise() -> None:
    """White noise of std s leaves a low-pass of n samples as s / sqrt(2 n), here n = 5."""
    slopes = sloped(cruise(20.0, 600.0, grade=0.05), noise_pct=1.0)
    a_percent = 2.5 * 4.1 / WHEEL_RADIUS_M / (1500.0 * 9.81) * 100.0
    kept = math.exp(-0.2)
    expected = a_percent * math.sqrt((1.0 - kept) / (1.0 + kept))
    assert slopes[50:].std() == pytest.approx(expected, rel=0.12)


def test_the_slope_is_13_while_braking_and_only_then() -> None:
    """Papers/004 section 3.3; a real slope so steep reads a step less."""
    speeds_mps = np.concatenate(
        [np.full(400, 20.0), np.linspace(20.0, 4.0, 201), np.full(400, 4.0)]
    )
    drive = journey(course(400.0, grade=0.14), speeds_mps)
    samples, slopes = pulled(drive), sloped(drive)
    assert 95 <= np.count_nonzero(samples.brake) <= 105
    assert np.array_equal(slopes == INVALID_PCT, samples.brake)
    assert slopes[100:190] == pytest.approx(INVALID_PCT - 1e-4)


def test_an_open_driveline_brings_no_force() -> None:
    """With the clutch down the engine's torque says nothing of the road."""
    drive = cruise(20.0, 20.0, grade=0.05)
    opened = np.ones(len(drive.motion.times_s), dtype=np.bool_)
    coasting = Journey(drive.course, replace(drive.motion, clutch=opened))
    assert sloped(coasting)[50:-5] == pytest.approx(0.0, abs=1e-3)


def test_pressure_is_the_standard_atmospheres_on_a_standard_day() -> None:
    """`pressure_altitude_m` gives the altitude back, to 0.05 m."""
    drive = cruise(20.0, 100.0, grade=0.05)
    samples = felt(drive)
    alts_m = [pressure_altitude_m(pressure) for pressure in samples.pressures_pa]
    assert alts_m == pytest.approx(drive.at(samples.instants_s).alts_m, abs=0.05)


def test_weather_moves_all_altitudes_and_cold_stretches_them() -> None:
    """1000 Pa at sea level are some 84 m; at -15 degrees a climb reads 12 % too high."""
    drive = cruise(20.0, 100.0, grade=0.05)
    high = felt(drive, msgspec.structs.replace(CALM, sea_level_pa=102_325.0))
    off_pa = high.pressures_pa[0] - felt(drive).pressures_pa[0]
    assert off_pa * metres_per_pascal(101_325.0) == pytest.approx(84.0, rel=0.02)
    cold = felt(drive, msgspec.structs.replace(CALM, temperature_c=-15.0)).pressures_pa
    read_m = pressure_altitude_m(cold[-1]) - pressure_altitude_m(cold[0])
    truth = drive.at(felt(drive).instants_s).alts_m
    assert read_m / (truth[-1] - truth[0]) == pytest.approx(288.0 / 258.35, rel=0.005)


def test_pressure_follows_the_weathers_trend() -> None:
    """200 Pa an hour are 100 Pa in half of one."""
    samples = felt(standing(1800.0), msgspec.structs.replace(CALM, pressure_trend_pa_per_h=200.0))
    assert samples.pressures_pa[-1] - samples.pressures_pa[0] == pytest.approx(100.0, abs=0.1)


def test_pressure_has_its_noise_and_its_offset() -> None:
    """4000 samples; the offset is the device's."""
    samples = felt(standing(2000.0), noise_pa=3.0, offset_std_pa=100.0)
    still = felt(standing(2000.0)).pressures_pa[0]
    errors = samples.pressures_pa - still - 100.0 * np.random.default_rng(8).standard_normal()
    assert errors.mean() == pytest.approx(0.0, abs=4 * 3.0 / math.sqrt(4000))
    assert errors.std() == pytest.approx(3.0, rel=4 / math.sqrt(2 * 4000))


def test_pressure_wanders_with_its_std_and_time() -> None:
    """400 correlation times know the std to 5 %."""
    pressures = felt(standing(8000.0), wander_std_pa=10.0, wander_time_s=20.0).pressures_pa
    assert pressures.std() == pytest.approx(10.0, rel=0.2)
    late = np.corrcoef(pressures[40:], pressures[:-40])[0, 1]
    assert late == pytest.approx(math.exp(-1.0), abs=0.15)


def test_wind_from_ahead_is_felt_more_than_wind_from_behind() -> None:
    """0.5 rho (v + w)^2 of 1.22 kg/m3, eastwards in a wind from the east, then the west."""
    drive = cruise(20.0, 50.0)
    still = felt(drive).pressures_pa[0]
    for from_deg, flow_mps in ((90.0, 25.0), (270.0, 15.0)):
        weather = msgspec.structs.replace(CALM, wind_mps=5.0, wind_from_deg=from_deg)
        pressures = felt(drive, weather, airflow_coefficient=-0.1).pressures_pa
        expected = -0.1 * 0.5 * 1.22 * flow_mps**2
        assert pressures[5:-5] - still == pytest.approx(expected, rel=0.01)


def test_a_tunnel_pushes_at_its_entrance_and_sucks_at_its_exit() -> None:
    """The full step at 25 m/s, and a third of it TUNNEL_FADE_S later."""
    places = np.zeros(4002, dtype=np.int8)
    places[1000:3000] = Surroundings.TUNNEL
    drive = journey(course(2000.0, surroundings=places), np.full(1401, 25.0))
    samples = felt(drive, tunnel_pa=60.0)
    pressures = samples.pressures_pa - felt(drive).pressures_pa[0]
    entry, exit_ = int(np.argmax(pressures)), int(np.argmin(pressures))
    assert samples.instants_s[[entry, exit_]] == pytest.approx([20.0, 60.0], abs=0.51)
    assert pressures[[entry, exit_]] == pytest.approx([60.0, -60.0], rel=0.01)
    assert pressures[entry + 8] == pytest.approx(60.0 / math.e, rel=0.02)


def test_the_fan_steps_between_levels() -> None:
    """Between its steps the pressure is even."""
    pressures = felt(standing(4000.0), fan_step_pa=25.0, fan_every_s=400.0).pressures_pa
    changes = np.diff(pressures)
    assert 2 <= np.count_nonzero(np.abs(changes) > 0.1) <= 24
    assert np.abs(changes).max() > 5.0


def test_the_flow_buffets_a_barometer() -> None:
    """A tenth of the dynamic pressure: 24 Pa at 20 m/s, 6 Pa at 10 m/s."""
    for speed_mps, std_pa in ((20.0, 24.0), (10.0, 6.0)):
        samples = felt(cruise(speed_mps, 1000.0), buffeting_share=0.1)
        assert samples.pressures_pa.std() == pytest.approx(std_pa, rel=0.08)
