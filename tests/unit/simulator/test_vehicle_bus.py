"""What the sensors measured comes back from the bus to half a step."""

import re
import time

import cantools
import msgspec
import numpy as np
import pytest
from cantools.database.can import Database

from unit.simulator.journeys import WHEEL_RADIUS_M, cruise, turns_and_stops
from wayline.drive import CanMapping, Vehicle
from wayline.inputs import Frame
from wayline.messages import Barometer, Gyro, Message, Odometer, Torque
from wayline_can_ingest.core import CanIngestCore
from wayline_can_ingest.mapping import compile_mapping
from wayline_simulator.barometer import BarometerSamples
from wayline_simulator.bus_frames import bus_frames
from wayline_simulator.can_log import log_blocks
from wayline_simulator.gyro import GyroSamples
from wayline_simulator.journey import Floats, Journey
from wayline_simulator.odometer import OdometerSamples
from wayline_simulator.presets import MEMS, PRESETS, THESIS, Preset
from wayline_simulator.stream import Frames
from wayline_simulator.torque import TorqueSamples
from wayline_simulator.vehicle_bus import dbc_text, signals
from wayline_simulator.vehicle_sensors import VehicleSamples, measure_vehicle
from wayline_simulator.weather import Weather

CAR = Vehicle(wheel_radius_m=WHEEL_RADIUS_M, engine_reference_torque_nm=250.0)
START_S = 1_700_000_000
EVERYTHING = msgspec.structs.replace(MEMS, torque=THESIS.torque)


def measured(preset: Preset, drive: Journey | None = None, seed: int = 2) -> VehicleSamples:
    return measure_vehicle(
        drive or turns_and_stops(),
        preset,
        Weather(),
        vehicle=CAR,
        assumed=CAR,
        device=np.random.default_rng(1),
        random=np.random.default_rng(seed),
    )


def of_all_sensors(
    samples: VehicleSamples,
) -> tuple[GyroSamples, OdometerSamples, TorqueSamples, BarometerSamples]:
    assert samples.gyro is not None
    assert samples.odometer is not None
    assert samples.torque is not None
    assert samples.barometer is not None
    return samples.gyro, samples.odometer, samples.torque, samples.barometer


def loaded(preset: Preset) -> Database:
    database = cantools.database.load_string(dbc_text(preset), "dbc")
    assert isinstance(database, Database)
    return database


def ingested(preset: Preset, samples: VehicleSamples) -> list[Message]:
    """The messages of can-ingest for a log's lines."""
    source = CanMapping(signals=signals(preset))
    mapping = compile_mapping(source, [loaded(preset)], CAR, "drive.toml")
    core = CanIngestCore(source, mapping, CAR)
    log = b"".join(log_blocks(bus_frames(samples, dbc_text(preset)), START_S))
    messages: list[Message] = []
    for seconds, micros, frame_id, data in re.findall(
        r"\((\d+)\.(\d{6})\) can0 ([0-9A-F]{3})#([0-9A-F]*)\n", log.decode()
    ):
        t_ns = int(seconds) * 1_000_000_000 + int(micros) * 1000
        frame = Frame(t_ns, "can0", int(frame_id, 16), False, bytes.fromhex(data))
        messages += core.handle(frame, "can0")
    assert core.bad_input == 0
    return messages


def series(messages: list[Message], kind: type[Message], field: str) -> Floats:
    values = [getattr(each, field) for each in messages if isinstance(each, kind)]
    return np.array([value for value in values if value is not None], dtype=np.float64)


def test_cantools_decodes_every_frame_to_the_sample() -> None:
    """The first and the last frames of every message, signal by signal."""
    samples = measured(EVERYTHING)
    database = loaded(EVERYTHING)
    frames = {
        database.get_message_by_frame_id(each.frame_id).name: each
        for each in bus_frames(samples, dbc_text(EVERYTHING))
    }
    assert set(frames) == {"Yaw", "Wheels", "Transmission", "Engine", "Slope", "Air"}
    gyro, wheels, engine, air = of_all_sensors(samples)
    assert samples.slopes_pct is not None
    for index in (0, 100, -1):
        decoded = {
            name: database.decode_message(name, each.data[index].tobytes())
            for name, each in frames.items()
        }
        assert decoded == {
            "Yaw": {
                "YawRate": pytest.approx(gyro.yaw_rates_degps[index]),
                "Temperature": gyro.temperatures_c[index],
            },
            "Wheels": {
                "Speed": pytest.approx(wheels.speeds_mps[index]),
                "Reverse": wheels.reverse[index],
                "Distance": pytest.approx(wheels.distances_m[index]),
            },
            "Transmission": {"Gear": engine.gears[index], "Ratio": engine.gear_ratios[index]},
            "Engine": {
                "Torque": engine.torques_pct[index],
                "EngineSpeed": engine.engine_speeds_rpm[index],
                "Brake": engine.brake[index],
                "Clutch": engine.clutch[index],
            },
            "Slope": {"Slope": pytest.approx(samples.slopes_pct[index])},
            "Air": {
                "Pressure": pytest.approx(air.pressures_pa[index]),
                "Temperature": air.temperatures_c[index],
            },
        }


def test_can_ingest_takes_all_that_is_mapped() -> None:
    """Every sample comes back, at the instant that it describes, up to the frames' jitter."""
    samples = measured(EVERYTHING)
    messages = ingested(EVERYTHING, samples)
    gyro, wheels, engine, air = of_all_sensors(samples)
    for kind, field, expected in (
        (Gyro, "yaw_rate_degps", gyro.yaw_rates_degps),
        (Gyro, "temperature_c", gyro.temperatures_c),
        (Odometer, "speed_mps", wheels.speeds_mps),
        (Torque, "engine_torque_nm", engine.torques_pct * 2.5),
        (Torque, "engine_speed_rpm", engine.engine_speeds_rpm),
        (Torque, "brake", engine.brake),
        (Torque, "gear_ratio", engine.gear_ratios),
        (Barometer, "pressure_pa", air.pressures_pa),
        (Barometer, "temperature_c", air.temperatures_c),
    ):
        assert series(messages, kind, field) == pytest.approx(expected.astype(float)), field
    instants_s = series(messages, Gyro, "t_ns") / 1e9 - START_S
    assert np.abs(instants_s - gyro.instants_s).max() < 6 * 0.0005


def test_can_ingest_unwraps_the_counter() -> None:
    """4.9 km are more than one turn of 16 bits at 0.05 m."""
    samples = measured(EVERYTHING, cruise(35.0, 140.0))
    ways_m = series(ingested(EVERYTHING, samples), Odometer, "distance_m")
    assert samples.odometer is not None
    assert np.any(np.diff(samples.odometer.distances_m) < 0.0)
    scale = float(np.median(samples.odometer.speeds_mps)) / 35.0
    assert ways_m[-1] - ways_m[0] == pytest.approx(4897.0 * scale, rel=0.003)
    assert np.all(np.diff(ways_m) >= 0.0)


def test_the_slope_while_braking_reaches_nobody() -> None:
    """The sentinel is on the bus, and the mapping's condition takes it out."""
    samples = measured(EVERYTHING)
    assert samples.slopes_pct is not None
    valid = samples.slopes_pct[samples.slopes_pct < 13.0]
    assert 0 < len(valid) < len(samples.slopes_pct)
    heard = series(ingested(EVERYTHING, samples), Torque, "slope_pct")
    assert heard == pytest.approx(valid)


@pytest.mark.parametrize("name", PRESETS)
def test_a_presets_bus_has_only_its_sensors(name: str) -> None:
    """Every message of the database is sent, and every signal that is mapped is in it."""
    preset = PRESETS[name]
    database = loaded(preset)
    sent = {each.frame_id for each in bus_frames(measured(preset), dbc_text(preset))}
    assert sent == {message.frame_id for message in database.messages}
    source = CanMapping(signals=signals(preset))
    compile_mapping(source, [database], CAR, "drive.toml")
    topics = {quantity.partition(".")[0] for quantity in signals(preset)}
    sensors = ("gyro", "odometer", "torque", "barometer")
    assert topics == {name for name in sensors if getattr(preset, name) is not None}


def test_what_exceeds_its_bits_saturates() -> None:
    """A wheel speed beyond 655.35 m/s must not wrap to a slow one."""
    samples = measured(EVERYTHING)
    assert samples.odometer is not None
    fast = samples._replace(
        odometer=samples.odometer._replace(speeds_mps=samples.odometer.speeds_mps + 700.0)
    )
    messages = ingested(EVERYTHING, fast)
    speeds = [each.speed_mps for each in messages if isinstance(each, Odometer)]
    # the greatest number of its bits is a speed that no vehicle has
    assert set(speeds) == {None}


def test_the_same_seed_makes_the_same_bytes() -> None:
    """And another seed makes others."""

    def log(seed: int) -> bytes:
        frames = bus_frames(measured(EVERYTHING, seed=seed), dbc_text(EVERYTHING))
        return b"".join(log_blocks(frames, START_S))

    assert log(3) == log(3)
    assert log(3) != log(4)


def test_a_sensor_more_does_not_change_the_others() -> None:
    """Each draws from streams of its own."""
    fewer = msgspec.structs.replace(EVERYTHING, gyro=None, torque=None)
    one, other = measured(EVERYTHING).barometer, measured(fewer).barometer
    assert one is not None
    assert other is not None
    assert np.array_equal(one.pressures_pa, other.pressures_pa)


def test_a_log_is_candumps_in_order_of_time() -> None:
    """Ids of 11 and 29 bits, data of any length, ties in the order given."""
    short = Frames(0x1A0, np.array([0.5, 2.0000004]), np.array([[0, 17], [171, 255]], np.uint8))
    long = Frames(0x18FEF100, np.array([0.5, 0.25]), np.array([[1, 2, 3], [4, 5, 0]], np.uint8))
    assert b"".join(log_blocks([short, long], START_S)) == (
        b"(1700000000.250000) can0 18FEF100#040500\n"
        b"(1700000000.500000) can0 1A0#0011\n"
        b"(1700000000.500000) can0 18FEF100#010203\n"
        b"(1700000002.000000) can0 1A0#ABFF\n"
    )


def test_frames_of_one_instant_keep_the_order_of_their_messages() -> None:
    """A condition in one frame decides on the next, so that ties are no matter of chance."""
    times_s = np.repeat([1.0, 2.0], 500)
    frames = [Frames(number, times_s, np.zeros((1000, 1), np.uint8)) for number in (3, 1, 2)]
    lines = b"".join(log_blocks(frames, START_S)).splitlines()
    sent = [int(line.split()[2][:3], 16) for line in lines]
    assert sent == ([3] * 500 + [1] * 500 + [2] * 500) * 2


def test_a_million_frames_are_written_in_3_seconds() -> None:
    """A day of driving must not wait for its log."""
    data = np.random.default_rng(1).integers(0, 256, (1_000_000, 8), dtype=np.uint8)
    frames = [Frames(0x1A0, np.arange(0.0, 10_000.0, 0.01), data)]
    began_s = time.perf_counter()
    assert sum(block.count(b"\n") for block in log_blocks(frames, START_S)) == 1_000_000
    assert time.perf_counter() - began_s < 3.0
