from typing import Any

import numpy as np
import pytest

from unit.simulator.gps_journeys import START_S, drive
from wayline.geo import WGS84
from wayline_simulator.course import Surroundings
from wayline_simulator.gps import Fixes, GpsModel, measure_fixes
from wayline_simulator.gps_events import DisplacedFixes, GpsEvents, Outage
from wayline_simulator.journey import Floats, Journey

CLEAN: dict[str, Any] = {
    "position_white_std_m": 0.0,
    "position_wander_std_m": 0.0,
    "altitude_white_std_m": 0.0,
    "altitude_wander_std_m": 0.0,
    "velocity_std_mps": 0.0,
    "velocity_rest_std_mps": 0.0,
    "reflection_std_m": 0.0,
    "reacquire_error_m": 0.0,
    "reacquire_s": 0.0,
    "arrival_jitter_s": 0.0,
}


def measured(
    journey: Journey, events: GpsEvents | None = None, seed: int = 1, **fields: Any
) -> Fixes:
    random = np.random.default_rng(seed)
    return measure_fixes(journey, GpsModel(**fields), events or GpsEvents(), START_S, random)


def offsets_m(journey: Journey, fixes: Fixes) -> tuple[Floats, Floats, Floats]:
    """East, north and up of fixes from the truth at the instants that they describe."""
    truth = journey.at(fixes.described_s)
    azimuth_deg, _, length_m = WGS84.inv(
        truth.lons_deg, truth.lats_deg, fixes.lons_deg, fixes.lats_deg
    )
    azimuth_rad = np.radians(azimuth_deg)
    east_m, north_m = length_m * np.sin(azimuth_rad), length_m * np.cos(azimuth_rad)
    return east_m, north_m, fixes.alts_m - truth.alts_m


def test_a_receiver_without_errors_says_the_truth() -> None:
    """Position, altitude, speed and course are the journey's at the instant described."""
    journey = drive(15.0, 60.0, grade=0.05)
    fixes = measured(journey, **CLEAN)
    truth = journey.at(fixes.described_s)
    assert np.abs(offsets_m(journey, fixes)).max() < 1e-6
    assert fixes.speeds_mps == pytest.approx(truth.speeds_mps)
    assert fixes.courses_deg == pytest.approx(truth.courses_deg)
    assert len(fixes.valid) == 61


def test_the_same_seed_gives_the_same_fixes() -> None:
    """And another seed gives others."""
    journey = drive(15.0, 60.0, Surroundings.STREET)
    first, again, other = (measured(journey, seed=seed).lats_deg for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize("rate_hz", [1.0, 5.0, 10.0])
def test_fixes_lie_on_whole_parts_of_a_second(rate_hz: float) -> None:
    """Whatever the drive's start, as receivers aligned to UTC have it."""
    random = np.random.default_rng(1)
    model = GpsModel(rate_hz=rate_hz)
    fixes = measure_fixes(drive(15.0, 20.0), model, GpsEvents(), START_S + 0.37, random)
    parts = fixes.timestamps_s * rate_hz
    assert parts == pytest.approx(np.round(parts), abs=1e-3)
    assert np.all(fixes.timestamps_s >= START_S + 0.37)
    assert np.diff(fixes.timestamps_s) == pytest.approx(1.0 / rate_hz, abs=1e-6)
    assert np.all(fixes.arrivals_s >= fixes.timestamps_s + model.arrival_delay_s)


def test_a_late_receiver_describes_where_the_vehicle_was() -> None:
    """With 0.35 s latency at 20 m/s a fix lies 7 m behind the vehicle."""
    journey = drive(20.0, 60.0, heading_deg=0.0)
    fixes = measured(journey, **CLEAN, latency_s=0.35)
    now = journey.at(fixes.timestamps_s - START_S)
    behind_m = (now.lats_deg - fixes.lats_deg)[1:] * 111_200.0
    assert behind_m == pytest.approx(7.0, abs=0.01)


def test_errors_have_the_given_std_and_memory() -> None:
    """Std per axis is the model's times the dilution; after one correlation time 1/e is left.

    Of 10 h, 600 such times: three sigma are about 8 % of the first and 0.1 of the second.
    """
    journey = drive(0.0, 36_000.0)
    fixes = measured(journey, altitude_wander_time_s=30.0, position_wander_time_s=60.0)
    east_m, north_m, up_m = offsets_m(journey, fixes)
    model = GpsModel()
    for error_m, dilution, wander_m, white_m, time_s in (
        (east_m, fixes.hdop, model.position_wander_std_m, model.position_white_std_m, 60),
        (north_m, fixes.hdop, model.position_wander_std_m, model.position_white_std_m, 60),
        (up_m, fixes.vdop, model.altitude_wander_std_m, model.altitude_white_std_m, 30),
    ):
        one = error_m / dilution
        assert one.std() == pytest.approx(np.hypot(wander_m, white_m), rel=0.08)
        kept = np.mean(one[:-time_s] * one[time_s:]) / wander_m**2
        assert kept == pytest.approx(np.exp(-1.0), abs=0.1)


def test_reported_stds_are_the_true_ones() -> None:
    """Errors over the receiver's own std have a mean square of 1, over 10 h within a tenth."""
    journey = drive(0.0, 36_000.0)
    fixes = measured(journey, position_wander_time_s=10.0, altitude_wander_time_s=10.0)
    east_m, _, up_m = offsets_m(journey, fixes)
    assert np.mean((east_m / fixes.h_std_m) ** 2) == pytest.approx(1.0, abs=0.1)
    assert np.mean((up_m / fixes.v_std_m) ** 2) == pytest.approx(1.0, abs=0.1)


def test_doppler_gives_speed_and_course() -> None:
    """At 10 m/s speed errs by the velocity's std, course by its share of the speed."""
    fixes = measured(drive(10.0, 3000.0), velocity_std_mps=0.2)
    std_mps = 0.2 * fixes.hdop.mean()
    assert fixes.speeds_mps.std() == pytest.approx(std_mps, rel=0.08)
    assert np.radians(fixes.courses_deg).std() == pytest.approx(std_mps / 10.0, rel=0.08)


def test_a_standing_receiver_knows_no_course() -> None:
    """Its speed is a little above nothing, its course blank, or the last one where it holds it."""
    fixes = measured(drive(0.0, 600.0))
    assert np.isnan(fixes.courses_deg).all()
    assert 0.008 < np.median(fixes.speeds_mps) < 0.02
    held = measured(drive(0.0, 600.0), course_at_rest="held")
    assert len(np.unique(held.courses_deg)) == 1


def test_an_outage_comes_on_schedule() -> None:
    """From its first second until before its last, again after its period."""
    events = GpsEvents(outages=(Outage(start_s=100.0, length_s=30.0, every_s=200.0),))
    fixes = measured(drive(15.0, 400.0), events, reacquire_s=0.0)
    blind = np.flatnonzero(~fixes.valid)
    assert blind.tolist() == [*range(100, 130), *range(300, 330)]


def test_a_tunnel_blinds_and_the_sky_is_found_again_later() -> None:
    """100 s of tunnel, then some seconds more, exponentially distributed with the given mean."""
    journey = drive(15.0, 200.0, covered_m=(600.0, 2100.0))
    blind_s = [np.sum(~measured(journey, seed=seed, reacquire_s=5.0).valid) for seed in range(100)]
    # 100 draws of an exponential: mean 5 within 3 x 5 / sqrt(100), rounded to whole seconds
    assert min(blind_s) >= 100
    assert np.mean(blind_s) == pytest.approx(105.0, abs=1.6)


def test_first_fixes_after_blindness_err_more_and_say_so() -> None:
    """The std begins near the model's and falls to a third in the given time."""
    events = GpsEvents(outages=(Outage(start_s=100.0, length_s=60.0),))
    fields = CLEAN | {"reacquire_error_m": 12.0, "reacquire_error_time_s": 6.0}
    journey = drive(15.0, 300.0)
    runs = [measured(journey, events, seed, **fields) for seed in range(100)]
    errors_m = np.array([offsets_m(journey, run)[0] for run in runs])
    # 100 runs give a std within 3 / sqrt(200)
    assert errors_m[:, 160].std() == pytest.approx(12.0, rel=0.22)
    assert errors_m[:, 166].std() == pytest.approx(12.0 * np.exp(-1.0), rel=0.22)
    assert runs[0].h_std_m[160] == pytest.approx(12.0, rel=0.01)
    assert errors_m[:, 99].std() < 1e-6


def test_a_cold_start_is_blind_then_wild() -> None:
    """No fix before its time; then errors as in css-164, altitude three times as bad."""
    journey = drive(10.0, 300.0)
    fields = CLEAN | {"first_fix_s": 100.0, "first_error_m": 30.0}
    runs = [measured(journey, None, seed, **fields) for seed in range(100)]
    assert not any(run.valid[:100].any() for run in runs)
    assert all(run.valid[100:].all() for run in runs)
    ups_m = np.array([offsets_m(journey, run)[2] for run in runs])
    # 100 runs give a std within 3 / sqrt(200)
    assert ups_m[:, 100].std() == pytest.approx(90.0, rel=0.22)
    assert np.abs(ups_m[:, 250]).max() < 0.01


def test_a_displacement_moves_fixes_together() -> None:
    """All of a span by the same vector, and no other."""
    events = GpsEvents(
        displacements=(DisplacedFixes(start_s=50.0, length_s=3.0, east_m=80.0, north_m=-40.0),)
    )
    journey = drive(15.0, 100.0)
    east_m, north_m, _ = offsets_m(journey, measured(journey, events, **CLEAN))
    assert east_m[50:53] == pytest.approx(80.0, abs=1e-3)
    assert north_m[50:53] == pytest.approx(-40.0, abs=1e-3)
    assert np.abs(np.delete(east_m, [50, 51, 52])).max() < 1e-6


def test_reflections_shift_fixes_that_look_good() -> None:
    """In a canyon fixes are off by tens of metres for tens of seconds, across the street more
    than along it, while HDOP and the reported std stay those of a good fix."""
    journey = drive(8.0, 3600.0, Surroundings.CANYON, heading_deg=0.0)
    fields = CLEAN | {"reflection_std_m": 30.0, "reflection_time_s": 40.0}
    fixes = measured(journey, **fields)
    east_m, north_m, _ = (error_m[fixes.valid] for error_m in offsets_m(journey, fixes))
    # about 90 sets of reflections: their root mean square is known to 15 %
    assert np.sqrt(np.mean(east_m**2 + north_m**2)) == pytest.approx(30.0, rel=0.3)
    assert east_m.std() > 1.3 * north_m.std()
    jumps = np.sum(np.abs(np.diff(east_m)) > 1.0)
    assert 60 < jumps < 130
    assert np.median(fixes.hdop[fixes.valid]) < 2.0
    assert fixes.h_std_m.max() == 0.0


def test_a_smoothing_receiver_is_late_with_its_altitude() -> None:
    """On a steady climb of 0.75 m/s a lag of 10 s is 7.5 m, and starts anew after blindness."""
    journey = drive(15.0, 400.0, grade=0.05)
    events = GpsEvents(outages=(Outage(start_s=200.0, length_s=20.0),))
    fixes = measured(journey, events, **CLEAN, smoothing_time_s=10.0)
    east_m, _, up_m = offsets_m(journey, fixes)
    # the filter is discrete: behind by dt / (e^(dt/T) - 1) = 9.5 s
    assert up_m[199] == pytest.approx(-0.75 * 9.5, abs=0.05)
    assert up_m[220] == pytest.approx(0.0, abs=1e-6)
    assert np.abs(east_m).max() < 1e-6


def test_fixes_are_dropped_and_repeated() -> None:
    """A missing one leaves a hole; a repeated one is the fix before, time included."""
    fixes = measured(drive(15.0, 3000.0), dropped_share=0.1, repeated_share=0.2)
    assert len(fixes.valid) == pytest.approx(2700, abs=60)
    assert np.mean(fixes.repeated) == pytest.approx(0.2, abs=0.03)
    again = np.flatnonzero(fixes.repeated)
    assert np.array_equal(fixes.timestamps_s[again], fixes.timestamps_s[again - 1])
    assert np.array_equal(fixes.lats_deg[again], fixes.lats_deg[again - 1])
    assert np.all(np.diff(fixes.arrivals_s) > 0.0)


def test_three_satellites_give_a_fix_without_altitude() -> None:
    """In a canyon with GPS alone: mode 2, the altitude stands still, VDOP is unknown."""
    fixes = measured(drive(8.0, 1800.0, Surroundings.CANYON, grade=0.02), systems=("gps",))
    flat = fixes.valid & (fixes.mode == 2)
    assert flat.sum() > 20
    used = fixes.view.used[fixes.rows].sum(axis=1)
    assert np.all(used[flat] == 3)
    follows = np.flatnonzero(flat[1:] & flat[:-1]) + 1
    assert np.array_equal(fixes.alts_m[follows], fixes.alts_m[follows - 1])
    assert np.all(used[fixes.mode == 3] >= 4)
