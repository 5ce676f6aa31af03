"""Altitude and slope on fusion's timeline: when they are told, and who is believed."""

import math
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise

import msgspec
import numpy as np
import pytest

from builders import about, at, fix, odometer, only, run_core
from unit.fusion.drives import ORIGIN, Motion, Sensors, messages_of, seconds_of, straight, truth_of
from wayline.air import EXPONENT, SCALE_M, SEA_LEVEL_PA
from wayline.core import Record
from wayline.inputs import Flush
from wayline.messages import Barometer, FusionStatus, GpsFix, Message, Pose, Verdict
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.keeping.records import Saved

GRADE = 0.08
BASE_M = 100.0
WEATHER_M = -40.0
"""Barometric altitude minus altitude."""


def level(path_m: float) -> float:
    del path_m
    return BASE_M


def climbing(path_m: float) -> float:
    return BASE_M + GRADE * path_m


def pressure_pa(alt_m: float) -> float:
    return SEA_LEVEL_PA * math.pow(1.0 - (alt_m + WEATHER_M) / SCALE_M, 1.0 / EXPONENT)


def heard(
    road: Callable[[float], float],
    duration_s: float,
    sensors: Sensors | None = None,
    *,
    motion: Motion = straight,
    has_barometer: bool = True,
    off_m: Callable[[float], float] = lambda _: 0.0,
) -> Iterator[Message]:
    """A drive whose fixes tell altitudes, off by `off_m`, beside a barometer at 2 Hz."""
    truths = truth_of(motion, duration_s)
    for message in messages_of(motion, truths, sensors or Sensors()):
        seconds = seconds_of(message.t_ns)
        alt_m = road(truths[min(round(seconds * 100), len(truths) - 1)].path_m)
        if isinstance(message, GpsFix):
            told_m = round(alt_m + off_m(seconds), 2)
            yield msgspec.structs.replace(message, alt_m=told_m, v_std_m=3.0)
            continue
        yield message
        if has_barometer and message.topic == "odometer" and round(seconds * 10) % 5 == 0:
            flicker_pa = 0.1 * (round(seconds * 2) % 3)
            yield Barometer(
                t_ns=message.t_ns, pressure_pa=round(pressure_pa(alt_m) + flicker_pa, 1)
            )


def poses_of(messages: Iterable[Message], tuning: Tuning | None = None) -> list[Pose]:
    poses: list[Pose] = only(run_core(FusionCore(tuning or Tuning()), list(messages)), Pose)
    return poses


def verdicts_of(messages: Iterable[Message]) -> list[Verdict]:
    statuses = only(run_core(FusionCore(Tuning()), list(messages)), FusionStatus)
    return [verdict for status in statuses for verdict in status.verdicts]


@pytest.mark.parametrize("has_barometer", [True, False])
def test_late_fixes_move_neither_altitude_nor_north(has_barometer: bool) -> None:
    """0.9 s at 20 m/s up 8 % are 1.4 m: a fix that is taken as new would pull the altitude down."""
    prompt, late = (
        poses_of(heard(climbing, 90.0, Sensors(latency_s=s), has_barometer=has_barometer))[-1]
        for s in (0.0, 0.9)
    )
    assert late.alt_m == pytest.approx(prompt.alt_m, abs=0.05)
    assert late.grade_pct == pytest.approx(prompt.grade_pct, abs=0.05)
    assert ORIGIN.to_plane(late.lat_deg or 0.0, 10.0)[1] == pytest.approx(
        ORIGIN.to_plane(prompt.lat_deg or 0.0, 10.0)[1], abs=0.1
    )
    assert late.alt_m == about(climbing(20.0 * 89.9), 1.0)


def walls(seconds: float) -> float:
    """Between high walls from the third minute on: each set reflects for twenty seconds."""
    if not 180.0 <= seconds < 240.0:
        return 0.0
    return (-78.9, 72.0, -30.0)[int(seconds - 180.0) // 20]


def test_where_reflections_last_the_altitude_is_held_by_the_barometer() -> None:
    messages = list(heard(level, 300.0, off_m=walls))
    alts_m = np.array([pose.alt_m for pose in poses_of(messages)][10:])
    assert max(abs(after - before) for before, after in pairwise(alts_m)) < 0.5
    assert np.max(np.abs(alts_m - BASE_M)) < 2.0
    rejected = [v for v in verdicts_of(messages) if v.sensor == "gps_altitude" and not v.accepted]
    assert len(rejected) > 50
    assert all(v.reason and v.nis > v.threshold for v in rejected)


def test_without_a_barometer_the_slope_holds_the_altitude_for_a_while() -> None:
    def wall(seconds: float) -> float:
        return -78.9 if 180.0 <= seconds < 190.0 else 0.0

    poses = poses_of(heard(level, 240.0, off_m=wall, has_barometer=False))
    assert max(abs((pose.alt_m or 0.0) - BASE_M) for pose in poses[10:]) < 2.0


def test_altitudes_that_stay_elsewhere_are_believed_after_as_long_as_the_others_were() -> None:
    """So does the barometer's bias: what it measures is the sum, and the next one does not pull."""

    def wrong_at_first(seconds: float) -> float:
        return 60.0 if seconds < 30.0 else 0.0

    poses = poses_of(heard(level, 120.0, off_m=wrong_at_first))
    by_s = {round(seconds_of(pose.t_ns), 1): pose.alt_m for pose in poses}
    assert by_s[29.0] == about(BASE_M + 60.0, 2.0)
    assert by_s[50.0] == about(BASE_M + 60.0, 2.0)
    assert by_s[70.0] == about(BASE_M, 2.0)
    assert by_s[119.0] == about(BASE_M, 1.0)


def test_one_impossible_pressure_is_rejected_and_said_so() -> None:
    messages = list(heard(level, 60.0))
    place = next(i for i, m in enumerate(messages) if isinstance(m, Barometer) and m.t_ns > at(50))
    messages[place] = Barometer(t_ns=messages[place].t_ns, pressure_pa=pressure_pa(BASE_M) - 500.0)
    assert poses_of(messages)[-1].alt_m == about(BASE_M, 0.3)
    (rejected,) = [v for v in verdicts_of(messages) if v.sensor == "barometer" and not v.accepted]
    assert rejected.t_ns == messages[place].t_ns


def test_a_barometer_alone_gives_the_slope_and_an_altitude_as_good_as_the_weather_allows() -> None:
    tuning = Tuning(vertical_sensors=("barometer",))
    last = poses_of(heard(climbing, 120.0, off_m=lambda _: 500.0), tuning)[-1]
    assert last.alt_m == about(climbing(20.0 * 119.9) + WEATHER_M, 2.0)
    assert last.alt_std_m == about(tuning.baro_bias_initial_std_m, 10.0)
    assert last.grade_pct == about(100.0 * GRADE, 0.3)


def test_gps_alone_does_not_hear_the_barometer() -> None:
    tuning = Tuning(vertical_sensors=("gps",))
    with_one, without = (
        poses_of(heard(climbing, 60.0, has_barometer=has_barometer), tuning)[-1]
        for has_barometer in (True, False)
    )
    assert with_one.alt_m == without.alt_m


def test_a_noisy_barometer_is_found_out() -> None:
    """Gusts of 3 m: it is worth less than its fine steps say, so the slope stays calm."""
    rng = np.random.default_rng(5)
    gusty = [
        msgspec.structs.replace(m, pressure_pa=round(m.pressure_pa + rng.normal(0.0, 36.0), 1))
        if isinstance(m, Barometer) and m.pressure_pa is not None else m
        for m in heard(level, 300.0)
    ]  # fmt: skip
    grades_pct = np.array([pose.grade_pct for pose in poses_of(gusty)])[1000:]
    assert np.sqrt(np.mean(grades_pct**2)) < 1.0


def test_a_2d_fix_tells_no_altitude() -> None:
    messages = [
        msgspec.structs.replace(m, mode=2, alt_m=900.0)
        if isinstance(m, GpsFix) and m.t_ns > at(30) else m
        for m in heard(level, 60.0)
    ]  # fmt: skip
    assert poses_of(messages)[-1].alt_m == about(BASE_M, 1.0)


def test_each_receiver_has_an_error_of_its_own() -> None:
    """Two that are 6 m apart: the altitude is between them, and neither is rejected."""
    core = FusionCore(Tuning())
    outputs: list[Message | Record] = []
    for second in range(240):
        lat_deg, lon_deg = ORIGIN.to_geodetic(0.0, 20.0 * second)
        outputs += core.handle(odometer(second - 0.02, 20.0), "can-ingest")
        for source, alt_m in (("gps-ingest", 97.0), ("gps-ingest-2", 103.0)):
            told = fix(second, lat_deg, lon_deg, alt_m=alt_m, v_std_m=4.0, speed_mps=20.0)
            outputs += core.handle(told, source)
    verdicts = [v for s in only(outputs, FusionStatus) for v in s.verdicts]
    altitudes = [v for v in verdicts if v.sensor == "gps_altitude"]
    assert len(altitudes) > 400
    assert sum(v.accepted for v in altitudes) > 0.98 * len(altitudes)
    height = core._vertical.height_at(core._estimator.progress)
    assert height is not None
    assert height.alt_m == about(100.0, 2.0)


def kept_after(duration_s: float) -> Saved:
    outputs = run_core_with_records(FusionCore(Tuning()), heard(level, duration_s))
    saved = outputs[-1]
    assert isinstance(saved, Saved)
    return saved


def run_core_with_records(core: FusionCore, messages: Iterable[Message]) -> list[msgspec.Struct]:
    for message in messages:
        core.handle(message, "test")
    return list(core.handle(Flush(t_ns=0), "test"))


def test_height_and_barometer_are_known_from_the_start_after_a_restart() -> None:
    """Two seconds after it was kept: by the barometer alone, no altitude of a fix was told."""
    saved = kept_after(300.0)
    assert saved.height is not None
    assert saved.height.alt_m == about(BASE_M, 1.0)
    assert saved.height.baro_bias_m == about(WEATHER_M, 1.0)
    later = [
        msgspec.structs.replace(m, t_ns=m.t_ns + 302_000_000_000)
        for m in heard(level, 20.0, Sensors(outage=(0.0, 99.0)))
    ]
    poses = only(run_core(FusionCore(Tuning(), saved), later), Pose)
    assert poses[5].alt_m == about(BASE_M, 1.5)
    assert poses[-1].alt_m == about(BASE_M, 1.5)
    assert 0.5 < (poses[-1].alt_std_m or 0.0) < 10.0


def test_a_vehicle_carried_up_while_it_was_off_has_its_new_altitude_after_seconds() -> None:
    saved = kept_after(300.0)
    assert saved.height is not None
    later = [
        msgspec.structs.replace(m, t_ns=m.t_ns + 302_000_000_000)
        for m in heard(lambda _: BASE_M + 80.0, 30.0)
    ]
    poses = only(run_core(FusionCore(Tuning(), saved), later), Pose)
    assert poses[-1].alt_m == about(BASE_M + 80.0, 3.0)


def test_after_a_silence_of_hours_the_first_altitude_counts() -> None:
    """A vehicle may have been anywhere; nothing that was known of the height is held against it."""
    hours_ns = 5 * 3_600_000_000_000
    later = [msgspec.structs.replace(m, t_ns=m.t_ns + hours_ns) for m in heard(climbing, 12.0)]
    messages = [*heard(lambda _: 900.0, 200.0), *later]
    poses = [pose for pose in poses_of(messages) if pose.t_ns > at(5 * 3600)]
    assert poses[0].alt_m is None or abs(poses[0].alt_m - BASE_M) < 5.0
    assert poses[-1].alt_m == about(climbing(20.0 * 11.9), 2.0)
