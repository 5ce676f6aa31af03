"""What fusion knows after a restart: what was kept, aged, and given up where it is wrong."""

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import pairwise

import msgspec
import numpy as np
import pytest

from builders import START_NS, about, at, gyro, odometer, only
from unit.fusion.drives import (
    ORIGIN,
    Motion,
    Sensors,
    Truth,
    circle,
    error_m,
    figure_eight,
    heading_error_deg,
    messages_of,
    seconds_of,
    town,
    truth_of,
    winding,
)
from unit.fusion.skies import Receiver, epochs_of, with_epochs
from wayline.core import Record
from wayline.messages import FusionStatus, GpsFix, Gyro, Message, Pose, Verdict
from wayline.node import Node
from wayline.pipeline import Pipeline
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.keeping.records import Saved

NIGHT_S = 8.0 * 3600.0
LOOSE = Tuning()
SENSORS = Sensors(gyro_bias_degps=0.5, odometer_scale=0.97, gps_noise_m=1.0)


def heard(motion: Motion, truths: list[Truth], sensors: Sensors) -> Iterator[Message]:
    """What the sensors say; a gyro whose readings never change would seem a very coarse one."""
    rng = np.random.default_rng(7)
    for message in messages_of(motion, truths, sensors):
        if isinstance(message, Gyro):
            yield gyro(
                seconds_of(message.t_ns), (message.yaw_rate_degps or 0.0) + rng.normal(0, 0.05)
            )
        else:
            yield message


class Kept:
    """A store that remembers all that it is given."""

    def __init__(self) -> None:
        self.records: list[Saved] = []

    def save(self, record: Record) -> Sequence[msgspec.Struct]:
        assert isinstance(record, Saved)
        self.records.append(record)
        return ()


def run(
    messages: Iterable[Message], saved: Saved | None = None, tuning: Tuning = LOOSE
) -> tuple[list[Message], Saved]:
    """What a core publishes, and what it keeps at the end."""
    published: list[Message] = []
    kept = Kept()
    node = Node("fusion", FusionCore(tuning, saved), kept)
    pipeline = Pipeline([node], lambda message, _: published.append(message))
    for message in messages:
        pipeline.feed(message, "test")
    pipeline.finish()
    return [message for message in published if isinstance(message, Pose | FusionStatus)], (
        kept.records[-1]
    )


def between(messages: Iterable[Message], from_s: float, to_s: float) -> list[Message]:
    return [m for m in messages if from_s <= seconds_of(m.t_ns) < to_s]


def later(messages: Iterable[Message], by_s: float) -> list[Message]:
    return [msgspec.structs.replace(m, t_ns=m.t_ns + round(by_s * 1e9)) for m in messages]


def moved(messages: Iterable[Message], east_m: float) -> list[Message]:
    """With fixes that lie elsewhere."""

    def at_new_place(fix: GpsFix) -> GpsFix:
        east_was_m, north_m = ORIGIN.to_plane(fix.lat_deg or 0.0, fix.lon_deg or 0.0)
        lat_deg, lon_deg = ORIGIN.to_geodetic(east_was_m + east_m, north_m)
        return msgspec.structs.replace(fix, lat_deg=lat_deg, lon_deg=lon_deg)

    return [at_new_place(m) if isinstance(m, GpsFix) else m for m in messages]


def parked_town(seconds: float) -> tuple[float, float]:
    """Town for 300 s, then parked."""
    return town(seconds) if seconds < 300.0 else (0.0, 0.0)


@cache
def learned(sensors: Sensors = SENSORS, motion: Motion = parked_town) -> Saved:
    """After five minutes in town, parked."""
    return run(heard(motion, truth_of(motion, 315.0), sensors))[1]


def reasons(statuses: Iterable[FusionStatus]) -> list[Verdict]:
    return [v for status in statuses for v in status.verdicts if v.reason and not v.accepted]


def std_m(pose: Pose) -> float:
    return math.hypot(pose.east_std_m or math.inf, pose.north_std_m or math.inf)


@pytest.mark.parametrize("off_s", [0.5, 2.0])
def test_a_restart_in_a_tunnel_goes_on_with_the_same_pose(off_s: float) -> None:
    """25 s into it at 12 m/s, in the middle of bends; fixes come back after another minute."""
    sensors = SENSORS._replace(outage=(300.0, 400.0))
    truths = truth_of(town, 415.0)
    messages = list(heard(town, truths, sensors))
    _, saved = run(between(messages, 0.0, 325.0))
    outputs, _ = run(between(messages, 325.0 + off_s, 415.0), saved)
    poses = only(outputs, Pose)
    inside = [pose for pose in poses if pose.t_ns < at(400.0)]
    assert {pose.mode for pose in inside} <= {"dead_reckoning", "lost"}
    assert inside[0].mode == "dead_reckoning"
    assert all(error_m(pose, truths) < 3.0 * std_m(pose) for pose in inside)
    assert all(heading_error_deg(p, truths) < 3.5 * (p.heading_std_deg or 0.0) for p in inside)
    assert 5.0 < std_m(inside[-1]) < 600.0
    after = [pose for pose in poses if pose.t_ns >= at(410.0)]
    assert {pose.mode for pose in after} == {"fused"}
    assert max(error_m(pose, truths) for pose in after) < 5.0
    assert only(outputs, FusionStatus)[0].calibration == "calibrated"


def test_raw_measurements_confirm_what_was_kept() -> None:
    """Two seconds without a computer, in the middle of bends; satellites are there all the time."""
    tuning = Tuning(architecture="measurement")
    truths = truth_of(winding, 180.0)
    sensed = [each for each in heard(winding, truths, SENSORS) if not isinstance(each, GpsFix)]
    messages = with_epochs(sensed, epochs_of(truths, Receiver()))
    _, saved = run(between(messages, 0.0, 120.0), tuning=tuning)
    outputs, _ = run(between(messages, 122.0, 180.0), saved, tuning)
    poses = only(outputs, Pose)
    assert poses[0].mode == "dead_reckoning"
    assert {pose.mode for pose in poses if pose.t_ns >= at(125.0)} == {"fused"}
    assert max(error_m(pose, truths) for pose in poses if pose.t_ns >= at(130.0)) < 3.0
    assert only(outputs, FusionStatus)[0].calibration == "calibrated"


def test_a_night_later_the_vehicle_starts_where_it_was_parked() -> None:
    """Tens of metres and a few degrees are honest for what nobody has watched."""
    truths = truth_of(parked_town, 330.0)
    messages = list(heard(parked_town, truths, SENSORS))
    before, saved = run(between(messages, 0.0, 315.0))
    without_fixes = [m for m in between(messages, 315.0, 330.0) if not isinstance(m, GpsFix)]
    outputs, _ = run(later(without_fixes, NIGHT_S), saved)
    parked, started = only(before, Pose)[-1], only(outputs, Pose)
    assert {pose.mode for pose in started} == {"dead_reckoning"}
    assert started[-1].lat_deg == about(parked.lat_deg or 0.0, 2e-5)
    assert started[-1].heading_deg == about(parked.heading_deg or 0.0, 1.0)
    assert 20.0 < std_m(started[-1]) < 80.0
    assert 2.0 < (started[-1].heading_std_deg or 0.0) < 6.0
    assert only(outputs, FusionStatus)[-1].outage_s == about(NIGHT_S + 15.0, 5.0)


def test_a_night_makes_the_gyro_uncertain_and_a_short_rest_certain_again() -> None:
    truths = truth_of(parked_town, 330.0)
    messages = list(heard(parked_town, truths, SENSORS))
    before, saved = run(between(messages, 0.0, 315.0))
    outputs, _ = run(later(between(messages, 315.0, 330.0), NIGHT_S), saved)
    parked, (first, *_, last) = only(before, FusionStatus)[-1], only(outputs, FusionStatus)
    assert first.gyro_bias_degps == about(parked.gyro_bias_degps, 0.01)
    assert first.odometer_scale == about(parked.odometer_scale, 0.001)
    assert parked.gyro_bias_std_degps < 0.05 < first.gyro_bias_std_degps < 1.0
    assert max(parked.odometer_scale_std, 0.002) < first.odometer_scale_std < 0.005
    assert first.calibration == "started"
    assert last.calibration == "calibrated"


def test_what_is_kept_is_what_was_known() -> None:
    saved = learned()
    known, pose = saved.calibration, saved.pose
    assert pose is not None
    assert known.gyro_bias_degps == about(0.5, 0.05)
    assert known.odometer_scale == about(0.97, 0.01)
    assert 0.0 < known.odometer_scale_std < 0.01
    assert len(known.correlations) == 6
    assert max(map(abs, known.correlations)) <= 1.0
    assert pose.fix_ns == about(saved.t_ns, 2e9)


def test_messages_of_before_the_restart_do_not_hide_what_was_kept() -> None:
    """A subscriber that comes back may first get the last fix again."""
    messages = list(heard(parked_town, truth_of(parked_town, 315.0), SENSORS))
    history = next(m for m in reversed(messages[:-300]) if isinstance(m, GpsFix))
    wheels: list[Message] = [odometer(315.0 + k / 10, 0.0) for k in range(20)]
    for before in (history, GpsFix(t_ns=history.t_ns, valid=False)):
        outputs, _ = run([before, *wheels], learned())
        assert {pose.mode for pose in only(outputs, Pose) if pose.t_ns > at(315.0)} == {
            "dead_reckoning"
        }
        assert only(outputs, FusionStatus)[-1].calibration == "calibrated"


def test_nothing_of_the_calibration_is_lost_between_two_runs() -> None:
    """A second of gyro changes nothing but what switching on does to the bias."""
    saved = learned(motion=figure_eight)
    again = run([gyro(316.0 + k / 100, 0.5) for k in range(100)], saved)[1].calibration
    once = saved.calibration
    for name in ("odometer_scale", "gyro_scale", "gps_latency_s"):
        assert getattr(again, name) == about(getattr(once, name), 1e-6)
    for name in ("odometer_scale_std", "gyro_scale_std", "gps_latency_std_s"):
        assert getattr(again, name) == pytest.approx(getattr(once, name), rel=0.05)
    for name in ("position_noise_factor", "velocity_noise_factor", "bias_wander_factor"):
        assert getattr(again, name) == getattr(once, name)
    assert max(map(abs, once.correlations[3:])) > 0.01
    assert again.correlations[3:] == pytest.approx(once.correlations[3:], abs=0.002)


def test_a_place_of_before_a_restart_is_dead_reckoning_until_a_fix_has_told() -> None:
    """Though the last fix was a second ago."""
    messages = list(heard(town, truth_of(town, 90.0), SENSORS))
    _, saved = run(between(messages, 0.0, 80.3))
    outputs, _ = run(between(messages, 80.5, 83.0), saved)
    modes = [pose.mode for pose in only(outputs, Pose)]
    assert modes[:5] == ["dead_reckoning"] * 5
    assert modes[10:] == ["fused"] * len(modes[10:])


def test_what_was_kept_of_a_later_time_calibrates_but_does_not_place() -> None:
    """A drive replayed again begins before what the last replay knew."""
    truths = truth_of(parked_town, 100.0)
    outputs, _ = run(heard(parked_town, truths, SENSORS._replace(outage=(0, 99))), learned())
    assert {status.calibration for status in only(outputs, FusionStatus)} == {"calibrated"}
    assert only(outputs, Pose)[0].mode == "starting"
    assert only(outputs, Pose)[0].lat_deg is None


@pytest.mark.parametrize("latency_s", [0.0, 0.4])
@pytest.mark.parametrize(
    ("moved_m", "sensor"), [(5_000.0, "kept_gps_position"), (0.0, "kept_gps_course")]
)
def test_a_vehicle_that_was_moved_while_off_is_where_the_first_fixes_say(
    moved_m: float, sensor: str, latency_s: float
) -> None:
    """By ferry, or turned round on the spot: the drive to the ship ends at 150 degrees."""

    def to_the_ship(seconds: float) -> tuple[float, float]:
        return circle(seconds) if seconds < 102.0 else (0.0, 0.0)

    last = truth_of(to_the_ship, 130.0)[-1]
    saved = learned(SENSORS, to_the_ship)
    assert saved.pose is not None
    assert saved.pose.heading_deg == about(150.0, 3.0)
    truths = truth_of(town, 60.0)
    start_m = (last.east_m + moved_m, last.north_m)
    ashore = [
        truth._replace(east_m=truth.east_m + start_m[0], north_m=truth.north_m + start_m[1])
        for truth in truths
    ]
    messages = heard(town, ashore, SENSORS._replace(latency_s=latency_s))
    outputs, _ = run(later(messages, NIGHT_S), saved)
    poses = [shifted_back(pose) for pose in only(outputs, Pose)]
    told = [v.sensor for v in reasons(only(outputs, FusionStatus)) if v.sensor.startswith("kept")]
    assert told == [sensor]
    placed = [pose for pose in poses if pose.t_ns >= at(2.0)]
    assert max(error_m(pose, ashore) for pose in placed if pose.t_ns < at(20.0)) < 45.0
    driving = [pose for pose in poses if pose.t_ns >= at(30.0)]
    assert {pose.mode for pose in driving} == {"fused"}
    assert max(error_m(pose, ashore) for pose in driving) < 10.0
    assert max(heading_error_deg(pose, ashore) for pose in driving) < 10.0


def shifted_back(pose: Pose) -> Pose:
    return msgspec.structs.replace(pose, t_ns=pose.t_ns - round(NIGHT_S * 1e9))


def test_another_gyro_is_noticed_at_rest_and_told() -> None:
    """One that reads 1.5 deg/s more; the vehicle stands for 20 s before it drives."""
    saved = learned()
    messages = heard(town, truth_of(town, 19.0), SENSORS._replace(gyro_bias_degps=2.0))
    outputs, _ = run(later(messages, 3600.0), saved)
    statuses = only(outputs, FusionStatus)
    assert statuses[-1].gyro_bias_degps == about(2.0, 0.05)
    told = [v for v in reasons(statuses) if v.sensor == "standstill_gyro"]
    assert any("another bias" in (verdict.reason or "") for verdict in told)


def test_other_tyres_are_noticed_and_told() -> None:
    """12 % smaller ones; the scale is found again within a minute's drive."""
    saved = learned()
    messages = heard(town, truth_of(town, 95.0), SENSORS._replace(odometer_scale=0.85))
    outputs, _ = run(later(messages, 3600.0), saved)
    statuses = only(outputs, FusionStatus)
    assert statuses[-1].odometer_scale == about(0.85, 0.015)
    told = [v.reason or "" for v in reasons(statuses) if v.sensor == "odometer"]
    assert any("another scale" in reason for reason in told)


def test_a_gyro_that_is_warmer_than_it_was_has_an_uncertain_bias() -> None:
    def at_temperature(message: Message, temperature_c: float) -> Message:
        if isinstance(message, Gyro):
            return msgspec.structs.replace(message, temperature_c=temperature_c)
        return message

    messages = list(heard(parked_town, truth_of(parked_town, 320.0), SENSORS))
    warm = [at_temperature(message, 20.0) for message in between(messages, 0.0, 315.0)]
    _, saved = run(warm)
    assert saved.calibration.gyro_temperature_c == about(20.0)
    stds = []
    for temperature_c in (20.0, 50.0):
        driving = [gyro(316.0 + k / 10, 0.5) for k in range(12)]
        outputs, _ = run([at_temperature(m, temperature_c) for m in driving], saved)
        stds.append(only(outputs, FusionStatus)[0].gyro_bias_std_degps)
    assert stds[0] < 0.1
    assert stds[1] == about(math.hypot(stds[0], 0.3), 0.02)


def test_a_place_kept_while_driving_is_soon_worth_nothing() -> None:
    """Power cut at 12 m/s: a minute later the vehicle may be anywhere."""
    truths = truth_of(town, 300.0)
    _, saved = run(heard(town, truths, SENSORS))
    outputs, _ = run([odometer(360.0 + k / 10, 12.0) for k in range(15)], saved)
    assert {pose.mode for pose in only(outputs, Pose)} == {"starting"}
    assert only(outputs, FusionStatus)[0].odometer_scale == about(0.97, 0.01)


def truths_at(truths: Sequence[Truth], seconds: float) -> Truth:
    return truths[round(seconds * 100)]


def test_a_power_cut_at_rest_costs_nothing() -> None:
    """Without any word of the end, what was kept when the vehicle came to rest is there."""
    kept = Kept()
    pipeline = Pipeline([Node("fusion", FusionCore(Tuning()), kept)], lambda *_: None)
    truths = truth_of(parked_town, 312.0)
    for message in heard(parked_town, truths, SENSORS):
        pipeline.feed(message, "test")
    pose = kept.records[-1].pose
    assert pose is not None
    assert abs(pose.speed_mps) < 0.5
    assert kept.records[-1].t_ns < at(304.0)
    east_m, north_m = ORIGIN.to_plane(pose.lat_deg, pose.lon_deg)
    truth = truths_at(truths, 311.0)
    assert math.hypot(east_m - truth.east_m, north_m - truth.north_m) < 5.0


def test_it_is_kept_each_minute() -> None:
    kept = Kept()
    pipeline = Pipeline([Node("fusion", FusionCore(Tuning()), kept)], lambda *_: None)
    for message in heard(circle, truth_of(circle, 200.0), SENSORS):
        pipeline.feed(message, "test")
    times_s = [(record.t_ns - START_NS) * 1e-9 for record in kept.records]
    assert [second - first for first, second in pairwise(times_s)] == [about(60.0, 0.01)] * 2


def test_silence_ages_nothing_that_is_kept() -> None:
    """Ignition off, the computer runs on for ten minutes, then is told to stop."""
    kept = Kept()
    node = Node("fusion", FusionCore(Tuning()), kept)
    pipeline = Pipeline([node], lambda *_: None)
    for message in heard(parked_town, truth_of(parked_town, 306.0), SENSORS):
        pipeline.feed(message, "test")
    for _ in node.advance(at(900.0)):
        pass
    pipeline.finish()
    last = kept.records[-1]
    assert last.t_ns == about(at(308.0), 1e9)
    assert last.pose is not None
    assert last.pose.east_std_m < 20.0
