"""What an engine's torque tells of the slope, and when it tells nothing."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from wayline.drive import Vehicle
from wayline.messages import Odometer, Torque
from wayline.tuning import Tuning
from wayline.vertical.engine import Engine
from wayline.vertical.own_slope import OwnSlope
from wayline.vertical.propulsion import SLIP, Push

VEHICLE = Vehicle(mass_kg=1500.0, driveline_efficiency=0.9, rolling_coefficient=0.01)
G, AIR = 9.81, 0.5 * 1.2 * 0.30 * 2.2
START_NS = 1_700_000_000_000_000_000
TURNS_PER_M = 12.0


def needed_nm(speed_mps: float, slope: float, mps2: float = 0.0) -> float:
    """The torque that a road asks of the engine, by hand."""
    force_n = 1500.0 * (G * (slope + 0.01) + 1.025 * mps2) + AIR * speed_mps**2
    force_n += 0.15 * TURNS_PER_M**2 * mps2
    return force_n / TURNS_PER_M * (1.0 / 0.9 if force_n >= 0.0 else 0.9)


def driven(
    slope: float,
    *,
    seconds: float = 5.0,
    speed_mps: float = 20.0,
    mps2: float = 0.0,
    hz: int = 10,
    **of_torque: Any,
) -> Iterator[Torque | Odometer]:
    """Torque, then wheels, so often a second; `of_torque` goes before what the road asks for."""
    for i in range(round(seconds * hz)):
        t_ns, speed = START_NS + i * 1_000_000_000 // hz, speed_mps + mps2 * i / hz
        fields: dict[str, Any] = {
            "engine_torque_nm": needed_nm(speed, slope, mps2),
            "engine_speed_rpm": speed * TURNS_PER_M * 30.0 / math.pi,
            **of_torque,
        }
        yield Torque(t_ns=t_ns, **fields)
        yield Odometer(t_ns=t_ns, speed_mps=speed)


def pushes(*drives: Iterator[Torque | Odometer], vehicle: Vehicle = VEHICLE) -> list[Push]:
    engine, found = Engine(vehicle, Tuning()), []
    for messages in drives:
        for message in messages:
            push = engine.wheels(message) if isinstance(message, Odometer) else None
            if isinstance(message, Torque):
                engine.torque(message)
            elif push is not None:
                found.append(push)
    return found


def slopes(found: list[Push]) -> list[float]:
    return [push.share - push.level for push in found]


@pytest.mark.parametrize("slope", [-0.03, 0.0, 0.05])
@pytest.mark.parametrize("mps2", [0.0, 0.4])
def test_torque_gives_the_slope_uphill_downhill_and_speeding_up(slope: float, mps2: float) -> None:
    found = slopes(pushes(driven(slope, mps2=mps2)))
    assert len(found) >= 6
    assert found == pytest.approx([slope] * len(found), abs=4e-4)


def test_a_hundred_torques_a_second_make_two_means_not_a_hundred() -> None:
    assert len(pushes(driven(0.02, hz=100))) == pytest.approx(8, abs=1)


def test_windows_that_follow_each_other_say_so() -> None:
    found = pushes(driven(0.02))
    assert [push.goes_on for push in found] == [False] + [True] * (len(found) - 1)


@pytest.mark.parametrize(
    "said",
    [
        {"clutch": True},
        {"gear": 0},
        {"gear": -1},
        {"engine_speed_rpm": None},
        {"engine_torque_nm": None},
    ],
)
def test_nothing_is_told_while_the_engine_is_not_alone_at_the_wheels(
    said: dict[str, Any],
) -> None:
    assert not pushes(driven(0.02, **said))


def test_while_braking_the_slope_is_at_most_what_is_told() -> None:
    """The engine's drag holds 20 m/s down 2 %, brakes hold it down 6 %."""
    drag: dict[str, Any] = {"engine_torque_nm": needed_nm(20.0, -0.02)}
    found = pushes(driven(-0.06, brake=True, **drag))
    assert found
    assert all(push.is_braked for push in found)
    assert slopes(found) == pytest.approx([-0.02] * len(found), abs=4e-4)


def test_brakes_are_over_after_six_tenths_of_a_second() -> None:
    braked_ns = START_NS + 2_000_000_000
    stream = [*driven(0.02), Torque(t_ns=braked_ns, brake=True)]
    found = pushes(iter(sorted(stream, key=lambda message: message.t_ns)))
    braked = [push for push in found if push.is_braked]
    assert braked[-1].t_ns - braked_ns > 0.6e9
    free = [push for push in found if push.t_ns > braked[-1].t_ns]
    assert found[0] not in braked
    assert free


def test_a_foot_that_pumps_makes_no_slope() -> None:
    """Accelerations change within the windows, the force and the driven wheels' slip with them."""
    engine, found, speed = Engine(VEHICLE, Tuning()), [], 20.0
    for i in range(300):
        mps2 = 0.8 if i // 4 % 2 else -0.4
        t_ns = START_NS + i * 100_000_000
        turning_rpm = speed * TURNS_PER_M * 30.0 / math.pi
        nm = needed_nm(speed, 0.02, mps2)
        engine.torque(Torque(t_ns=t_ns + 1, engine_torque_nm=nm, engine_speed_rpm=turning_rpm))
        speed += 0.1 * mps2
        turned_mps = speed * (1.0 + SLIP * nm * 0.9 * TURNS_PER_M / (1500.0 * G))
        push = engine.wheels(Odometer(t_ns=t_ns + 100_000_000, speed_mps=turned_mps))
        found += [push] if push else []
    assert slopes(found) == pytest.approx([0.02] * len(found), abs=3e-3)


def test_a_torque_between_two_seldom_readings_belongs_to_their_difference() -> None:
    found = slopes(pushes(driven(0.03, hz=2, mps2=0.3, seconds=20.0)))
    assert len(found) > 10
    assert found == pytest.approx([0.03] * len(found), abs=1e-3)


def test_another_gear_begins_anew_though_no_gear_is_told() -> None:
    half = [m for m in driven(0.02) if m.t_ns < START_NS + 2_000_000_000]
    faster = [
        Torque(t_ns=m.t_ns, engine_torque_nm=40.0, engine_speed_rpm=1.3 * m.engine_speed_rpm)
        if isinstance(m, Torque) and m.engine_speed_rpm
        else m
        for m in driven(0.02)
        if m.t_ns >= START_NS + 2_000_000_000
    ]
    begun = [p.t_ns - p.length_s * 1e9 - START_NS for p in pushes(iter([*half, *faster]))]
    assert not [t for t in begun if 1.99e9 < t < 2.6e9]
    assert max(begun) > 2.6e9


def test_slow_wheels_tell_nothing() -> None:
    assert not pushes(driven(0.02, speed_mps=3.9))


def test_slowing_down_without_torque_may_be_braking_where_no_brake_is_told() -> None:
    drag: dict[str, Any] = {"engine_torque_nm": -20.0}
    untold = pushes(driven(0.0, mps2=-0.5, speed_mps=25.0, **drag))
    assert all(push.is_braked for push in untold)
    told = pushes(driven(0.0, mps2=-0.5, speed_mps=25.0, brake=False, **drag))
    assert not any(push.is_braked for push in told)
    assert len(untold) == len(told) > 5


def test_a_bus_that_says_0_on_the_overrun_says_nothing_there() -> None:
    assert not pushes(driven(0.0, engine_torque_nm=0.0, brake=False))


def test_noise_of_the_wheels_is_learned_from_second_differences() -> None:
    rng = np.random.default_rng(4)
    noisy = [
        Odometer(t_ns=m.t_ns, speed_mps=(m.speed_mps or 0.0) + float(rng.normal(0.0, 0.03)))
        if isinstance(m, Odometer)
        else m
        for m in driven(0.0, seconds=30.0)
    ]
    std_mps = 0.03 / math.sqrt(5.0)  # ten readings a second, half a second each
    assert pushes(iter(noisy))[-1].speed_std_mps == pytest.approx(std_mps, rel=0.3)


def test_the_vehicles_own_slope_is_told_as_means_of_a_second_and_not_while_braking() -> None:
    engine = Engine(VEHICLE, Tuning())
    told: list[OwnSlope] = []
    for i in range(100):
        braking = 30 <= i < 50
        message = Torque(
            t_ns=START_NS + i * 100_000_000, slope_pct=13.0 if braking else 2.0, brake=braking
        )
        if mean := engine.torque(message):
            told.append(mean)
    assert {round(mean.slope, 6) for mean in told} == {0.02}
    assert not [mean for mean in told if 3.0e9 <= mean.middle_ns - START_NS <= 5.5e9]


def test_only_what_vertical_sensors_names_is_used() -> None:
    engine = Engine(VEHICLE, Tuning(vertical_sensors=("gps",)))
    for message in driven(0.02, slope_pct=2.0):
        told = engine.wheels(message) if isinstance(message, Odometer) else engine.torque(message)
        assert told is None
