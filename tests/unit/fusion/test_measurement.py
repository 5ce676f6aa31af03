"""Satellites one by one on closed-form drives: what each may do, and what none may."""

import math
from collections.abc import Iterable

import msgspec
import numpy as np
import pytest

from builders import at, only, run_core
from unit.fusion.drives import (
    Motion,
    Sensors,
    Truth,
    error_m,
    heading_error_deg,
    messages_of,
    seconds_of,
    stop_and_go,
    truth_of,
    winding,
)
from unit.fusion.skies import Receiver, epochs_of, with_epochs
from wayline.messages import FusionStatus, GpsFix, GpsRaw, Gyro, Message, Pose, Verdict
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore

MEASUREMENT = Tuning(architecture="measurement")
LENGTH_S = 120.0
MILLISECOND_M = 299_792.458


def sensed(motion: Motion, truths: list[Truth]) -> list[Message]:
    """What gyro and wheels tell, without a fix."""
    messages = messages_of(motion, truths, Sensors())
    return [message for message in messages if not isinstance(message, GpsFix)]


def outputs_of(messages: Iterable[Message]) -> list[Message]:
    return run_core(FusionCore(MEASUREMENT), messages)


def driven(
    motion: Motion, receiver: Receiver, length_s: float = LENGTH_S
) -> tuple[list[Truth], list[Message]]:
    truths = truth_of(motion, length_s)
    return truths, outputs_of(with_epochs(sensed(motion, truths), epochs_of(truths, receiver)))


def verdicts_of(outputs: list[Message]) -> list[Verdict]:
    return [each for status in only(outputs, FusionStatus) for each in status.verdicts]


def located_after(outputs: list[Message], since_s: float) -> list[Pose]:
    poses = [pose for pose in only(outputs, Pose) if seconds_of(pose.t_ns) >= since_s]
    assert poses
    return poses


def worst_m(outputs: list[Message], truths: list[Truth], since_s: float) -> float:
    return max(error_m(pose, truths) for pose in located_after(outputs, since_s))


def left(epochs: Iterable[GpsRaw], since_s: float, satellites: int) -> list[GpsRaw]:
    """From a time on only the first few satellites of each epoch."""
    return [
        GpsRaw(t_ns=each.t_ns, satellites=each.satellites[:satellites])
        if seconds_of(each.t_ns) >= since_s
        else each
        for each in epochs
    ]


@pytest.mark.parametrize("has_doppler", [True, False])
@pytest.mark.parametrize("motion", [winding, stop_and_go])
def test_raw_measurements_alone_place_a_vehicle(motion: Motion, has_doppler: bool) -> None:
    """Without a single fix; pseudoranges of 1 m noise place it to a few metres."""
    truths, outputs = driven(motion, Receiver(has_doppler=has_doppler))
    assert worst_m(outputs, truths, 60.0) < 3.0
    poses = located_after(outputs, 60.0)
    assert {pose.mode for pose in poses} == {"fused"}
    assert max(heading_error_deg(pose, truths) for pose in poses) < 3.0


def test_it_is_as_sure_as_it_is_right() -> None:
    truths, outputs = driven(winding, Receiver(range_std_m=3.0), 200.0)
    inside = [
        error_m(pose, truths) <= 2.0 * math.hypot(pose.east_std_m or 0.0, pose.north_std_m or 0.0)
        for pose in located_after(outputs, 60.0)
    ]
    assert np.mean(inside) > 0.9


def test_a_reflected_satellite_is_refused_alone() -> None:
    receiver = Receiver()
    truths = truth_of(winding, LENGTH_S)
    prn = next(epochs_of(truths, receiver)).satellites[0].prn
    reflected = list(epochs_of(truths, receiver._replace(longer_m={("gps", prn): 60.0})))
    clean = list(epochs_of(truths, receiver))
    epochs = [*clean[:80], *reflected[80:]]
    outputs = outputs_of(with_epochs(sensed(winding, truths), epochs))
    refused = {
        each.sensor for each in verdicts_of(outputs) if not each.accepted and each.t_ns >= at(80)
    }
    assert refused == {f"gps_raw G{prn}"}
    assert worst_m(outputs, truths, 60.0) < 3.0


@pytest.mark.parametrize("milliseconds", [1, -1, 7])
def test_a_clock_that_jumps_by_milliseconds_moves_nothing(milliseconds: int) -> None:
    truths, outputs = driven(winding, Receiver(jump_m={70.0: milliseconds * MILLISECOND_M}))
    assert worst_m(outputs, truths, 60.0) < 3.0
    stepped = [each for each in verdicts_of(outputs) if each.sensor == "gps_raw_clock"]
    assert [seconds_of(each.t_ns) for each in stepped if each.t_ns > at(60)] == [70.0]


def test_a_millisecond_is_told_by_one_satellite() -> None:
    truths = truth_of(winding, LENGTH_S)
    epochs = left(epochs_of(truths, Receiver(jump_m={90.0: MILLISECOND_M})), 80.0, 1)
    outputs = outputs_of(with_epochs(sensed(winding, truths), epochs))
    later = [each for each in verdicts_of(outputs) if each.t_ns >= at(91)]
    assert {each.accepted for each in later if each.sensor.startswith("gps_raw G")} == {True}


@pytest.mark.parametrize("has_doppler", [True, False])
def test_a_clock_that_wanders_is_followed(has_doppler: bool) -> None:
    """By 5 m/s within half a minute, a crystal in the sun."""
    truths, outputs = driven(winding, Receiver(wander_mps=5.0, has_doppler=has_doppler), 200.0)
    assert worst_m(outputs, truths, 60.0) < 4.0


def test_a_step_of_the_clock_that_is_no_millisecond_is_taken() -> None:
    truths, outputs = driven(winding, Receiver(jump_m={70.0: 4_321.0}))
    assert worst_m(outputs, truths, 60.0) < 5.0


@pytest.mark.parametrize(("satellites", "share"), [(3, 0.5), (2, 0.6), (1, 0.9)])
def test_few_satellites_still_help(satellites: int, share: float) -> None:
    """A gyro off by 0.05 deg/s bends the way by 100 m in 200 s."""
    truths = truth_of(winding, 320.0)
    messages = sensed(winding, truths)

    def ended_m(kept: int) -> float:
        epochs = left(epochs_of(truths, Receiver()), 120.0, kept)
        shifted = [drifting(each) for each in messages]
        outputs = outputs_of(with_epochs(shifted, epochs))
        return error_m(only(outputs, Pose)[-1], truths)

    assert ended_m(satellites) < share * ended_m(0)


def drifting(message: Message) -> Message:
    """The gyro's bias is another one from 120 s on."""
    if not isinstance(message, Gyro) or message.t_ns < at(120):
        return message
    assert message.yaw_rate_degps is not None
    return msgspec.structs.replace(message, yaw_rate_degps=message.yaw_rate_degps + 0.05)


def test_fixes_beside_their_own_ranges_count_nothing() -> None:
    """Those of another receiver, 30 m off, would pull the pose."""
    truths = truth_of(winding, LENGTH_S)
    epochs = list(epochs_of(truths, Receiver()))
    messages = list(messages_of(winding, truths, Sensors()))
    shifted = [
        msgspec.structs.replace(each, lat_deg=(each.lat_deg or 0.0) + 30.0 / 111_000.0)
        if isinstance(each, GpsFix) and each.t_ns >= at(40)
        else each
        for each in messages
    ]
    outputs = outputs_of(with_epochs(shifted, epochs))
    assert worst_m(outputs, truths, 60.0) < 3.0


def test_fixes_go_on_where_raw_measurements_end() -> None:
    truths = truth_of(winding, 160.0)
    epochs = [each for each in epochs_of(truths, Receiver()) if each.t_ns < at(60)]
    outputs = outputs_of(with_epochs(messages_of(winding, truths, Sensors()), epochs))
    assert {pose.mode for pose in located_after(outputs, 70.0)} == {"fused"}
    assert worst_m(outputs, truths, 70.0) < 3.0


def test_garbage_is_refused_by_name() -> None:
    """Half a pseudorange, one of an ephemeris two weeks old, a satellite in the Earth."""
    truths = truth_of(winding, LENGTH_S)

    def spoilt(epoch: GpsRaw) -> GpsRaw:
        first, second, third, *rest = epoch.satellites
        assert second.pseudorange_m is not None
        return GpsRaw(
            t_ns=epoch.t_ns,
            satellites=(
                msgspec.structs.replace(first, pseudorange_m=10.0),
                msgspec.structs.replace(second, pseudorange_m=second.pseudorange_m + 90_000.0),
                msgspec.structs.replace(third, x_m=1.0, y_m=1.0, z_m=1.0),
                *rest,
            ),
        )

    epochs = [
        spoilt(each) if each.t_ns >= at(70) else each for each in epochs_of(truths, Receiver())
    ]
    outputs = outputs_of(with_epochs(sensed(winding, truths), epochs))
    assert worst_m(outputs, truths, 60.0) < 3.0
    refused = {each.sensor for each in verdicts_of(outputs) if not each.accepted}
    assert f"gps_raw G{epochs[0].satellites[1].prn}" in refused


def test_late_epochs_are_applied_at_their_own_time() -> None:
    """At 15 m/s, taken as new, an epoch of half a second ago would pull back by 7 m."""
    truths = truth_of(winding, LENGTH_S)
    epochs = list(epochs_of(truths, Receiver()))
    late = sorted(
        [*sensed(winding, truths), *epochs],
        key=lambda each: each.t_ns + (500_000_000 if isinstance(each, GpsRaw) else 0),
    )
    outputs = outputs_of(late)
    assert worst_m(outputs, truths, 60.0) < 3.0
    assert only(outputs, FusionStatus)[-1].late == 0


def test_without_vehicle_sensors_it_is_a_receiver_of_its_own() -> None:
    truths = truth_of(winding, LENGTH_S)
    outputs = outputs_of(list(epochs_of(truths, Receiver())))
    assert {pose.mode for pose in located_after(outputs, 60.0)} == {"gps"}
    assert worst_m(outputs, truths, 60.0) < 6.0
