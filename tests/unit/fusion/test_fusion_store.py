"""The fusion database: one row a vehicle, kept durably, and no reason to lose a pose."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
import sqlalchemy as sa

from wayline.core import Record
from wayline.database import open_database
from wayline_fusion.keeping.records import LastPose, Saved, SensorCalibration
from wayline_fusion.keeping.store import FusionStore, FusionTables
from wayline_fusion.keeping.tables import METADATA

PACKAGE = "wayline_fusion"
CALIBRATION = SensorCalibration(
    gyro_bias_degps=-0.1 / 3.0,
    gyro_bias_std_degps=0.01,
    gyro_scale=1.003,
    gyro_scale_std=0.001,
    odometer_scale=0.992,
    odometer_scale_std=0.0007,
    gps_latency_s=-0.07,
    gps_latency_std_s=0.006,
    correlations=(0.1, -0.2, 1.0 / 3.0, 0.0, 0.5, -1e-9),
    gyro_temperature_c=31.5,
    position_noise_factor=1.2,
    velocity_noise_factor=0.3,
    bias_wander_factor=2.0,
    pressure_noise_factor=1.0 / 3.0,
    torque_noise_factor=0.05,
    vehicle_slope_noise_factor=7.5,
)
POSE = LastPose(
    lat_deg=55.87051917735583,
    lon_deg=9.86391212888453,
    east_std_m=1.1,
    north_std_m=1.0,
    heading_deg=276.9,
    heading_std_deg=0.25,
    speed_mps=-0.5,
    fix_ns=1_700_000_000_000_000_000,
)
SAVED = Saved(t_ns=1_700_000_000_123_456_789, calibration=CALIBRATION, pose=POSE)


@pytest.fixture
def engine(database_url: str) -> Iterator[sa.Engine]:
    opened = open_database(database_url, PACKAGE)
    yield opened
    opened.dispose()


def test_what_is_loaded_is_what_was_saved_to_the_last_bit(engine: sa.Engine) -> None:
    store = FusionStore(engine, "bus-1")
    assert store.save(SAVED) == ()
    assert store.load() == SAVED


def test_what_was_unknown_is_unknown_again(engine: sa.Engine) -> None:
    cold = msgspec.structs.replace(CALIBRATION, gyro_temperature_c=None)
    saved = Saved(t_ns=SAVED.t_ns, calibration=cold)
    store = FusionStore(engine, "bus-1")
    store.save(saved)
    assert store.load() == saved


def test_another_vehicle_gets_nothing(engine: sa.Engine) -> None:
    FusionStore(engine, "bus-1").save(SAVED)
    assert FusionStore(engine, "bus-2").load() is None


def test_the_last_written_stands_also_of_an_earlier_time(engine: sa.Engine) -> None:
    """Else one boot with the clock in 2038 would end all learning until then."""
    store = FusionStore(engine, "bus-1")
    store.save(SAVED)
    earlier = msgspec.structs.replace(SAVED, t_ns=SAVED.t_ns - 10**18, pose=None)
    store.save(earlier)
    assert store.load() == earlier


def test_only_what_fusion_keeps_is_kept(engine: sa.Engine) -> None:
    with pytest.raises(TypeError):
        FusionStore(engine, "bus-1").save(Record())


def test_the_tables_are_those_that_the_store_uses(tmp_path: Path) -> None:
    engine = open_database(f"sqlite:///{tmp_path}/fusion.db", PACKAGE)
    inspector = sa.inspect(engine)
    for table in METADATA.sorted_tables:
        there = {
            c["name"]: (str(c["type"]), c["nullable"]) for c in inspector.get_columns(table.name)
        }
        assert there == {c.name: (str(c.type), c.nullable) for c in table.columns}
    assert inspector.has_table("alembic_version_fusion")
    engine.dispose()


def test_services_share_one_database(database_url: str) -> None:
    """As a replay's `--database` does."""
    url = database_url
    open_database(url, "wayline_slope_map").dispose()
    engine = open_database(url, PACKAGE)
    FusionStore(engine, "bus-1").save(SAVED)
    engine.dispose()
    again = open_database(url, PACKAGE)
    assert FusionStore(again, "bus-1").load() == SAVED
    again.dispose()


def test_what_was_acknowledged_survives_kill(database_url: str) -> None:
    program = (
        "import sys, msgspec; sys.path.insert(0, sys.argv[1])\n"
        "from unit.fusion.test_fusion_store import FusionStore, open_database, SAVED, PACKAGE\n"
        "store = FusionStore(open_database(sys.argv[2], PACKAGE), 'bus-1')\n"
        "for k in range(1000000):\n"
        "    store.save(msgspec.structs.replace(SAVED, t_ns=k))\n"
        "    print(k, flush=True)\n"
    )
    tests = str(Path(__file__).parents[2])
    with subprocess.Popen(
        [sys.executable, "-c", program, tests, database_url], stdout=subprocess.PIPE, text=True
    ) as child:
        assert child.stdout is not None
        said = [child.stdout.readline() for _ in range(10)]
        os.kill(child.pid, signal.SIGKILL)
        said += child.stdout.read().splitlines()
    acknowledged = len([line for line in said if line.strip()])
    engine = open_database(database_url, PACKAGE)
    kept = FusionStore(engine, "bus-1").load()
    engine.dispose()
    assert kept is not None
    assert kept.t_ns in (acknowledged - 1, acknowledged)


def surer(factor: float) -> Saved:
    """What is kept, with stds that are so many times as large."""
    calibration = msgspec.structs.replace(
        CALIBRATION,
        gyro_bias_degps=0.7,
        gyro_bias_std_degps=CALIBRATION.gyro_bias_std_degps * factor,
        gyro_scale_std=CALIBRATION.gyro_scale_std * factor,
        odometer_scale_std=CALIBRATION.odometer_scale_std * factor,
    )
    return Saved(t_ns=SAVED.t_ns + 1, calibration=calibration, pose=None)


@pytest.mark.parametrize(("factor", "is_taken"), [(1.1, False), (0.9, True)])
def test_a_core_that_began_without_what_was_kept_replaces_it_once_it_knows_as_well(
    engine: sa.Engine, factor: float, is_taken: bool
) -> None:
    FusionStore(engine, "bus-1").save(SAVED)
    learned = surer(factor)
    FusionTables(engine, set()).save("bus-1", learned)
    kept = FusionStore(engine, "bus-1").load()
    expected = learned.calibration if is_taken else CALIBRATION
    assert kept == msgspec.structs.replace(learned, calibration=expected)


def test_a_core_that_was_told_replaces_what_was_kept(engine: sa.Engine) -> None:
    FusionStore(engine, "bus-1").save(SAVED)
    tables = FusionTables(engine, {"bus-1"})
    assert tables.load("bus-1").saved == SAVED
    tables.save("bus-1", surer(1.1))
    assert FusionStore(engine, "bus-1").load() == surer(1.1)


def test_what_a_new_vehicle_learned_is_kept_though_nothing_was_told(engine: sa.Engine) -> None:
    FusionTables(engine, set()).save("bus-1", SAVED)
    assert FusionStore(engine, "bus-1").load() == SAVED
