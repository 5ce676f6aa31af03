"""Gyro and wheels err as their models say; bounds are four standard errors unless said."""

import math

import msgspec
import numpy as np
import pytest

from unit.simulator.journeys import (
    WHEEL_RADIUS_M,
    course,
    cruise,
    journey,
    standing,
    turns_and_stops,
)
from wayline.drive import Vehicle
from wayline_simulator import gyro, odometer
from wayline_simulator.gyro import GyroModel, GyroSamples
from wayline_simulator.journey import Floats, Journey
from wayline_simulator.noise import gauss_markov, random_steps
from wayline_simulator.odometer import OdometerModel, OdometerSamples
from wayline_simulator.weather import Weather

CAR = Vehicle(wheel_radius_m=WHEEL_RADIUS_M)
QUIET_GYRO = GyroModel(
    bias_std_degps=0.0,
    bias_wander_std_degps=0.0,
    bias_per_kelvin_degps=0.0,
    scale_std=0.0,
    noise_deg_per_sqrt_s=0.0,
    resolution_degps=1e-6,
)
QUIET_WHEELS = OdometerModel(
    scale_std=0.0, scale_wander_std=0.0, noise_mps=0.0, resolution_mps=1e-6, dead_zone_mps=0.0
)


def with_(model: gyro.GyroModel, **fields: float) -> GyroModel:
    return msgspec.structs.replace(model, **fields)


def rolling(**fields: object) -> OdometerModel:
    return msgspec.structs.replace(QUIET_WHEELS, **fields)


def turned(drive: Journey, model: GyroModel, seed: int = 1) -> GyroSamples:
    device, random = np.random.default_rng(8), np.random.default_rng(seed)
    return gyro.measure(drive, model, Weather(), device=device, random=random)


def rolled(drive: Journey, model: OdometerModel, seed: int = 1, device: int = 8) -> OdometerSamples:
    return odometer.measure(
        drive,
        model,
        CAR,
        device=np.random.default_rng(device),
        random=np.random.default_rng(seed),
    )


def gyro_errors(drive: Journey, samples: GyroSamples) -> Floats:
    return samples.yaw_rates_degps - drive.at(samples.instants_s).yaw_rates_degps


def wheel_speeds(drive: Journey, samples: OdometerSamples) -> Floats:
    return np.interp(samples.instants_s, drive.motion.times_s, drive.motion.speeds_mps)


def lag_correlation(values: Floats, lag: int) -> float:
    return float(np.corrcoef(values[lag:], values[:-lag])[0, 1])


def test_a_wander_has_its_std_and_falls_to_1_over_e_in_its_time() -> None:
    """2000 correlation times: the variance is known to 1 / sqrt(1000), so the std to 2 %."""
    values = gauss_markov(200_000, 0.1, 3.0, 10.0, np.random.default_rng(2))
    assert values.std() == pytest.approx(3.0, rel=0.07)
    assert lag_correlation(values, 100) == pytest.approx(math.exp(-1.0), abs=0.07)


def test_a_wander_is_as_wide_at_its_first_sample_as_later() -> None:
    """A filter must not find the sensor perfect at the start of every drive."""
    random = np.random.default_rng(3)
    firsts = [gauss_markov(2, 1.0, 2.0, 1e6, random)[0] for _ in range(2000)]
    assert np.std(firsts) == pytest.approx(2.0, rel=4 / math.sqrt(2 * 2000))


def test_a_level_steps_as_often_as_asked() -> None:
    """100 steps are expected, whose Poisson std is 10."""
    levels = random_steps(np.arange(40_000.0), 5.0, 400.0, np.random.default_rng(4))
    assert np.count_nonzero(np.diff(levels)) == pytest.approx(100, abs=40)
    assert len(np.unique(levels)) > 50


def test_gyro_noise_is_its_angle_random_walk_times_the_root_of_the_rate() -> None:
    """White noise is given per square root of time, so that a rate may be chosen freely."""
    drive = standing(200.0)
    samples = turned(drive, with_(QUIET_GYRO, noise_deg_per_sqrt_s=0.01, rate_hz=100.0))
    errors = gyro_errors(drive, samples)
    assert errors.std() == pytest.approx(0.1, rel=4 / math.sqrt(2 * len(errors)))
    assert abs(lag_correlation(errors, 1)) < 4 / math.sqrt(len(errors))


def test_vibration_shakes_a_gyro_only_while_the_vehicle_moves() -> None:
    """A sample's std is the vibration's; at rest there is none."""
    model = with_(QUIET_GYRO, vibration_degps=0.1, rate_hz=100.0)
    drive = cruise(20.0, 100.0)
    errors = gyro_errors(drive, turned(drive, model))
    assert errors[200:].std() == pytest.approx(0.1, rel=4 / math.sqrt(2 * len(errors)))
    assert np.abs(gyro_errors(standing(10.0), turned(standing(10.0), model))).max() < 1e-5


def test_vibration_takes_the_steps_out_of_a_coarse_gyros_mean() -> None:
    """A tenth of a degree is read as 0 without; a noise of half a step leaves 0.2 % of a step."""
    drive = cruise(20.0, 400.0)
    coarse = with_(QUIET_GYRO, bias_degps=0.1, resolution_degps=0.25, rate_hz=100.0)
    assert np.all(turned(drive, coarse).yaw_rates_degps[200:] == 0.0)
    shaken = turned(drive, with_(coarse, vibration_degps=0.125))
    assert shaken.yaw_rates_degps[200:].mean() == pytest.approx(0.1, abs=0.004)


def test_gyro_bias_wanders_with_its_std_and_time() -> None:
    """400 correlation times know the std to 5 %."""
    drive = standing(4000.0)
    model = with_(QUIET_GYRO, bias_wander_std_degps=0.06, bias_wander_time_s=10.0, rate_hz=5.0)
    errors = gyro_errors(drive, turned(drive, model))
    assert errors.std() == pytest.approx(0.06, rel=0.2)
    assert lag_correlation(errors, 50) == pytest.approx(math.exp(-1.0), abs=0.15)


def test_gyro_bias_is_drawn_at_every_switching_on() -> None:
    """200 starts know the std of the bias to 5 %."""
    drive = standing(1.0)
    model = with_(QUIET_GYRO, bias_degps=-0.37, bias_std_degps=0.5)
    biases = [gyro_errors(drive, turned(drive, model, seed)).mean() for seed in range(200)]
    assert np.mean(biases) == pytest.approx(-0.37, abs=4 * 0.5 / math.sqrt(200))
    assert np.std(biases) == pytest.approx(0.5, rel=0.2)


def test_gyro_bias_follows_the_temperature_as_it_warms_up() -> None:
    """The bias ends a slope times the warming away from where it began."""
    drive = standing(3000.0)
    model = with_(QUIET_GYRO, bias_per_kelvin_degps=0.01, warm_up_kelvin=10.0)
    samples = turned(drive, model)
    errors = gyro_errors(drive, samples)
    slope = np.random.default_rng(8).standard_normal(2)[1] * 0.01
    assert errors[-1] - errors[0] == pytest.approx(10.0 * slope, rel=0.02)
    assert samples.temperatures_c[-1] - samples.temperatures_c[0] == 10.0


def test_gyro_scale_belongs_to_the_device_and_multiplies_the_turn() -> None:
    """Two drives of one device have the same scale; at 9 deg/s it shows at once."""
    drive = cruise(10.0, 20.0, curvature_per_m=math.radians(0.9))
    scale = 1.0 + 0.01 * np.random.default_rng(8).standard_normal()
    for seed in (1, 2):
        samples = turned(drive, with_(QUIET_GYRO, scale_std=0.01), seed)
        assert samples.yaw_rates_degps[50:-50] == pytest.approx(9.0 * scale, rel=1e-4)


def test_a_gyro_frame_describes_what_was_its_latency_ago() -> None:
    """Best agreement of rate and truth lies at the latency."""
    drive = turns_and_stops()
    samples = turned(drive, with_(QUIET_GYRO, latency_s=0.3, jitter_s=0.0))

    def misfit(latency_s: float) -> float:
        truth = drive.at(samples.times_s - latency_s).yaw_rates_degps
        return float(np.abs(samples.yaw_rates_degps - truth).mean())

    assert misfit(0.3) < 1e-3
    assert misfit(0.2) > 0.1


def test_frames_jitter_and_never_go_backwards() -> None:
    """A jitter as long as half the period would swap frames otherwise."""
    samples = turned(standing(100.0), with_(QUIET_GYRO, jitter_s=0.01, latency_s=0.0))
    assert np.all(np.diff(samples.times_s) >= 0.0)
    late_s = samples.times_s - samples.instants_s
    assert late_s.std() == pytest.approx(0.01, rel=0.2)
    assert len(samples.times_s) == 5000


def test_a_coarse_gyro_reads_whole_steps_only() -> None:
    """css-164's box has 0.25 deg/s a bit."""
    drive = turns_and_stops()
    samples = turned(drive, with_(QUIET_GYRO, resolution_degps=0.25))
    assert np.all(samples.yaw_rates_degps % 0.25 == 0.0)
    assert 0.1 < np.abs(gyro_errors(drive, samples)).max() <= 0.125 + 1e-9


def test_wheel_speed_has_its_scale_and_its_noise() -> None:
    """Mean and std over 6000 samples at 20 m/s."""
    drive = cruise(20.0, 600.0)
    samples = rolled(drive, rolling(scale=0.008, scale_std=0.02, noise_mps=0.05))
    scale = 1.008 + 0.02 * np.random.default_rng(8).standard_normal()
    errors = samples.speeds_mps - 20.0 * scale
    assert errors[5:].mean() == pytest.approx(0.0, abs=4 * 0.05 / math.sqrt(6000))
    assert errors[5:].std() == pytest.approx(0.05, rel=4 / math.sqrt(2 * 6000))


def test_wheel_scale_wanders_with_its_std_and_time() -> None:
    """300 correlation times know the std to 6 %."""
    drive = cruise(10.0, 3000.0)
    samples = rolled(drive, rolling(scale_wander_std=0.01, scale_wander_time_s=10.0))
    scales = samples.speeds_mps[5:] / 10.0 - 1.0
    assert scales.std() == pytest.approx(0.01, rel=0.24)
    assert lag_correlation(scales, 100) == pytest.approx(math.exp(-1.0), abs=0.16)


def test_wheels_that_crawl_read_0() -> None:
    """Below the dead zone there are too few pulses, above it nothing is lost."""
    drive = turns_and_stops()
    samples = rolled(drive, rolling(dead_zone_mps=0.8))
    truth = wheel_speeds(drive, samples)
    assert np.all(samples.speeds_mps[truth < 0.79] == 0.0)
    assert np.all(samples.speeds_mps[truth > 0.81] > 0.8)
    assert np.any((truth > 0.1) & (truth < 0.7))


def test_noise_makes_no_wheel_turn_at_rest() -> None:
    """A standstill reads 0 whatever the noise, as filters that look for one rely on."""
    assert not np.any(rolled(standing(100.0), rolling(noise_mps=0.1)).speeds_mps)


def test_a_cut_speed_is_the_whole_steps_below() -> None:
    """12.9 steps read 12, not 13."""
    samples = rolled(cruise(12.9 / 3.6, 10.0), rolling(resolution_mps=1 / 3.6, truncated=True))
    assert samples.speeds_mps[1:] * 3.6 == pytest.approx(12.0)
    rounded = rolled(cruise(12.9 / 3.6, 10.0), rolling(resolution_mps=1 / 3.6))
    assert rounded.speeds_mps[1:] * 3.6 == pytest.approx(13.0)


@pytest.mark.parametrize(("bits", "resolution_m"), [(16, 0.02), (32, 0.05)])
def test_the_counter_counts_the_way_and_wraps(bits: int, resolution_m: float) -> None:
    """At 16 bits and 0.02 m it begins again after 1310.72 m; unwrapped it is the way.

    10.1 km are 7.7 rounds, 7 or 8 wraps by where the counter stood.
    """
    drive = cruise(25.0, 400.0)
    samples = rolled(
        drive, rolling(counter_bits=bits, counter_resolution_m=resolution_m, scale=0.01)
    )
    steps_m = np.diff(samples.distances_m)
    span_m = 2**bits * resolution_m
    assert np.count_nonzero(steps_m < 0.0) in ((7, 8) if bits == 16 else (0,))
    way_m = np.sum(np.where(steps_m < 0.0, steps_m + span_m, steps_m))
    true_m = 25.0 * (samples.instants_s[-1] - max(samples.instants_s[0], 0.0))
    assert way_m == pytest.approx(1.01 * true_m, abs=2 * resolution_m)


def test_the_counter_counts_where_the_speed_reads_0() -> None:
    """Pulses are counted however slowly they come."""
    samples = rolled(cruise(0.2, 100.0), rolling(dead_zone_mps=0.5))
    assert not np.any(samples.speeds_mps)
    assert (samples.distances_m[-1] - samples.distances_m[0]) % 3276.8 == pytest.approx(20, abs=0.2)


def test_reverse_is_told_and_the_counter_goes_on() -> None:
    """Behind the turning point the flag is set, and the counter grows as before."""
    drive = journey(course(100.0, backwards_after_m=50.0), np.full(901, 2.0))
    samples = rolled(drive, rolling(rate_hz=10.0))
    behind = drive.at(samples.instants_s).path_m
    assert np.all(samples.reverse[behind > 50.5])
    assert not np.any(samples.reverse[behind < 49.5])
    steps_m = np.diff(samples.distances_m) % 3276.8
    assert steps_m.sum() == pytest.approx(2.0 * (samples.instants_s[-1] - 0.0), abs=0.3)
