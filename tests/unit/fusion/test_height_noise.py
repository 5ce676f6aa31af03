"""How noisy the sensors of the height are is known again after a restart, before it is learned."""

from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
import pytest

from builders import only
from unit.fusion.drives import Sensors, messages_of, straight, truth_of
from unit.fusion.test_fusion_store import CALIBRATION, PACKAGE, POSE
from unit.fusion.test_restart import Kept
from unit.fusion.test_torque import BEGIN_NS, TRUCK, alt_at, engine
from wayline.database import open_database
from wayline.messages import Barometer, FusionStatus, GpsFix, Message, Odometer
from wayline.node import Node
from wayline.tuning import Tuning
from wayline_fusion.core import FusionCore
from wayline_fusion.keeping.records import Saved
from wayline_fusion.keeping.store import FusionStore

WIND_M = 1.3
SHAKE_NM = 8_000.0
"""Of an engine whose torque is told that badly."""
NOISES = ("pressure_noise_factor", "torque_noise_factor", "vehicle_slope_noise_factor")
DRIVEN_S, LATER_S = 240.0, 30.0


def heard(seconds: float, begin_s: float = 0.0) -> Iterator[Message]:
    """A truck on hills in a wind that moves its pressures by far more than a barometer claims."""
    rng = np.random.default_rng(4)
    for message in messages_of(straight, truth_of(straight, seconds), Sensors()):
        path_m = 20.0 * (message.t_ns - BEGIN_NS) * 1e-9
        told: tuple[Message, ...] = (message,)
        if isinstance(message, GpsFix):
            fix = msgspec.structs.replace(message, alt_m=round(alt_at(path_m), 1), v_std_m=1.0)
            gust_m = float(rng.normal(0.0, WIND_M))
            told = fix, barometer(message.t_ns, alt_at(path_m) + gust_m)
        if isinstance(message, Odometer):
            torque = engine(message.t_ns, path_m, 20_000.0, 1.0)
            shaken_nm = (torque.engine_torque_nm or 0.0) + float(rng.normal(0.0, SHAKE_NM))
            torque = msgspec.structs.replace(torque, engine_torque_nm=shaken_nm)
            told = torque, message
        yield from (each for each in told if each.t_ns >= BEGIN_NS + begin_s * 1e9)


def barometer(t_ns: int, alt_m: float) -> Barometer:
    return Barometer(
        t_ns=t_ns, pressure_pa=101_325.0 * (1.0 - alt_m / 44_330.77) ** (1 / 0.190_263)
    )


def run(messages: Iterator[Message], saved: Saved | None = None) -> tuple[list[Message], Saved]:
    kept, published = Kept(), list[Message]()
    node = Node("fusion", FusionCore(Tuning(), saved, TRUCK), kept)
    last_ns = 0
    for message in messages:
        last_ns = message.t_ns
        published += node.take(message, "test")
    published += node.finish(last_ns)
    return published, kept.records[-1]


@pytest.fixture(scope="module")
def learned() -> Saved:
    return run(heard(DRIVEN_S))[1]


def test_a_wind_and_a_shaking_engine_are_learned_and_kept(learned: Saved) -> None:
    assert learned.calibration.pressure_noise_factor > 3.0
    assert learned.calibration.torque_noise_factor > 1.5
    assert learned.calibration.vehicle_slope_noise_factor == 1.0


def nis_of(sensor: str, published: list[Message]) -> float:
    """Mean of the first ten, which is 1 where a sensor's noise is known."""
    verdicts = [each for status in only(published, FusionStatus) for each in status.verdicts]
    found = [each.nis for each in verdicts if each.sensor == sensor]
    return float(np.mean(found[:10]))


@pytest.mark.parametrize("sensor", ["barometer", "torque"])
def test_after_a_restart_the_first_readings_are_as_likely_as_the_last(
    learned: Saved, sensor: str
) -> None:
    """Without what was kept, they are far less likely than readings are."""
    forgotten = msgspec.structs.replace(
        learned,
        calibration=msgspec.structs.replace(learned.calibration, **dict.fromkeys(NOISES, 1.0)),
    )
    again, fresh = (
        nis_of(sensor, run(heard(DRIVEN_S + LATER_S, DRIVEN_S), saved)[0])
        for saved in (learned, forgotten)
    )
    assert again < 2.0
    assert fresh > 1.5 * again


def test_what_is_known_is_learned_anew_where_it_is_no_longer_so(learned: Saved) -> None:
    """It counts as a few measurements: the wind has fallen, and half a minute tells so."""
    still = (
        barometer(each.t_ns, alt_at(20.0 * (each.t_ns - BEGIN_NS) * 1e-9))
        if isinstance(each, Barometer)
        else each
        for each in heard(DRIVEN_S + LATER_S, DRIVEN_S)
    )
    _, later = run(still, learned)
    before = learned.calibration.pressure_noise_factor
    assert later.calibration.pressure_noise_factor < 0.5 * before


def test_it_is_there_again_from_the_database(tmp_path: Path, learned: Saved) -> None:
    opened = open_database(f"sqlite:///{tmp_path}/fusion.db", PACKAGE)
    store = FusionStore(opened, "truck")
    store.save(learned)
    assert store.load() == learned
    opened.dispose()


def test_a_database_of_before_knows_of_no_noise(database_url: str) -> None:
    opened = open_database(database_url, PACKAGE)
    FusionStore(opened, "truck").save(Saved(t_ns=1, calibration=CALIBRATION, pose=POSE))
    with opened.begin() as connection:
        for name in ("pressure", "torque", "vehicle_slope"):
            connection.exec_driver_sql(
                f"ALTER TABLE fusion_vehicle DROP COLUMN {name}_noise_factor"
            )
        connection.exec_driver_sql("UPDATE alembic_version_fusion SET version_num = 'fusion_0003'")
    opened.dispose()
    opened = open_database(database_url, PACKAGE)
    saved = FusionStore(opened, "truck").load()
    opened.dispose()
    assert saved is not None
    assert saved.calibration == msgspec.structs.replace(CALIBRATION, **dict.fromkeys(NOISES, 1.0))
