"""Torque in fusion: slope where no altimeter tells it, mass, bias, verdicts and bad engines."""

import math
from collections.abc import Iterable, Iterator

import msgspec
import numpy as np
import pytest

from builders import only, run_core
from unit.fusion.drives import Sensors, messages_of, straight, truth_of
from wayline.drive import Vehicle
from wayline.inputs import Flush
from wayline.messages import FusionStatus, GpsFix, Message, Odometer, Pose, Torque
from wayline.tuning import Tuning
from wayline.vertical.states import VerticalStates
from wayline_fusion.core import FusionCore
from wayline_fusion.keeping.records import Saved

G, TURNS_PER_M = 9.81, 3.0
TRUCK = Vehicle(mass_kg=20_000.0, drag_coefficient=0.6, frontal_area_m2=9.0)
HILLS_M = 400.0
STEEP = 0.04


def slope_at(path_m: float) -> float:
    return STEEP * math.sin(path_m / HILLS_M)


def alt_at(path_m: float) -> float:
    return 100.0 - STEEP * HILLS_M * math.cos(path_m / HILLS_M)


def heard(
    seconds: float, *, mass_kg: float = 20_000.0, gain: float = 1.0, blind_after_s: float = math.inf
) -> Iterator[Message]:
    """A truck over hills at 20 m/s with altitudes to the decimetre, and the torque it needs."""
    for message in messages_of(straight, truth_of(straight, seconds), Sensors()):
        path_m = 20.0 * (message.t_ns - BEGIN_NS) * 1e-9
        if isinstance(message, Odometer):
            yield engine(message.t_ns, path_m, mass_kg, gain)
        if isinstance(message, GpsFix):
            told_m = None if path_m > 20.0 * blind_after_s else round(alt_at(path_m), 1)
            yield msgspec.structs.replace(message, alt_m=told_m)
        else:
            yield message


def engine(t_ns: int, path_m: float, mass_kg: float, gain: float) -> Torque:
    """At 20 m/s; losses are the engine's uphill and the hill's downhill."""
    force_n = mass_kg * G * (slope_at(path_m) + 0.01) + 0.5 * 1.2 * 0.6 * 9.0 * 400.0
    through = 1.0 / 0.92 if force_n > 0.0 else 0.92
    return Torque(
        t_ns=t_ns,
        engine_torque_nm=gain * through * force_n / TURNS_PER_M,
        engine_speed_rpm=20.0 * TURNS_PER_M * 30.0 / math.pi,
        brake=False,
    )


BEGIN_NS = next(iter(messages_of(straight, truth_of(straight, 1.0), Sensors()))).t_ns


def outputs(messages: Iterable[Message], tuning: Tuning | None = None) -> list[Message]:
    return run_core(FusionCore(tuning or Tuning(), vehicle=TRUCK), list(messages))


def last_status(found: list[Message]) -> FusionStatus:
    status: FusionStatus = only(found, FusionStatus)[-1]
    return status


def grade_errors_pct(found: list[Message], after_s: float) -> list[float]:
    poses = only(found, Pose)
    late = [pose for pose in poses if pose.t_ns - BEGIN_NS > after_s * 1e9]
    return [
        pose.grade_pct - 100.0 * slope_at(20.0 * (pose.t_ns - BEGIN_NS) * 1e-9) for pose in late
    ]


def test_torque_carries_the_slope_where_no_altimeter_tells_it() -> None:
    """Without torque a minute of hills of 4 % would be guessed from the last slope."""
    found = outputs(heard(240.0, blind_after_s=180.0))
    assert max(map(abs, grade_errors_pct(found, 185.0))) < 0.5


@pytest.mark.parametrize("mass_kg", [17_400.0, 23_000.0])
def test_the_mass_is_found_after_10_km_of_hills(mass_kg: float) -> None:
    status = last_status(outputs(heard(500.0, mass_kg=mass_kg)))
    assert status.mass_kg == pytest.approx(mass_kg, rel=0.05)
    assert status.mass_std_kg is not None
    assert status.mass_std_kg < 0.05 * mass_kg


@pytest.mark.parametrize("mass_kg", [17_400.0, 23_000.0])
def test_noisy_wheels_do_not_draw_the_mass_to_what_makes_slopes_calm(mass_kg: float) -> None:
    rng = np.random.default_rng(6)
    noisy = [
        msgspec.structs.replace(message, speed_mps=20.0 + float(rng.normal(0.0, 0.03)))
        if isinstance(message, Odometer)
        else message
        for message in heard(500.0, mass_kg=mass_kg)
    ]
    assert last_status(outputs(noisy)).mass_kg == pytest.approx(mass_kg, rel=0.05)


def test_while_brakes_hold_the_slope_is_at_most_what_torque_tells() -> None:
    """Blind on an even road, then the brakes come on and the engine drags as down 3 %."""
    blind = list(heard(200.0, blind_after_s=180.0))
    dragged = TRUCK.mass_kg * G * -0.02 + 0.5 * 1.2 * 0.6 * 9.0 * 400.0
    braked = [
        msgspec.structs.replace(message, brake=True, engine_torque_nm=0.92 * dragged / TURNS_PER_M)
        if isinstance(message, Torque) and message.t_ns - BEGIN_NS > 190e9
        else message
        for message in blind
    ]
    assert only(outputs(braked), Pose)[-1].grade_pct < -2.0


def test_torque_alone_tells_the_slope_and_no_altitude() -> None:
    found = outputs(heard(120.0), Tuning(vertical_sensors=("torque",)))
    assert max(map(abs, grade_errors_pct(found, 20.0))) < 1.0
    assert only(found, Pose)[-1].alt_m is None


def test_torque_of_the_wrong_sign_is_not_followed() -> None:
    """Rejected, then taken for another mass; as no vehicle has that mass, none is used."""
    found = outputs(heard(300.0, gain=-1.0))
    assert max(map(abs, grade_errors_pct(found, 100.0))) < 2.5


def test_verdicts_of_torque_are_told() -> None:
    statuses = only(outputs(heard(60.0)), FusionStatus)
    told = {v.sensor for status in statuses for v in status.verdicts if v.accepted}
    assert "torque" in told


def test_without_torque_neither_mass_nor_bias_is_told() -> None:
    messages = [message for message in heard(30.0) if not isinstance(message, Torque)]
    status = last_status(outputs(messages))
    assert status.mass_kg is None
    assert status.torque_bias_pct is None


def kept(messages: list[Message]) -> Saved:
    """What a core wants kept at the end."""
    core = FusionCore(Tuning(), vehicle=TRUCK)
    run_core(core, messages)
    (saved,) = core.handle(Flush(messages[-1].t_ns), "fusion")
    assert isinstance(saved, Saved)
    return saved


@pytest.mark.parametrize(("off_s", "std_share"), [(2.0, 0.03), (3_600.0, 0.6)])
def test_the_mass_is_kept_over_a_restart_and_doubted_after_a_stand(
    off_s: float, std_share: float
) -> None:
    """Driving on it is the load of before; after an hour at rest it may be any."""
    heavy = list(heard(500.0, mass_kg=23_000.0))
    saved = kept(heavy)
    if off_s > 60.0:
        assert saved.pose is not None
        stood = msgspec.structs.replace(saved.pose, speed_mps=0.0)
        saved = msgspec.structs.replace(saved, pose=stood)
    later_ns = heavy[-1].t_ns + round(off_s * 1e9)
    core = FusionCore(Tuning(), saved, TRUCK)
    core.handle(Odometer(t_ns=later_ns, speed_mps=20.0), "can-ingest")
    kalman = core._vertical.filter
    assert kalman.mass * TRUCK.mass_kg == pytest.approx(23_000.0, rel=0.05)
    assert kalman.std(VerticalStates.INVERSE_MASS) == pytest.approx(std_share, abs=0.03)


def test_a_stand_opens_no_mass_that_only_torque_could_tell() -> None:
    """Without an altimeter nothing tells a mass from a slope: it stays the stated one."""
    pause_ns = 400_000_000_000
    driven = list(heard(60.0))
    later = [msgspec.structs.replace(each, t_ns=each.t_ns + pause_ns) for each in heard(60.0)]
    standing = [
        Odometer(t_ns=driven[-1].t_ns + number * 500_000_000, speed_mps=0.0)
        for number in range(1, 650)
    ]
    found = outputs([*driven, *standing, *later], Tuning(vertical_sensors=("torque",)))
    assert last_status(found).mass_kg == pytest.approx(TRUCK.mass_kg, rel=0.03)
