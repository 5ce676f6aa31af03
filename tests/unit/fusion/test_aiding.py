"""What fusion tells a receiver's loops, held against what a receiver would measure."""

import math
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import NamedTuple

import msgspec
import numpy as np
import pytest

from builders import about, at, only
from satellites import Floats, Sky, ecef, epoch, sky_over
from unit.fusion.drives import (
    ORIGIN,
    Motion,
    Sensors,
    Truth,
    circle,
    messages_of,
    noisy,
    seconds_of,
    stop_and_go,
    straight,
    truth_of,
    winding,
)
from wayline.messages import Aiding, GpsFix, GpsRaw, Gyro, Message
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore

SKY = sky_over(ORIGIN.lat_deg, ORIGIN.lon_deg)
MEMS = Sensors(gyro_bias_degps=0.3, gyro_scale=1.01, odometer_scale=1.01, gps_noise_m=2.0)


def clock_m(seconds: float) -> float:
    """An offset whose drift swings between 79.5 and 80.5 m/s within minutes, as warmth does it."""
    return 1e5 + 80.0 * seconds + 0.5 * 60.0 * math.sin(seconds / 60.0)


class Way:
    """Where the antenna is on a drive."""

    def __init__(self, truths: list[Truth]) -> None:
        self._seconds = np.array([truth.seconds for truth in truths])
        self._east_m = np.array([truth.east_m for truth in truths])
        self._north_m = np.array([truth.north_m for truth in truths])

    def __call__(self, seconds: float) -> Floats:
        east_m = float(np.interp(seconds, self._seconds, self._east_m))
        north_m = float(np.interp(seconds, self._seconds, self._north_m))
        return ecef(*ORIGIN.to_geodetic(east_m, north_m))


class Aided(NamedTuple):
    """A drive's aids, and how they were off."""

    aids: list[Aiding]
    way: Way
    until_s: float

    def errors_hz(self, from_s: float, to_s: float) -> tuple[Floats, Floats]:
        """Told minus true, and the stds, of every satellite of every tenth aid in a time."""
        off, stds = [], []
        for aid in self.aids[::10]:
            seconds = seconds_of(aid.t_ns)
            if from_s <= seconds < min(to_s, self.until_s - 1.0):
                true_hz = SKY.dopplers_hz(self.way, clock_m, seconds)
                for each in aid.satellites:
                    off.append(each.doppler_hz - true_hz[each.prn - 1])
                    stds.append(each.doppler_std_hz)
        return np.array(off), np.array(stds)


Change = Callable[[Message], Message | None]
"""What becomes of a message."""


def unchanged(message: Message) -> Message:
    return message


def driven(
    motion: Motion,
    duration_s: float,
    sensors: Sensors = MEMS,
    change: Change = unchanged,
    tuning: Tuning | None = None,
    **raw: float,
) -> Aided:
    """Gyro, wheels, fixes, and epochs with the fixes."""
    truths = truth_of(motion, duration_s)
    way = Way(truths)
    core = FusionCore(tuning or Tuning())
    node = Node("fusion", core)
    aids: list[Aiding] = []
    told = noisy(messages_of(motion, truths, sensors), 0.05, 0.1)
    for message in with_epochs(told, SKY, way, **raw):
        changed = change(message)
        if changed is not None:
            aids += only(node.take(changed, "test"), Aiding)
    return Aided(aids, way, duration_s)


def with_epochs(messages: Iterable[Message], sky: Sky, way: Way, **raw: float) -> Iterator[Message]:
    for message in messages:
        yield message
        if isinstance(message, GpsFix) and message.t_ns > at(0.5):
            noise_hz = raw.get("doppler_std_hz", 0.3)
            seconds = seconds_of(message.t_ns)
            yield epoch(sky, way, clock_m, seconds, doppler_std_hz=noise_hz)


def without_gps(message: Message, from_s: float, to_s: float) -> Message | None:
    """Neither fixes nor epochs."""
    blind = from_s <= seconds_of(message.t_ns) < to_s
    return None if blind and isinstance(message, GpsFix | GpsRaw) else message


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def inside(off: Floats, stds: Floats) -> float:
    """Share within twice the std."""
    return float(np.mean(np.abs(off) <= 2.0 * stds))


def test_dopplers_are_told_ten_times_a_second_of_every_satellite() -> None:
    aided = driven(circle, 30.0)
    last = aided.aids[-1]
    assert len(last.satellites) == len(SKY.nodes)
    assert [aid.t_ns % 100_000_000 for aid in aided.aids] == [0] * len(aided.aids)
    within = [aid for aid in aided.aids if seconds_of(aid.t_ns) >= 20.0]
    assert len(within) >= 99


@pytest.mark.parametrize("motion", [circle, winding, stop_and_go])
def test_told_dopplers_are_within_three_hz_and_their_std_is_honest(motion: Motion) -> None:
    off, stds = driven(motion, 150.0).errors_hz(60.0, 150.0)
    assert rms(off) < 3.0
    assert inside(off, stds) > 0.9


def test_a_minute_without_satellites_is_bridged() -> None:
    blind = partial(without_gps, from_s=90.0, to_s=150.0)
    off, stds = driven(winding, 151.0, change=blind).errors_hz(120.0, 150.0)
    assert len(off) > 100
    assert rms(off) < 3.0
    assert inside(off, stds) > 0.9


def test_stds_grow_while_nothing_is_heard() -> None:
    blind = partial(without_gps, from_s=60.0, to_s=150.0)
    aids = driven(straight, 150.0, change=blind).aids
    before, after = (
        next(aid for aid in aids if aid.t_ns == at(seconds)).satellites[0].doppler_std_hz
        for seconds in (60.0, 149.0)
    )
    assert after > 1.2 * before


def test_without_the_vehicles_velocity_the_error_is_ten_times_larger() -> None:
    """What a receiver knows that is told the place and its clock, but not how it moves."""
    aided = driven(winding, 150.0)
    off, _ = aided.errors_hz(60.0, 150.0)
    still = []
    for seconds in range(60, 149):
        here = partial(lambda place, _: place, aided.way(float(seconds)))
        moving_hz = SKY.dopplers_hz(aided.way, clock_m, float(seconds))
        still.append(SKY.dopplers_hz(here, clock_m, float(seconds)) - moving_hz)
    assert rms(np.array(still)) > 20.0
    assert rms(np.array(still)) > 10.0 * rms(off)


def test_the_receivers_clock_is_told() -> None:
    aid = driven(circle, 60.0).aids[-1]
    seconds = seconds_of(aid.t_ns)
    drift_mps = (clock_m(seconds + 0.1) - clock_m(seconds - 0.1)) / 0.2
    assert aid.clock_drift_mps == about(drift_mps, 0.3)


def test_pseudoranges_are_told_with_the_clocks_offset() -> None:
    aided = driven(circle, 60.0)
    aid = aided.aids[-11]
    true_m = SKY.pseudoranges_m(aided.way, clock_m, seconds_of(aid.t_ns))
    for each in aid.satellites:
        assert each.pseudorange_m is not None
        assert each.pseudorange_std_m is not None
        assert abs(each.pseudorange_m - true_m[each.prn - 1]) < 3.0 * each.pseudorange_std_m


def test_a_satellite_that_has_gone_behind_a_house_is_still_told_of() -> None:
    """Where it may be found again is what an aid is for."""

    def hidden(message: Message) -> Message:
        if isinstance(message, GpsRaw) and seconds_of(message.t_ns) > 30.0:
            return msgspec.structs.replace(message, satellites=message.satellites[:3])
        return message

    aided = driven(circle, 60.0, change=hidden)
    assert len(aided.aids[-1].satellites) == len(SKY.nodes)
    off, stds = aided.errors_hz(45.0, 60.0)
    assert rms(off) < 3.0
    assert inside(off, stds) > 0.9


def test_a_receiver_without_doppler_is_aided_by_its_pseudoranges() -> None:
    """Its clock's drift is how its offsets grow."""

    def without_doppler(message: Message) -> Message:
        if not isinstance(message, GpsRaw):
            return message
        silent = (msgspec.structs.replace(each, doppler_hz=None) for each in message.satellites)
        return msgspec.structs.replace(message, satellites=tuple(silent))

    off, stds = driven(winding, 120.0, change=without_doppler).errors_hz(80.0, 120.0)
    assert rms(off) < 3.0
    assert inside(off, stds) > 0.9


def test_satellites_without_place_or_motion_are_left_out() -> None:
    def partly(message: Message) -> Message:
        if not isinstance(message, GpsRaw):
            return message
        first, second, *rest = message.satellites
        unplaced = msgspec.structs.replace(first, x_m=None)
        unmoved = msgspec.structs.replace(second, vz_mps=None)
        return msgspec.structs.replace(message, satellites=(unplaced, unmoved, *rest))

    prns = {each.prn for each in driven(circle, 20.0, change=partly).aids[-1].satellites}
    assert prns == set(range(3, len(SKY.nodes) + 1))


@pytest.mark.parametrize(
    "garbage",
    [
        {"x_m": 0.0, "y_m": 0.0, "z_m": 0.0},
        {"x_m": 9e8},
        {"vx_mps": 9e8},
        {"carrier_hz": 1.0, "doppler_hz": 1e9},
    ],
)
def test_garbage_of_one_satellite_leaves_the_others_as_they_are(garbage: dict[str, float]) -> None:
    def spoilt(message: Message) -> Message:
        if not isinstance(message, GpsRaw):
            return message
        first, *rest = message.satellites
        bad = msgspec.structs.replace(first, prn=99, **garbage)
        return msgspec.structs.replace(message, satellites=(bad, *rest))

    aided = driven(circle, 40.0, change=spoilt)
    for aid in aided.aids[-30:-11]:
        true_hz = SKY.dopplers_hz(aided.way, clock_m, seconds_of(aid.t_ns))
        told = [each for each in aid.satellites if each.prn != 99]
        assert len(told) == len(SKY.nodes) - 1
        assert rms(np.array([each.doppler_hz - true_hz[each.prn - 1] for each in told])) < 3.0


def test_an_epoch_far_ahead_holds_none_back() -> None:
    def with_one_ahead(message: Message) -> Message:
        if isinstance(message, GpsRaw) and message.t_ns == at(3.0):
            return msgspec.structs.replace(message, t_ns=at(1e6))
        return message

    assert driven(circle, 20.0, change=with_one_ahead).aids


def test_a_clock_that_is_set_by_a_millisecond_is_no_drift() -> None:
    """Of a receiver that tells no Doppler, where offsets tell the drift."""

    def setting(message: Message) -> Message:
        if not isinstance(message, GpsRaw):
            return message
        set_m = 299_792.458 if seconds_of(message.t_ns) > 50.0 else 0.0
        satellites = (
            msgspec.structs.replace(
                each, doppler_hz=None, pseudorange_m=(each.pseudorange_m or 0.0) - set_m
            )
            for each in message.satellites
        )
        return msgspec.structs.replace(message, satellites=tuple(satellites))

    off, _ = driven(winding, 60.0, change=setting).errors_hz(45.0, 60.0)
    assert rms(off) < 5.0


def test_a_second_receiver_with_another_clock_changes_nothing() -> None:
    truths = truth_of(circle, 30.0)
    way = Way(truths)
    node = Node("fusion", FusionCore(Tuning()))
    drifts: list[float | None] = []
    for message in with_epochs(messages_of(circle, truths, MEMS), SKY, way):
        drifts += [aid.clock_drift_mps for aid in only(node.take(message, "first"), Aiding)]
        if isinstance(message, GpsRaw):
            seconds = seconds_of(message.t_ns)
            other = epoch(SKY, way, lambda seconds: -300.0 * seconds, seconds)
            drifts += [aid.clock_drift_mps for aid in only(node.take(other, "second"), Aiding)]
    assert drifts
    assert all(drift == about(80.0, 3.0) for drift in drifts)


def test_nothing_is_told_without_epochs() -> None:
    def silent(message: Message) -> Message | None:
        return None if isinstance(message, GpsRaw) else message

    assert driven(circle, 20.0, change=silent).aids == []


def test_a_heading_that_is_wrong_shows_in_the_std() -> None:
    """A burst of the gyro turns the pose by degrees: the satellites that are heard tell."""

    def spike(message: Message) -> Message:
        seconds = seconds_of(message.t_ns)
        if isinstance(message, Gyro) and 60.0 <= seconds < 60.3:
            return msgspec.structs.replace(message, yaw_rate_degps=40.0)
        if isinstance(message, GpsFix) and seconds >= 60.0:
            return msgspec.structs.replace(message, course_deg=None, speed_mps=None)
        return message

    aided = driven(straight, 70.0, change=spike)
    _, before = aided.errors_hz(55.0, 60.0)
    off, after = aided.errors_hz(63.0, 69.0)
    assert rms(off) > 5.0
    assert rms(after) > 2.0 * rms(before)
    assert rms(off) < 3.0 * rms(after)


@pytest.mark.parametrize("architecture", ["uncoupled", "gps_only"])
def test_every_architectures_velocity_aids(architecture: str) -> None:
    tuning = msgspec.convert({"architecture": architecture}, Tuning)
    off, _ = driven(straight, 90.0, Sensors(), tuning=tuning).errors_hz(60.0, 90.0)
    assert len(off) > 0
    assert rms(off) < 6.0
