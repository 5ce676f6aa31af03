"""Figures of sensors, of samples whose statistics are known."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from builders import fix
from unit.evaluation.drives import START_S, eastwards
from wayline.messages import GpsFix
from wayline_evaluation.commands import evaluate_app
from wayline_evaluation.estimates import Floats
from wayline_evaluation.plane import Grid
from wayline_evaluation.sensed import Series
from wayline_evaluation.sensor_gps import autocorrelation, gps_figures
from wayline_evaluation.sensor_models import allan_model, correlation_model
from wayline_evaluation.sensor_record import Epochs, SensorRecord, epochs_of
from wayline_evaluation.sensor_series import (
    allan_of,
    lag_1_of,
    quantiles_of,
    roughness_of,
    spread_of,
    step_of,
)
from wayline_evaluation.sensor_study import read_sensors
from wayline_evaluation.sensor_vehicle import barometer_figures, gyro_figures, odometer_figures
from wayline_evaluation.standstills import Span, standstills, windows
from wayline_simulator.drive_folder import simulate
from wayline_simulator.gps import GpsModel
from wayline_simulator.gyro import GyroModel
from wayline_simulator.noise import gauss_markov, in_steps
from wayline_simulator.road_model import RoadModel
from wayline_simulator.scenario import Scenario

NOTHING = Series(np.empty(0), np.empty(0))
GRID = Grid(56.0, 10.0)
RNG_SEED = 7


def series(values: Floats, rate_hz: float) -> Series:
    return Series(START_S + np.arange(len(values)) / rate_hz, np.asarray(values, np.float64))


def epochs(east_m: Floats, north_m: Floats, speeds_mps: Floats, step_s: float = 1.0) -> Epochs:
    lats_deg, lons_deg = GRID.to_geodetic(east_m, north_m)
    return epochs_of(
        [
            fix(number * step_s, lat, lon, alt_m=50.0, speed_mps=speed, satellites=9, hdop=0.8)
            for number, (lat, lon, speed) in enumerate(
                zip(lats_deg.tolist(), lons_deg.tolist(), speeds_mps.tolist(), strict=True)
            )
        ],
        None,
    )


def record(
    *,
    fixes: Epochs | None = None,
    gyro: Series = NOTHING,
    odometer: Series = NOTHING,
    barometer: Series = NOTHING,
    rests: tuple[Span, ...] = (),
    has_truth: bool = False,
) -> SensorRecord:
    return SensorRecord(
        drive="made",
        start_s=START_S,
        epochs=epochs_of([], None) if fixes is None else fixes,
        gyro=gyro,
        odometer=odometer,
        barometer=barometer,
        rests=rests,
        has_truth=has_truth,
        facts=None,
    )


def test_a_standstill_ends_where_the_vehicle_moves_or_nobody_knows() -> None:
    """Two seconds are left out at both ends; what is then too short is none."""
    times_s = np.concatenate([np.arange(0.0, 30.0), np.arange(40.0, 60.0)])
    still = np.ones(50, dtype=np.bool_)
    still[13:15] = False
    assert standstills(times_s, still) == (
        Span(2.0, 10.0),
        Span(17.0, 27.0),
        Span(42.0, 57.0),
    )
    assert standstills(times_s[:6], still[:6]) == ()


def test_a_standstill_is_cut_into_windows_of_one_length() -> None:
    """What is left over is left out."""
    cut = list(windows((Span(0.0, 25.0), Span(50.0, 55.0)), 10.0))
    assert cut == [Span(0.0, 10.0), Span(10.0, 20.0)]


def test_the_allan_deviation_of_several_standstills_counts_each_by_its_length() -> None:
    """9000 samples of 0.1 and 3000 of 0.2 deg/s at 50 Hz: variances of 0.0175 / (50 tau).

    500 clusters are right to a tenth (3 sigma).
    """
    random = np.random.default_rng(RNG_SEED)
    quiet, loud = 0.1 * random.standard_normal(9000), 5.0 + 0.2 * random.standard_normal(3000)
    for point in allan_of([quiet, loud], 50.0):
        if point.tau_s <= 0.5:
            ought = np.sqrt(0.0175 / (50.0 * point.tau_s))
            assert point.deviation_degps == pytest.approx(ought, rel=0.1)


def test_spread_and_correlation_are_about_each_pieces_own_mean() -> None:
    """Another bias in each standstill is no noise. 20000 samples: 3 sigma are 0.02."""
    pieces = [
        level + gauss_markov(10_000, 1.0, 0.2, 5.0, np.random.default_rng(RNG_SEED + number))
        for number, level in enumerate((0.0, 30.0))
    ]
    assert lag_1_of(pieces) == pytest.approx(np.exp(-0.2), abs=0.02)
    assert spread_of(pieces) == pytest.approx(0.2, rel=0.07)
    assert lag_1_of([np.ones(5)]) is None


def test_third_differences_tell_noise_from_motion_and_outliers() -> None:
    """A parabola and a few jumps leave the noise of 0.3; 5000 differences are right to 0.05."""
    random, seconds = np.random.default_rng(RNG_SEED), np.arange(5000.0)
    values = 0.4 * seconds**2 + 0.3 * random.standard_normal(5000)
    values[::500] += 100.0
    assert roughness_of(np.diff(values, 3)) == pytest.approx(0.3, rel=0.07)
    assert roughness_of(np.array([np.nan])) is None


def test_the_step_is_the_smallest_difference_of_values() -> None:
    """0.2777778 m/s a km/h, converted with the errors of floating-point numbers."""
    speeds = np.array([0.0, 3.0, 7.0, 8.0, 3.0]) * 0.2777778 + 1e-9 * np.arange(5)
    assert step_of(speeds) == pytest.approx(0.277778, abs=2e-6)
    assert step_of(np.array([1.0, 1.0])) is None


def test_errors_are_the_fixs_less_the_truth_and_unknown_without_a_fix() -> None:
    """3 m east, 4 m south and 2 m up of a road; a receiver that saw nothing has no error."""
    truth = eastwards()
    lons_deg, lats_deg = truth.lons_deg[100], truth.lats_deg[100]
    grid = Grid(float(lats_deg), float(lons_deg))
    lats, lons = grid.to_geodetic(np.array([3.0]), np.array([-4.0]))
    blind = GpsFix(t_ns=round((START_S + 11.0) * 1e9), valid=False, lat_deg=1.0, lon_deg=1.0)
    found = epochs_of([fix(10.0, float(lats[0]), float(lons[0]), alt_m=52.0), blind], truth)
    assert found.errors_m[0] == pytest.approx([3.0, -4.0, 2.0], abs=1e-3)
    assert np.isnan(found.errors_m[1]).all()


def test_the_autocorrelation_of_a_gauss_markov_error_is_its_models() -> None:
    """With a fifth of the fixes missing; 1000 time constants are right to some 0.1 (3 sigma)."""
    random = np.random.default_rng(RNG_SEED)
    model = GpsModel(
        position_wander_std_m=2.0, position_wander_time_s=20.0, position_white_std_m=1.0
    )
    errors = gauss_markov(20_000, 1.0, 2.0, 20.0, random) + random.standard_normal(20_000)
    errors[random.random(20_000) < 0.2] = np.nan
    lags = np.array([1.0, 10.0, 30.0])
    found = [autocorrelation([errors[:12_000], errors[12_000:]], int(lag)) for lag in lags]
    assert found == pytest.approx(list(correlation_model(model, lags)), abs=0.1)


def test_holes_first_fix_and_invalid_epochs_are_counted() -> None:
    """Four blind seconds, then fixes with a hole of 5 s and one invalid epoch in ten."""
    seconds = [number for number in range(40) if not 20 < number < 25]
    fixes = [
        GpsFix(t_ns=round((START_S + second) * 1e9), valid=False)
        if second < 4 or second in (10, 30, 31)
        else fix(float(second), 56.0, 10.0)
        for second in seconds
    ]
    figures = gps_figures([record(fixes=epochs_of(fixes, None))])
    assert figures is not None
    assert (figures.first_fix_s, figures.holes, figures.longest_hole_s) == (4.0, 3, 5.0)
    assert figures.invalid_share == pytest.approx(3 / 32)
    assert figures.errors is None


def test_roughness_across_the_track_is_deaf_to_timestamps_and_jerk() -> None:
    """20 m/s with 0.5 m of noise along the track and 0.1 m across; 3000 fixes are right to 7 %."""
    random = np.random.default_rng(RNG_SEED)
    along_m = 20.0 * np.arange(3000.0) + 0.5 * random.standard_normal(3000)
    across_m = 0.1 * random.standard_normal(3000)
    east_m, north_m = along_m * 0.8 + across_m * 0.6, along_m * 0.6 - across_m * 0.8
    figures = gps_figures([record(fixes=epochs(east_m, north_m, np.full(3000, 20.0)))])
    assert figures is not None
    assert figures.across_roughness_m == pytest.approx(0.1, rel=0.07)


def test_drift_and_speed_at_rest_are_of_standstills_only() -> None:
    """Fixes that walk 1 m/s east while the vehicle stands for 11 s, and elsewhere do not count."""
    speeds_mps = np.where(np.arange(60) < 20, 15.0, 0.01)
    there = epochs(np.arange(60.0), np.zeros(60), speeds_mps)
    figures = gps_figures([record(fixes=there, rests=(Span(START_S + 30.0, START_S + 41.0),))])
    assert figures is not None
    assert figures.rest_drift_m is not None
    # ten fixes in a row 1 m apart: variance 99 / 12, of an axis half of it
    assert figures.rest_drift_m.p50 == pytest.approx(np.sqrt(99.0 / 12.0 / 2.0), rel=1e-3)
    assert figures.rest_windows == 1
    assert figures.rest_speed_mps == quantiles_of(np.full(11, 0.01))


def test_a_gyro_is_judged_at_rest() -> None:
    """Bias and noise of two minutes of standing; what it says in bends does not count."""
    random = np.random.default_rng(RNG_SEED)
    rates = in_steps(-0.4 + 0.2 * random.standard_normal(6000), 0.01)
    turning = np.concatenate([rates, rates + 20.0])
    figures = gyro_figures(
        [record(gyro=series(turning, 50.0), rests=(Span(START_S, START_S + 119.9),))]
    )
    assert figures is not None
    assert figures.rate_hz == pytest.approx(50.0)
    assert figures.step_degps == pytest.approx(0.01)
    assert figures.bias_degps == pytest.approx(-0.4, abs=0.01)
    assert figures.std_degps == pytest.approx(0.2, rel=0.03)
    assert figures.rest_s == pytest.approx(119.9, abs=0.1)


def test_a_gyro_that_never_rests_has_a_rate_and_a_step() -> None:
    """Nothing else of it is known."""
    figures = gyro_figures([record(gyro=series(np.array([1.0, 1.5, 3.0]), 50.0))])
    assert figures is not None
    assert (figures.step_degps, figures.bias_degps, figures.allan) == (0.5, None, ())


def test_an_odometers_steps_are_counted_while_it_moves() -> None:
    """Standing at 0 says nothing; of four moving differences two are 0, one is one step."""
    wheels = series(np.array([0.0, 0.0, 0.0, 6.0, 6.0, 6.0, 7.0, 9.0]), 1.0)
    gps = epochs(np.arange(8.0), np.zeros(8), np.array([0.0, 0, 0, 6.6, 6.6, 6.6, 7.7, 9.9]))
    figures = odometer_figures([record(odometer=wheels, fixes=gps)])
    assert figures is not None
    assert (figures.step_mps, figures.slowest_mps) == (1.0, 6.0)
    assert (figures.unchanged_share, figures.one_step_share) == (0.5, 0.25)
    assert figures.gps_over_wheels == pytest.approx(1.1)
    assert figures.gps_residual_mps == pytest.approx(0.0, abs=1e-9)


def test_a_barometers_noise_is_told_from_a_climb() -> None:
    """10 Pa a second uphill with 2 Pa of noise; 3000 samples are right to 7 %."""
    random = np.random.default_rng(RNG_SEED)
    pressures = 95_000.0 - 10.0 * np.arange(3000.0) + 2.0 * random.standard_normal(3000)
    figures = barometer_figures([record(barometer=series(pressures, 1.0))])
    assert figures is not None
    assert figures.roughness_pa == pytest.approx(2.0, rel=0.07)
    assert figures.change_rms_pa == pytest.approx(np.hypot(10.0, 2.0 * np.sqrt(2.0)), rel=0.03)


def test_what_a_vehicle_does_not_have_is_not_in_the_report() -> None:
    """No sensor, no figures."""
    nothing = [record()]
    assert gps_figures(nothing) is None
    assert gyro_figures(nothing) is None
    assert odometer_figures(nothing) is None
    assert barometer_figures(nothing) is None


def test_the_allan_model_is_what_a_gyro_with_these_errors_does() -> None:
    """White noise, rounding and a wander of 20 s; 50 clusters are right to a fifth.

    Of many clusters a twentieth: without its rounding the model would be off by a seventh.
    """
    random = np.random.default_rng(RNG_SEED)
    model = GyroModel(
        rate_hz=10.0,
        noise_deg_per_sqrt_s=0.02,
        bias_wander_std_degps=0.05,
        bias_wander_time_s=20.0,
        resolution_degps=0.12,
    )
    noise = 0.02 * np.sqrt(10.0) * random.standard_normal(36_000)
    wander = gauss_markov(36_000, 0.1, 0.05, 20.0, random)
    points = [
        point for point in allan_of([in_steps(noise + wander, 0.12)], 10.0) if point.tau_s <= 60.0
    ]
    ought = allan_model(model, np.array([point.tau_s for point in points]))
    assert ought is not None
    found = [point.deviation_degps for point in points]
    assert found == pytest.approx(list(ought), rel=0.2)
    assert found[:5] == pytest.approx(list(ought[:5]), rel=0.05)


def test_no_allan_model_is_claimed_where_noise_hides_between_two_steps() -> None:
    """css-164's gyro: what rounding does depends on where its bias lies."""
    model = GyroModel(rate_hz=100.0, noise_deg_per_sqrt_s=0.005, resolution_degps=0.25)
    assert allan_model(model, np.array([1.0])) is None


def _files(folder: Path) -> tuple[str, ...]:
    return "--json", str(folder / "out.json"), "--plot", str(folder / "out.png")


def test_the_command_shows_simulated_drives_beside_a_recorded_log(tmp_path: Path) -> None:
    """Sensors come out with the statistics they were given; two runs are one column."""
    road = RoadModel(kind="main", length_m=3000.0)
    simulate(Scenario(preset="mems", runs=2, road=road), tmp_path / "made")
    log = tmp_path / "receiver.nmea"
    log.write_bytes(
        b"".join(
            line.split(b" ", 1)[1]
            for line in (tmp_path / "made/run-1/gps.nmea").read_bytes().splitlines(keepends=True)
        )
    )
    drives = [str(tmp_path / f"made/run-{number}") for number in (1, 2)]
    answer = CliRunner().invoke(
        evaluate_app,
        ["sensors", *drives, *("--beside", str(log)), *_files(tmp_path)],
    )
    assert answer.exit_code == 0, answer.output
    assert "2 drives" in answer.output
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    made, beside = json.loads((tmp_path / "out.json").read_text())["columns"]
    assert made["drives"] == ["run-1", "run-2"]
    model = GyroModel()
    white = np.hypot(
        model.noise_deg_per_sqrt_s * np.sqrt(model.rate_hz), model.resolution_degps / np.sqrt(12.0)
    )
    # some 3000 samples at rest: 3 sigma are 4 %
    assert made["gyro"]["std_degps"] == pytest.approx(white, rel=0.05)
    assert made["odometer"]["step_mps"] == pytest.approx(0.01)
    assert made["gps"]["errors"]["up_rms_m"] > 0.5
    assert 0.01 < made["gps"]["errors"]["speed_rms_mps"] < 0.5
    assert beside["drives"] == ["receiver"]
    assert (beside["gyro"], beside["gps"]["errors"]) == (None, None)
    assert beside["gps"]["rate_hz"] == pytest.approx(1.0)


def test_a_recorded_canyon_has_its_published_figures(recorded: Callable[[str], Path]) -> None:
    """munich.nmea's README: 1867 epochs, 20 invalid, a hole of 21 s; it freezes where it stands."""
    figures = gps_figures([read_sensors(recorded("nmea") / "munich.nmea")])
    assert figures is not None
    assert figures.hdop is not None
    assert figures.rest_speed_mps is not None
    assert figures.epochs == 1867
    assert figures.invalid_share == pytest.approx(20 / 1867, abs=0.0005)
    assert figures.longest_hole_s == pytest.approx(21.0, abs=1.0)
    assert figures.hdop.p50 == pytest.approx(2.4)
    assert figures.rest_speed_mps.p50 == 0.0


def test_a_recorded_cars_gyro_and_wheels(recorded: Callable[[str], Path], tmp_path: Path) -> None:
    """css-164's README: 0.25 deg/s and 1 km/h a step, sd 0.13 and -0.34 to -0.38 deg/s at rest."""
    folder = recorded("css-164")
    text = (folder / "drive.toml").read_text(encoding="utf-8")
    for name in ("canmod-gps.dbc", "obd2.dbc", "1.mf4"):
        text = text.replace(f'"{name}"', json.dumps(str(folder / name)))
    text = text.replace(', "2.mf4", "3.mf4", "4.mf4", "5.mf4"', "")
    (tmp_path / "drive.toml").write_text(text, encoding="utf-8")
    drive = [read_sensors(tmp_path)]
    gyro, odometer = gyro_figures(drive), odometer_figures(drive)
    assert gyro is not None
    assert odometer is not None
    assert gyro.step_degps == pytest.approx(0.25)
    assert gyro.std_degps == pytest.approx(0.13, abs=0.01)
    assert gyro.bias_degps == pytest.approx(-0.36, abs=0.02)
    assert odometer.step_mps == pytest.approx(1.0 / 3.6, abs=1e-4)
    assert odometer.gps_over_wheels == pytest.approx(0.992, abs=0.006)
